"""Measures of both networks, in plain numpy.

The Refined Network is a classifier whose truth is a share of attempts: a grasp counts as positive where its label is
above 0.5 (accuracy, AP, AUC), while Brier score and calibration compare the score with the label itself.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from grasp_core.errors import GraspError

Floats = NDArray[np.float64]


def _checked(scores: ArrayLike, labels: ArrayLike) -> tuple[Floats, Floats]:
    s, y = np.asarray(scores, float), np.asarray(labels, float)
    if s.ndim != 1 or s.shape != y.shape or not len(s):
        raise GraspError(f"metrics need as many scores as labels and at least one, not {s.shape} and {y.shape}")
    if not (np.isfinite(s).all() and np.isfinite(y).all()):
        raise GraspError("metrics need finite scores and labels; leave unlabelled grasps out")
    return s, y


def _counts(scores: Floats, labels: Floats) -> tuple[Floats, Floats]:
    """True and false positives when everything down to each distinct score is called positive, highest first."""
    order = np.argsort(-scores, kind="stable")
    positive = labels[order] > 0.5
    last = np.append(np.flatnonzero(np.diff(scores[order])), len(scores) - 1)
    true = np.cumsum(positive)[last].astype(float)
    return true, last + 1 - true


def precision_recall(scores: ArrayLike, labels: ArrayLike) -> tuple[Floats, Floats]:
    """Precision and recall (K,) at every distinct score, highest first; recall is NaN without positives."""
    true, false = _counts(*_checked(scores, labels))
    return true / (true + false), true / true[-1] if true[-1] else np.full(len(true), np.nan)


def roc(scores: ArrayLike, labels: ArrayLike) -> tuple[Floats, Floats]:
    """False and true positive rates (K + 1,), from (0, 0) to (1, 1); NaN where a class is missing."""
    true, false = _counts(*_checked(scores, labels))
    rates = [c / c[-1] if c[-1] else np.full(len(c), np.nan) for c in (false, true)]
    return np.concatenate([[0.0], rates[0]]), np.concatenate([[0.0], rates[1]])


def average_precision(scores: ArrayLike, labels: ArrayLike) -> float:
    """Mean precision over the positives (a step at each distinct score, no interpolation); NaN without positives."""
    precision, recall = precision_recall(scores, labels)
    return float(np.sum(np.diff(recall, prepend=0.0) * precision))


def auc(scores: ArrayLike, labels: ArrayLike) -> float:
    """Area under the ROC curve, ties counted half; NaN where a class is missing."""
    false, true = roc(scores, labels)
    return float(np.trapezoid(true, false))


def accuracy(scores: ArrayLike, labels: ArrayLike) -> float:
    """Share of grasps whose score and label lie on the same side of 0.5."""
    s, y = _checked(scores, labels)
    return float(np.mean((s > 0.5) == (y > 0.5)))


def brier(scores: ArrayLike, labels: ArrayLike) -> float:
    """Mean squared difference between score and label."""
    s, y = _checked(scores, labels)
    return float(np.mean((s - y) ** 2))


@dataclass(frozen=True)
class Reliability:
    """A reliability diagram: mean score, mean label and number of grasps of each occupied bin, (K,) each."""

    score: Floats
    label: Floats
    count: NDArray[np.int64]

    @property
    def error(self) -> float:
        """The expected calibration error: mean distance of label and score over bins, weighted by their counts."""
        return float(np.sum(self.count * np.abs(self.label - self.score)) / self.count.sum())


def reliability(scores: ArrayLike, labels: ArrayLike, bins: int = 15) -> Reliability:
    """Scores in `bins` equal intervals of [0, 1] against the labels that they got."""
    s, y = _checked(scores, labels)
    which = np.clip((s * bins).astype(int), 0, bins - 1)
    count = np.bincount(which, minlength=bins)
    used = count > 0
    score, label = (np.bincount(which, values, bins)[used] / count[used] for values in (s, y))
    return Reliability(score, label, count[used])


def ece(scores: ArrayLike, labels: ArrayLike, bins: int = 15) -> float:
    """Expected calibration error."""
    return reliability(scores, labels, bins).error


def classification(scores: ArrayLike, labels: ArrayLike) -> dict[str, float]:
    """Accuracy, AP, AUC, Brier score and ECE by name."""
    return {
        "accuracy": accuracy(scores, labels),
        "ap": average_precision(scores, labels),
        "auc": auc(scores, labels),
        "brier": brier(scores, labels),
        "ece": ece(scores, labels),
    }


def best_pixel(quality: NDArray[np.float32]) -> tuple[int, int]:
    """(u, v) of the highest value of a quality map (H, W)."""
    v, u = np.unravel_index(int(np.argmax(quality)), quality.shape)
    return int(u), int(v)


def regression_hit(quality: NDArray[np.float32], perfect: ArrayLike, radius: float) -> bool:
    """The paper's measure of a quality map (section V.B).

    Args:
        quality: map (H, W).
        perfect: pixels (G, 2) as (u, v) of the grasps of quality 1, at least one.
        radius: pixels, 1/3 of the gripper's length.

    Returns:
        Whether such a grasp lies within `radius` of the map's best pixel.
    """
    pixels = np.asarray(perfect, float)
    if pixels.ndim != 2 or not len(pixels):
        raise GraspError("the regression measure needs a scene with a grasp of quality 1; leave the others out")
    return bool(np.min(np.hypot(*(pixels - best_pixel(quality)).T)) <= radius)
