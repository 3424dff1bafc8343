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
        quality: number of grasps whose quality rounds to 0, 0.1, … 1.
        graspable: category → share of its scenes with at least one grasp of quality 1.
        good_grasps: object → share of its grasps that have quality 1.
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
    good_grasps: dict[str, float]
    graspable_scenes: dict[str, int]
    comfort_mm: list[float]
    comfort_deg: list[float]
    seconds: float


_TENTHS = 10
_QUANTILES = (5, 25, 50, 75, 95)
_OUTCOMES = {"SUCCESS": "#2a9d55", "COLLISION": "#c0392b", "MISSED": "#8d99a6", "SLIPPED": "#e09f3e"}
"""Outcome → its colour."""
_SPLITS = {"train": "#33658a", "validation": "#8e5ba6", "test": "#e0742f"}
"""Split → its colour."""


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
    tenths = store.rows(
        f"SELECT CAST(round({_TENTHS} * quality) AS INTEGER), count(*) FROM samples"
        " WHERE quality IS NOT NULL GROUP BY 1"
    )
    counts = {int(tenth): int(count) for tenth, count in tenths}
    good = store.rows(
        "SELECT objects.name, avg(quality = 1) FROM samples JOIN objects ON objects.id = samples.object"
        " WHERE quality IS NOT NULL GROUP BY objects.name ORDER BY objects.name"
    )
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
        outcomes={name: float(row[2 + index] or 0) / max(attempts, 1) for index, name in enumerate(_OUTCOMES)},
        quality=[counts.get(tenth, 0) for tenth in range(_TENTHS + 1)],
        graspable={
            name: float(np.mean([scene.best == 1 for scene in scenes if scene.category == name])) for name in categories
        },
        good_grasps={str(name): float(share) for name, share in good},
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
        GraspError: matplotlib is missing, or the file cannot be written.
    """
    try:
        import matplotlib

        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
    except ImportError as error:
        raise GraspError("pictures need matplotlib; pip install 'grasp-workbench[report]'") from error
    figure, panels = plt.subplot_mosaic(
        [["outcomes", "objects"], ["quality", "objects"], ["comfort_mm", "objects"], ["comfort_deg", "objects"]],
        figsize=(12, max(9.0, 0.19 * len(stats.graspable) + 1.5)),
        layout="constrained",
    )
    scenes = ", ".join(f"{count} {split}" for split, count in stats.scenes.items())
    figure.suptitle(f"{store.meta.name}: {scenes} scenes; {stats.grasps:,} grasps, {stats.attempts:,} attempts")
    bars = panels["outcomes"].bar(
        list(stats.outcomes), [100 * share for share in stats.outcomes.values()], color=list(_OUTCOMES.values())
    )
    panels["outcomes"].bar_label(bars, fmt="%.1f %%")
    panels["outcomes"].set(title="outcomes of attempts", ylabel="%", ylim=(0, 118 * max(stats.outcomes.values()) + 1))
    _draw_quality(stats, panels["quality"])
    _draw_comfort(store, panels["comfort_mm"], "comfort_m", 1000.0, 50, "mm")
    _draw_comfort(store, panels["comfort_deg"], "comfort_rad", 180 / np.pi, 90, "°")
    _draw_objects(store, stats, panels["objects"])
    try:
        figure.savefig(file, dpi=110)
    except (OSError, ValueError) as error:
        raise GraspError(f"{file}: cannot be written ({error}); give a .png in a folder that exists") from error
    finally:
        plt.close(figure)


def _draw_quality(stats: Stats, axes: Axes) -> None:
    bars = axes.bar(np.arange(_TENTHS + 1) / _TENTHS, stats.quality, width=0.08, color="#33658a")
    axes.bar_label(bars, [f"{count:,}" if count else "" for count in stats.quality], fontsize=7)
    axes.set(
        title="quality of grasps (log scale)",
        xlabel="successes / attempts",
        ylabel="grasps",
        yscale="log",
        ylim=(0.7, 4 * max(stats.quality) + 1),
        xlim=(-0.06, 1.06),
        xticks=np.arange(6) / 5,
    )


def _draw_comfort(store: DatasetStore, axes: Axes, column: str, factor: float, most: int, unit: str) -> None:
    found = store.rows(f"SELECT {column} FROM attempts WHERE {column} IS NOT NULL")
    moved = factor * np.array([row[0] for row in found], float)
    axes.hist(np.clip(moved, 0, most), bins=50, range=(0, most), color=_OUTCOMES["SUCCESS"])
    if len(moved):
        axes.axvline(float(np.median(moved)), color="#333333", linestyle="--", linewidth=1)
    what = "motion" if column == "comfort_m" else "rotation"
    axes.set(
        title=f"comfort: {what} in the gripper, successes (median dashed)",
        xlabel=f"{unit} ({most} and more in the last bin)",
        ylabel="attempts",
        xlim=(0, most),
    )


def _draw_objects(store: DatasetStore, stats: Stats, axes: Axes) -> None:
    """A row a category, a dot an object in its split's colour; those without a perfect grasp are hollow."""
    rows = [row for row in store.objects() if row.name in stats.good_grasps]
    kinds = {name: [stats.good_grasps[row.name] for row in rows if row.category == name] for name in stats.graspable}
    order = sorted((name for name in kinds if kinds[name]), key=lambda name: (np.mean(kinds[name]), name))
    for split, colour in _SPLITS.items():
        own = [(100 * stats.good_grasps[row.name], order.index(row.category)) for row in rows if row.split == split]
        shares, heights = np.array(own, float).reshape(-1, 2).T
        faces = [colour if share > 0 else "none" for share in shares]
        axes.scatter(shares, heights, s=26, c=faces, edgecolors=colour, label=f"{split} ({len(own)})", zorder=3)
    axes.set(title="objects: share of grasps with quality 1 (hollow: none)", xlabel="% of the object's grasps")
    axes.set_yticks(range(len(order)), order, fontsize=7)
    axes.set_ylim(-0.7, len(order) - 0.3)
    axes.set_xlim(left=-0.5)
    axes.grid(axis="both", color="#e5e5e5", zorder=0)
    axes.legend(loc="lower right")
