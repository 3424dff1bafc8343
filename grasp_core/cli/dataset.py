"""grasp-core dataset …: look at, check, join and rebuild datasets."""

from __future__ import annotations

import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class Info:
    """What a dataset holds, and what it was made with."""

    path: Annotated[Path, tyro.conf.Positional]
    """folder of the dataset"""
    json: bool = False
    """print one JSON object"""

    def run(self) -> int:
        """Print it."""
        import msgspec

        from grasp_core.dataset.rows import SPLITS
        from grasp_core.dataset.store import DatasetStore

        with DatasetStore.open(self.path, readonly=True) as store:
            meta, objects, scenes = store.meta, store.objects(), store.scenes()
            counts = store.row(
                "SELECT count(*), sum(attempts), sum(source = 'human'), sum(state <> 'labelled') FROM samples"
            )
            assert counts is not None
            result = {
                "name": meta.name,
                "path": str(store.path),
                "code_version": meta.code_version,
                "gripper": {"name": meta.gripper["name"], "digest": meta.gripper_digest},
                "physics": meta.physics_digest,
                "recipe": meta.recipe,
                "objects": {split: sum(row.split == split for row in objects) for split in SPLITS},
                "scenes": {split: sum(row.split == split for row in scenes) for split in SPLITS},
                "graspable_scenes": {
                    split: sum(row.split == split and row.best == 1 for row in scenes) for split in SPLITS
                },
                "categories": dict(sorted(Counter(row.category for row in objects).items())),
                "grasps": counts[0],
                "attempts": counts[1] or 0,
                "human_labels": counts[2] or 0,
                "left_out": counts[3] or 0,
                "label_events": len(store.events()),
                "people": store.people(),
                "refused": store.refused(),
                "bytes": sum(path.stat().st_size for path in store.path.rglob("*") if path.is_file()),
            }
        if self.json:
            print(msgspec.json.encode(result).decode())
            return 0
        print(f"{result['name']}: {result['path']} ({result['bytes'] / 1e6:.1f} MB)")
        print(
            f"  made with      grasp-workbench {meta.code_version}, gripper {meta.gripper['name']}"
            f" ({meta.gripper_digest}), physics {meta.physics_digest}, recipe {meta.recipe_digest}"
        )
        for field in ("objects", "scenes", "graspable_scenes"):
            shown = ", ".join(f"{count} {split}" for split, count in result[field].items())
            print(f"  {field.replace('_', ' '):<16} {shown}")
        print(f"  categories       {', '.join(f'{name} {count}' for name, count in result['categories'].items())}")
        print(f"  grasps           {result['grasps']}, with {result['attempts']} attempts")
        print(
            f"  labels           {result['human_labels']} by people, {result['left_out']} left out,"
            f" {result['label_events']} events by {len(result['people'])} people"
        )
        for name, reason in result["refused"].items():
            print(f"  left out         {name}: {reason}")
        return 0


@dataclass(frozen=True)
class Verify:
    """Check every file, hash and label of a dataset; exit status 2 when something is wrong."""

    path: Annotated[Path, tyro.conf.Positional]
    """folder of the dataset"""
    gripper: str | None = None
    """also demand that it was made with this gripper (name or .yaml)"""
    physics: str | None = None
    """also demand that it was made with this physics (name or .yaml)"""
    mend: bool = False
    """compute the labels anew from attempts and label events first"""
    json: bool = False
    """print one JSON object"""

    def run(self) -> int:
        """Print what is wrong."""
        import msgspec

        from grasp_core.dataset.store import DatasetStore
        from grasp_core.dataset.verify import verify
        from grasp_core.gripper import load_gripper
        from grasp_core.simulation.physics import load_physics

        gripper = None if self.gripper is None else load_gripper(self.gripper)
        physics = None if self.physics is None else load_physics(self.physics)
        with DatasetStore.open(self.path, readonly=not self.mend) as store, Bar("file") as bar:
            if self.mend:
                store.rebuild_labels()
                if weights := store.meta.weights:
                    store.use_weights(weights)
            findings = verify(store, gripper=gripper, physics=physics, progress=bar)
            digest = None if findings else store.content_digest()
        if self.json:
            print(msgspec.json.encode({"path": str(self.path), "findings": findings, "content": digest}).decode())
        elif findings:
            for finding in findings:
                print(f"{finding.where}: {finding.problem}", file=sys.stderr)
        else:
            print(f"{self.path}: nothing is wrong; content {digest}")
        return 2 if findings else 0


@dataclass(frozen=True)
class Restore:
    """Rebuild a dataset from its labels archive: images are rendered anew, no physics is run."""

    archive: Annotated[str, tyro.conf.Positional] = "default"
    """name of a shipped archive, or a path that ends in .xz"""
    out: Path | None = None
    """folder of the dataset; by default one named after the archive in the user's data folder"""
    sample: bool = False
    """only the scenes of the small sample dataset"""
    workers: int | None = None
    """local processes, by default one per core; 0 works in this process"""

    def run(self) -> int:
        """Restore, with a progress bar on stderr."""
        from grasp_core.dataset.archive import read_archive
        from grasp_core.dataset.restore import restore
        from grasp_core.dataset.sample import sample_scenes
        from grasp_core.dataset.store import datasets_folder
        from grasp_core.parallel import Executor

        archive = read_archive(self.archive)
        path = self.out or datasets_folder() / (archive.head.name + ("-sample" if self.sample else ""))
        only = sample_scenes(archive) if self.sample else None
        with (
            Bar("scene") as bar,
            restore(archive, path, only=only, executor=Executor(self.workers), progress=bar) as store,
        ):
            print(
                f"{path}: {len(store.scenes())} scenes, {len(store.objects())} objects; labels {store.labels_digest()}"
            )
        return 0


@dataclass(frozen=True)
class Archive:
    """Write the labels archive of a dataset, from which `restore` rebuilds it."""

    path: Annotated[Path, tyro.conf.Positional]
    """folder of the dataset"""
    file: Annotated[Path, tyro.conf.Positional]
    """archive to write, NAME.npz.xz"""

    def run(self) -> int:
        """Write it."""
        from grasp_core.dataset.archive import write_archive
        from grasp_core.dataset.store import DatasetStore

        with DatasetStore.open(self.path, readonly=True) as store:
            size = write_archive(store, self.file)
        print(f"{self.file}: {size / 1e6:.2f} MB")
        return 0


@dataclass(frozen=True)
class Merge:
    """Add everything of other datasets to a dataset: objects, scenes, label events."""

    into: Annotated[Path, tyro.conf.Positional]
    """folder of the dataset that grows"""
    sources: Annotated[tuple[Path, ...], tyro.conf.Positional]
    """folders of the datasets to add"""

    def run(self) -> int:
        """Merge, with a progress bar on stderr."""
        from contextlib import ExitStack

        from grasp_core.dataset.merge import merge
        from grasp_core.dataset.store import DatasetStore

        with ExitStack() as stack:
            target = stack.enter_context(DatasetStore.open(self.into))
            sources = [stack.enter_context(DatasetStore.open(path, readonly=True)) for path in self.sources]
            results = merge(target, sources, progress=stack.enter_context(Bar("scene")))
            for path, result in zip(self.sources, results, strict=True):
                print(
                    f"{path}: {result.objects} objects, {result.scenes} scenes and {result.events} label events added,"
                    f" {result.known} scenes were there"
                )
                for reason, count in result.left_out.items():
                    print(f"  {count} label events left out: {reason}")
        return 0


@dataclass(frozen=True)
class Export:
    """Write all label events to a JSON Lines file, for another copy of the dataset."""

    path: Annotated[Path, tyro.conf.Positional]
    """folder of the dataset"""
    file: Annotated[Path, tyro.conf.Positional]
    """file to write"""

    def run(self) -> int:
        """Export."""
        from grasp_core.dataset.exchange import export_events
        from grasp_core.dataset.store import DatasetStore

        with DatasetStore.open(self.path, readonly=True) as store:
            print(f"{self.file}: {export_events(store, self.file)} label events")
        return 0


@dataclass(frozen=True)
class Import:
    """Add the label events of a JSON Lines file that are not there yet."""

    path: Annotated[Path, tyro.conf.Positional]
    """folder of the dataset"""
    file: Annotated[Path, tyro.conf.Positional]
    """file that `export` wrote"""

    def run(self) -> int:
        """Import."""
        from grasp_core.dataset.exchange import import_events
        from grasp_core.dataset.store import DatasetStore

        with DatasetStore.open(self.path) as store:
            result = import_events(store, self.file)
        print(f"{result.added} label events added, {result.known} were there")
        for reason, count in result.left_out.items():
            print(f"{count} left out: {reason}")
        return 0


class Bar:
    """A progress bar on stderr, fed with (done, total)."""

    def __init__(self, unit: str) -> None:
        from tqdm import tqdm

        self._bar = tqdm(unit=unit)

    def __call__(self, done: int, total: int) -> None:
        """Show how far it is."""
        self._bar.total = total
        self._bar.update(done - self._bar.n)

    def __enter__(self) -> Bar:
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.close()


@dataclass(frozen=True)
class Stats:
    """Outcome shares, quality, graspable share and comfort of a dataset, with a picture."""

    path: Annotated[Path, tyro.conf.Positional]
    """folder of the dataset"""
    picture: Path | None = None
    """PNG to draw (needs the extra `report`)"""
    json: bool = False
    """print one JSON object"""

    def run(self) -> int:
        """Compute, print and draw."""
        import msgspec
        import numpy as np

        from grasp_core.dataset.stats import compute_stats, draw_stats
        from grasp_core.dataset.store import DatasetStore

        with DatasetStore.open(self.path, readonly=True) as store:
            stats = compute_stats(store)
            if self.picture is not None:
                draw_stats(store, stats, self.picture)
        if self.json:
            print(msgspec.json.encode(stats).decode())
            return 0
        scenes = ", ".join(
            f"{stats.graspable_scenes[split]} of {count} {split}" for split, count in stats.scenes.items()
        )
        print(f"scenes     with a grasp of quality 1: {scenes}")
        shares = np.percentile(list(stats.good_grasps.values()) or [0.0], (0, 50, 100))
        print(
            "objects    share of grasps with quality 1, least, median, most: " + ", ".join(f"{s:.1%}" for s in shares)
        )
        if never := [name for name, share in stats.good_grasps.items() if share == 0]:
            print(f"           none at all: {', '.join(never)}")
        print(f"attempts   {stats.attempts}, {stats.dynamic_share:.1%} took the engine, in {stats.seconds:.0f} s")
        print("outcomes   " + ", ".join(f"{name} {share:.1%}" for name, share in stats.outcomes.items()))
        print(f"quality    grasps at 0, 0.1, ... 1: {', '.join(map(str, stats.quality))}")
        moved, turned = (", ".join(map(str, values)) for values in (stats.comfort_mm, stats.comfort_deg))
        print(f"comfort    5, 25, 50, 75, 95 % of successes: {moved} mm; {turned} degrees")
        return 0
