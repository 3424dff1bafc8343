"""Figures of trained networks: curves and reliability of the Refined Network, quality maps of the Regression Network.

matplotlib comes with the extra `report`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from grasp_core.camera import CANONICAL_HEIGHT
from grasp_core.errors import ConfigError
from grasp_core.training.metrics import best_pixel, classification, precision_recall, reliability, roc
from grasp_core.training.scenes import TrainingScene

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _figure(columns: int, height: float = 3.8) -> Figure:
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise ConfigError("figures need matplotlib; install grasp-workbench[report]") from error
    return Figure(figsize=(4 * columns, height), layout="constrained")


def classifier_figure(path: Path, scores: ArrayLike, labels: ArrayLike) -> None:
    """Precision-recall curve, ROC curve, and reliability diagram with the histogram of scores, as one PNG.

    Raises:
        ConfigError: matplotlib is missing.
    """
    figure = _figure(3)
    left, middle, right = figure.subplots(1, 3)
    values = classification(scores, labels)
    precision, recall = precision_recall(scores, labels)
    left.plot(recall, precision)
    left.set(xlabel="recall", ylabel="precision", xlim=(0, 1), ylim=(0, 1.02), title=f"AP {values['ap']:.3f}")
    false, true = roc(scores, labels)
    middle.plot(false, true)
    middle.set(xlabel="false positive rate", ylabel="true positive rate", title=f"AUC {values['auc']:.3f}")
    diagram = reliability(scores, labels)
    right.plot([0, 1], [0, 1], color="0.7", linewidth=1)
    right.plot(diagram.score, diagram.label, marker="o")
    right.bar(diagram.score, diagram.count / diagram.count.sum(), width=0.03, color="0.8")
    right.set(
        xlabel="score", ylabel="share that succeeded", title=f"ECE {values['ece']:.3f}, Brier {values['brier']:.3f}"
    )
    for axes in (left, middle, right):
        axes.grid(alpha=0.3)
    figure.savefig(path, dpi=110)


def objects_figure(path: Path, measures: Mapping[str, Mapping[str, float]]) -> None:
    """Average precision, calibration error and the Regression Network's metric by object as bars, as one PNG.

    The object with the lowest average precision comes first.

    Args:
        path: of the picture.
        measures: object → its measures, as `assess.Assessment.by_object` gives them; those without AP are left out.

    Raises:
        ConfigError: matplotlib is missing.
    """
    known = sorted((values["ap"], name) for name, values in measures.items() if math.isfinite(values["ap"]))
    figure = _figure(3, height=1.2 + 0.17 * max(len(known), 4))
    left, middle, right = figure.subplots(1, 3, sharey=True)
    places, names = range(len(known)), [name for _, name in known]
    left.barh(places, [ap for ap, _ in known], color="tab:blue")
    left.plot([measures[name]["positives"] for name in names], places, "k|", label="share of positives: AP of chance")
    middle.barh(places, [measures[name]["ece"] for name in names], color="tab:orange")
    right.barh(places, [measures[name]["hit"] for name in names], color="tab:green")
    left.set(xlabel="average precision", xlim=(0, 1.02), yticks=list(places))
    left.set_yticklabels(names, fontsize=7)
    left.invert_yaxis()
    left.legend(fontsize=7, loc="lower right")
    middle.set(xlabel="expected calibration error")
    right.set(xlabel="views whose best pixel is near a grasp of quality 1", xlim=(0, 1.02))
    for axes in (left, middle, right):
        axes.grid(alpha=0.3, axis="x")
    figure.savefig(path, dpi=110)


def maps_figure(
    path: Path, scenes: Sequence[TrainingScene], maps: Sequence[NDArray[np.float32]], columns: int = 6
) -> None:
    """Quality maps over their depth images as one PNG, without matplotlib.

    Heat is red, the best pixel a cross, grasps of quality 1 are green points.
    """
    tiles = [_map_tile(scene, quality) for scene, quality in zip(scenes, maps, strict=True)]
    blank = np.zeros_like(tiles[0])
    rows = []
    for start in range(0, len(tiles), columns):
        row = tiles[start : start + columns]
        rows.append(np.hstack(row + [blank] * (min(columns, len(tiles)) - len(row))))
    if not cv2.imwrite(str(path), np.vstack(rows)):
        raise ConfigError(f"{path}: cannot be written; give another --out folder")


def _map_tile(scene: TrainingScene, quality: NDArray[np.float32]) -> NDArray[np.uint8]:
    """(H, W, 3) BGR."""
    grey = np.clip((CANONICAL_HEIGHT - scene.depth) / 0.15, 0, 1) * 150 + 40
    tile = np.repeat(grey[..., None], 3, axis=2)
    heat = np.clip(quality, 0, 1)[..., None]
    tile = np.clip(tile * (1 - 0.6 * heat) + heat * 0.6 * np.array([0, 40, 255.0]), 0, 255).astype(np.uint8)
    tile = np.ascontiguousarray(tile)
    for u, v in np.rint(scene.perfect).astype(int).tolist():
        cv2.circle(tile, (u, v), 1, (60, 220, 60), -1)
    cv2.drawMarker(tile, best_pixel(quality), (255, 255, 255), cv2.MARKER_CROSS, 14, 2)
    cv2.putText(tile, scene.name[:34], (6, 292), cv2.FONT_HERSHEY_SIMPLEX, 0.42, (255, 255, 255), 1, cv2.LINE_AA)
    return np.asarray(tile)
