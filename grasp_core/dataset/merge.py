"""Merging: datasets made on several machines become one, with everything that people did to each of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import msgspec

from grasp_core.dataset.content import SceneRecord
from grasp_core.dataset.exchange import add_events, event_lines
from grasp_core.dataset.rows import SceneRow
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import MismatchError, StoreError


class MergeResult(msgspec.Struct, frozen=True):
    """What a merge added.

    Attributes:
        objects: that were new.
        scenes: that were new.
        known: scenes that were there already, with the same content.
        events: label events that were new.
        left_out: reason → label events that could not be used.
    """

    objects: int
    scenes: int
    known: int
    events: int
    left_out: dict[str, int]


def merge(
    target: DatasetStore, sources: Sequence[DatasetStore], *, progress: Callable[[int, int], None] | None = None
) -> list[MergeResult]:
    """Add everything of some datasets to another.

    Args:
        target: what grows.
        sources: what is added; they stay as they are.
        progress: called with (done, total) scenes.

    Raises:
        MismatchError: a source was made with another gripper or physics.
        StoreError: an object or scene of one name has other content, or a split differs; nothing of that source's
            following scenes is added.
    """
    for source in sources:
        _check(target, source)
    total = sum(len(source.scenes()) for source in sources)
    done = 0
    results = []
    for source in sources:
        objects = sum(
            target.add_object(source.object(row.name), row.split, source.poses(row.name)) for row in source.objects()
        )
        scenes = known = 0
        for row in source.scenes():
            if _add_scene(target, source, row):
                scenes += 1
            else:
                known += 1
            done += 1
            if progress:
                progress(done, total)
        merged = add_events(target, event_lines(source))
        results.append(MergeResult(objects, scenes, known, merged.added, merged.left_out))
    return results


def _check(target: DatasetStore, source: DatasetStore) -> None:
    ours, theirs = target.meta, source.meta
    for name in ("gripper", "physics"):
        if getattr(ours, f"{name}_digest") != getattr(theirs, f"{name}_digest"):
            raise MismatchError(
                f"{source.path}: was made with another {name} than {target.path}; such attempts must not be mixed"
            )
    if ours.recipe.get("noise") != theirs.recipe.get("noise"):
        raise MismatchError(
            f"{source.path}: was made with other noise than {target.path}; such labels must not be mixed"
        )


def _add_scene(target: DatasetStore, source: DatasetStore, row: SceneRow) -> bool:
    there = target.row("SELECT id FROM scenes WHERE name = ?", (row.name,))
    if there is not None:
        if target.scene_digest(there["id"]) != source.scene_digest(row.id):
            raise StoreError(
                f"{source.path}: its scene '{row.name}' has other content than the one in {target.path}; generate"
                " one of them again with another seed or other names"
            )
        return False
    found = source.grasp_rows("WHERE grasps.scene = ? AND grasps.origin = 'grid' ORDER BY number", (row.id,))
    attempts = [[attempt for attempt in source.attempts(grasp.id) if attempt.event is None] for grasp in found]
    record = SceneRecord(
        name=row.name,
        object=row.object,
        pose=row.pose,
        seed=row.seed,
        scene=source.scene(row.id),
        depth=source.depth(row.id),
        grasps=[grasp.grasp for grasp in found],
        attempts=attempts,
        seconds=source.rows("SELECT seconds FROM scenes WHERE id = ?", (row.id,))[0]["seconds"],
    )
    return target.add_scene(record)
