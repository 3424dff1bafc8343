"""grasp-core generate: make a dataset from a recipe."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from grasp_core.dataset.generate import Progress


@dataclass(frozen=True)
class Generate:
    """Make the dataset of a recipe: objects, stable poses, depth images, grasps and their DART attempts.

    Stop it when you like (Ctrl-C, a kill, a power cut); started again with the same arguments it goes on where it was.
    """

    recipe: str = "default"
    """name of a shipped recipe, or a path that ends in .yaml"""
    out: Path | None = None
    """folder of the dataset; by default one named after the recipe in the user's data folder"""
    modelnet: Path | None = None
    """ModelNet folder whose meshes take the place of the recipe's objects, as many of each split"""
    workers: int | None = None
    """local processes, by default one per core; 0 works in this process"""
    ray: str | None = None
    """address of a Ray cluster to work on instead, e.g. auto or 10.0.0.1:6379"""
    json: bool = False
    """print one JSON object instead of words when done"""

    def run(self) -> int:
        """Generate, with a progress bar on stderr."""
        import msgspec

        from grasp_core.dataset.generate import generate
        from grasp_core.dataset.recipe import load_recipe, with_modelnet
        from grasp_core.dataset.store import DatasetStore, datasets_folder
        from grasp_core.parallel import Executor

        recipe = load_recipe(self.recipe)
        if self.modelnet is not None:
            recipe = with_modelnet(recipe, self.modelnet)
        path = self.out or datasets_folder() / recipe.name
        print(f"{path}: recipe '{recipe.name}'", file=sys.stderr)
        bars = Bars()
        try:
            summary = generate(recipe, path, Executor(self.workers, self.ray), progress=bars)
        finally:
            bars.close()
        for name, reason in summary.refused.items():
            print(f"left out {name}: {reason}", file=sys.stderr)
        with DatasetStore.open(path, readonly=True) as store:
            digest = store.content_digest()
        if self.json:
            result = {
                "path": str(path),
                "scenes": summary.scenes,
                "scenes_before": summary.before,
                "refused": summary.refused,
                "outcomes": dict(summary.outcomes),
                "seconds": round(summary.seconds, 1),
                "content": digest,
            }
            print(msgspec.json.encode(result).decode())
            return 0
        attempts = sum(summary.outcomes.values())
        shares = ", ".join(f"{n / attempts:.1%} {name}" for name, n in summary.outcomes.most_common())
        print(f"{summary.scenes} scenes made in {summary.seconds:.0f} s, {summary.before} were there")
        if attempts:
            print(f"{attempts} attempts: {shares}")
        print(f"content {digest}")
        print(f"look at it with: grasp-workbench --dataset {path}")
        return 0


class Bars:
    """One progress bar a stage, with rate and time left."""

    def __init__(self) -> None:
        from tqdm import tqdm

        self._make = tqdm
        self._bar: tqdm | None = None
        self._stage = ""

    def __call__(self, progress: Progress) -> None:
        """Show how far it is."""
        if progress.stage != self._stage:
            self.close()
            self._stage = progress.stage
            unit = progress.stage.rstrip("s")
            self._bar = self._make(
                total=progress.total, initial=progress.done, desc=progress.stage, unit=unit, smoothing=0.1
            )
        elif self._bar is not None:
            self._bar.update(progress.done - self._bar.n)

    def close(self) -> None:
        """Leave the bar as it stands."""
        if self._bar is not None:
            self._bar.close()
            self._bar = None
