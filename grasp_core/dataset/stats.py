"""Statistics of a dataset: what happened, how good grasps are, which objects can be grasped, and pictures of it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from grasp_core.dataset.rows import SPLITS
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import GraspError

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_COUNTS = ("successes", "collisions", "missed", "slipped")


class Stats(msgspec.Struct, frozen=True, kw_only=True):
    """Figures of a dataset, of its generated grasps and those that people made.

    Attributes:
        objects: split → number.
        scenes: split → number.
        grasps: number.
        attempts: with a verdict.
        dynamic_share: of all attempts, those that took the engine.
        outcomes: outcome → share of the attempts.
        quality: number of grasps in each of ten equal bins over [0, 1].
        graspable: category → share of its scenes with at least one grasp of quality 1.
        graspable_scenes: split → number of such scenes.
        comfort_mm: quantiles 5, 25, 50, 75, 95 % of the objects' motion in the gripper, successes only.
        comfort_deg: the same of their rotation.
        seconds: of computing, all scenes.
    """

    objects: dict[str, int]
    scenes: dict[str, int]
    grasps: int
    attempts: int
    dynamic_share: float
    outcomes: dict[str, float]
    quality: list[int]
    graspable: dict[str, float]
    graspable_scenes: dict[str, int]
    comfort_mm: list[float]
    comfort_deg: list[float]
    seconds: float


_BINS = 10
_QUANTILES = (5, 25, 50, 75, 95)


def compute_stats(store: DatasetStore) -> Stats:
    """All figures of a dataset.

    Raises:
        GraspError: the dataset holds no scene.
    """
    scenes, objects = store.scenes(), store.objects()
    if not scenes:
        raise GraspError(f"{store.path}: holds no scene yet; generate some first")
    row = store.rows(f"SELECT count(*), sum(attempts), {', '.join(f'sum({name})' for name in _COUNTS)} FROM samples")[0]
    grasps, attempts = int(row[0]), int(row[1] or 0)
    dynamic = store.rows("SELECT avg(dynamic) FROM attempts")[0][0]
    quality = np.array([r[0] for r in store.rows("SELECT quality FROM samples WHERE quality IS NOT NULL")], float)
    categories = sorted({scene.category for scene in scenes})
    comfort = np.array(
        [tuple(r) for r in store.rows("SELECT comfort_m, comfort_rad FROM attempts WHERE comfort_m IS NOT NULL")]
    ).reshape(-1, 2)
    return Stats(
        objects={split: sum(r.split == split for r in objects) for split in SPLITS},
        scenes={split: sum(r.split == split for r in scenes) for split in SPLITS},
        grasps=grasps,
        attempts=attempts,
        dynamic_share=float(dynamic or 0.0),
        outcomes={
            name: float(row[2 + index] or 0) / max(attempts, 1)
            for index, name in enumerate(("SUCCESS", "COLLISION", "MISSED", "SLIPPED"))
        },
        quality=np.bincount(np.minimum((quality * _BINS + 1e-9).astype(int), _BINS - 1), minlength=_BINS).tolist(),
        graspable={
            name: float(np.mean([scene.best == 1 for scene in scenes if scene.category == name])) for name in categories
        },
        graspable_scenes={split: sum(r.split == split and r.best == 1 for r in scenes) for split in SPLITS},
        comfort_mm=[round(float(v), 2) for v in np.percentile(comfort[:, 0] * 1000, _QUANTILES)]
        if len(comfort)
        else [],
        comfort_deg=[round(float(v), 2) for v in np.degrees(np.percentile(comfort[:, 1], _QUANTILES))]
        if len(comfort)
        else [],
        seconds=float(store.rows("SELECT sum(seconds) FROM scenes")[0][0] or 0.0),
    )


def draw_stats(store: DatasetStore, stats: Stats, file: str | Path) -> None:
    """Draw outcome shares, the histogram of quality, graspable shares and comfort into one PNG.

    Raises:
        GraspError: matplotlib is missing.
    """
    try:
        import matplotlib

        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
    except ImportError as error:
        raise GraspError("pictures need matplotlib; pip install 'grasp-workbench[report]'") from error
    height = max(7.0, 0.19 * len(stats.graspable) + 1.0)
    figure, panels = plt.subplot_mosaic(
        [["outcomes", "graspable"], ["quality", "graspable"], ["comfort", "graspable"]],
        figsize=(11, height),
        layout="constrained",
    )
    figure.suptitle(f"{store.meta.name}: {sum(stats.scenes.values())} scenes, {stats.attempts} attempts")
    colours = {"SUCCESS": "#2a9d55", "COLLISION": "#c0392b", "MISSED": "#8d99a6", "SLIPPED": "#e09f3e"}
    bars = panels["outcomes"].bar(
        list(stats.outcomes), [100 * share for share in stats.outcomes.values()], color=list(colours.values())
    )
    panels["outcomes"].bar_label(bars, fmt="%.1f %%")
    panels["outcomes"].set(title="outcomes of attempts", ylabel="%", ylim=(0, 110 * max(stats.outcomes.values()) + 1))
    edges = np.linspace(0, 1, _BINS + 1)
    panels["quality"].bar(edges[:-1], stats.quality, width=1 / _BINS, align="edge", color="#33658a", edgecolor="white")
    panels["quality"].set(
        title="quality of grasps (log scale)", xlabel="successes / attempts", yscale="log", xlim=(0, 1)
    )
    _draw_comfort(store, panels["comfort"])
    names = sorted(stats.graspable, key=lambda name: (stats.graspable[name], name))
    panels["graspable"].barh(names, [100 * stats.graspable[name] for name in names], color="#2a9d55")
    panels["graspable"].set(
        title="scenes with a grasp of quality 1", xlabel="% of the category's scenes", xlim=(0, 100)
    )
    panels["graspable"].set_ylim(-0.6, len(names) - 0.4)
    panels["graspable"].tick_params(axis="y", labelsize=7)
    figure.savefig(file, dpi=110)
    plt.close(figure)


def _draw_comfort(store: DatasetStore, axes: Axes) -> None:
    found = store.rows("SELECT comfort_m FROM attempts WHERE comfort_m IS NOT NULL")
    moved = 1000 * np.array([row[0] for row in found])
    axes.hist(np.clip(moved, 0, 50), bins=50, range=(0, 50), color="#e09f3e")
    axes.set(
        title="comfort: motion in the gripper, successes", xlabel="mm (50 and more in the last bin)", ylabel="attempts"
    )
