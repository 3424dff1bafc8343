"""Rates with their intervals, and tables for people; everything is computed from raw outcomes."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
import numpy as np
from numpy.typing import ArrayLike

from grasp_core.rates import wilson


class Rate(msgspec.Struct, frozen=True):
    """A success rate.

    Attributes:
        successes: how many attempts succeeded.
        attempts: how many were made.
        rate: successes / attempts; None without attempts.
        low: lower end of the 95 % Wilson interval of the two counts, attempts taken as independent.
        high: its upper end.
        scene_low: the same at the effective number of attempts: those in one scene resemble each other (see `pool`).
        scene_high: its upper end.
    """

    successes: int
    attempts: int
    rate: float | None
    low: float
    high: float
    scene_low: float
    scene_high: float

    @property
    def text(self) -> str:
        """For people: `93.1 % (88.0-96.2 %; 121/130)`, with the interval over scenes."""
        if self.rate is None:
            return "none"
        return (
            f"{100 * self.rate:.1f} % ({100 * self.scene_low:.1f}-{100 * self.scene_high:.1f} %;"
            f" {self.successes}/{self.attempts})"
        )


def pool(successes: ArrayLike, attempts: ArrayLike) -> Rate:
    """The rate over scenes, each with its counts.

    The scene interval is Wilson's at the effective number of attempts n / d, where d ≥ 1 is the design effect: the
    variance of the pooled rate estimated between scenes over that of independent attempts (W. G. Cochran, Sampling
    Techniques, ratio estimator for clusters). Without any variance between scenes (none or all succeeded) each scene
    counts as one attempt, the cautious choice.

    Args:
        successes: (S,) counts, one a scene.
        attempts: (S,) counts.
    """
    s, n = np.asarray(successes, float).reshape(-1), np.asarray(attempts, float).reshape(-1)
    s, n = s[n > 0], n[n > 0]
    total, good = float(n.sum()), float(s.sum())
    low, high = wilson(good, total)
    effective = _effective(s, n)
    p = good / total if total else 0.0
    scene_low, scene_high = wilson(p * effective, effective)
    return Rate(int(good), int(total), p if total else None, low, high, scene_low, scene_high)


def _effective(s: np.ndarray, n: np.ndarray) -> float:
    """Effective number of independent attempts of clustered counts."""
    scenes, total = len(n), float(n.sum())
    if scenes == total:
        return total
    p = float(s.sum()) / total
    independent = p * (1 - p) / total
    if scenes < 2 or independent == 0:
        return float(scenes)
    between = float(((s - p * n) ** 2).sum()) / total**2 * scenes / (scenes - 1)
    return max(1.0, total / max(1.0, between / independent))


def table(header: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """A plain table: the first column to the left, the others to the right."""
    cells = [[str(cell) for cell in row] for row in (header, *rows)]
    widths = [max(len(row[column]) for row in cells) for column in range(len(header))]
    lines = ["  ".join([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]).rstrip() for row in cells]
    return "\n".join([lines[0], "  ".join("-" * width for width in widths), *lines[1:]])
