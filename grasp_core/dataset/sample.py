"""The sample dataset: the few scenes of the shipped archive that a new user meets first, one choice for all uses."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

from grasp_core.dataset import files
from grasp_core.dataset.archive import Archive, locate_archive, read_archive
from grasp_core.dataset.database import FILE
from grasp_core.dataset.restore import restore
from grasp_core.dataset.rows import Split
from grasp_core.dataset.store import DatasetStore, datasets_folder
from grasp_core.parallel import Executor

SCENES: dict[Split, int] = {"train": 10, "validation": 3, "test": 3}
"""How many scenes of each split it holds."""


def sample_scenes(archive: Archive, counts: dict[Split, int] = SCENES) -> list[str]:
    """Names of its scenes: likeliest poses of objects of as many categories as possible, split by split."""
    objects = {item.name: item for item in archive.head.objects}
    chosen: list[str] = []
    seen: set[str] = set()
    for split, count in counts.items():
        first = [s for s in archive.head.scenes if s.pose == 0 and objects[s.object].split == split]
        first.sort(key=lambda scene: (objects[scene.object].category in seen, scene.name))
        fresh: list[str] = []
        kinds: set[str] = set()
        for again in (False, True):  # new categories first, then whatever there is
            for scene in first:
                kind = objects[scene.object].category
                if len(fresh) < count and scene.name not in fresh and (again or kind not in kinds | seen):
                    fresh.append(scene.name)
                    kinds.add(kind)
        seen |= kinds
        chosen += fresh
    return chosen


def sample_dataset(
    archive: str | Path = "default",
    *,
    progress: Callable[[int, int], None] | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> Path:
    """The folder of the sample dataset, a writable copy in the user's data folder that is made on first use.

    Its name holds a hash of the archive: another archive gets a copy of its own, and what people did to the old one
    stays.

    Args:
        archive: a shipped name, or a path that ends in .xz.
        progress: called with (done, total) scenes while it is made.
        cancelled: asked a few times a second; true ends it.

    Raises:
        StoreError: no such archive, or the folder cannot be read or written.
        Cancelled: `cancelled` said so; the next call goes on.
    """
    data = files.read(locate_archive(archive))
    path = datasets_folder() / f"sample-{hashlib.sha256(data).hexdigest()[:8]}"
    if not _complete(path):
        found = read_archive(archive)
        here = Executor(workers=0)  # other processes would take longer to start
        only = sample_scenes(found)
        restore(found, path, only=only, executor=here, progress=progress, cancelled=cancelled).close()
    return path


def _complete(path: Path) -> bool:
    if not (path / FILE).exists():
        return False
    with DatasetStore.open(path, readonly=True) as store:
        return len(store.scenes()) >= sum(SCENES.values())
