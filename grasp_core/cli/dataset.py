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
        from tqdm import tqdm

        from grasp_core.dataset.store import DatasetStore
        from grasp_core.dataset.verify import verify
        from grasp_core.gripper import load_gripper
        from grasp_core.simulation.physics import load_physics

        gripper = None if self.gripper is None else load_gripper(self.gripper)
        physics = None if self.physics is None else load_physics(self.physics)
        with DatasetStore.open(self.path, readonly=not self.mend) as store, tqdm(unit="file", leave=False) as bar:
            if self.mend:
                store.rebuild_labels()
                if weights := store.meta.weights:
                    store.use_weights(weights)

            def show(done: int, total: int) -> None:
                bar.total = total
                bar.update(done - bar.n)

            findings = verify(store, gripper=gripper, physics=physics, progress=show)
            digest = None if findings else store.content_digest()
        if self.json:
            print(msgspec.json.encode({"path": str(self.path), "findings": findings, "content": digest}).decode())
        elif findings:
            for finding in findings:
                print(f"{finding.where}: {finding.problem}", file=sys.stderr)
        else:
            print(f"{self.path}: nothing is wrong; content {digest}")
        return 2 if findings else 0
