"""Rates of success and how sure they are."""

from __future__ import annotations

import math

from grasp_core.errors import GraspError

_Z = 1.959963984540054
"""Standard normal quantile of a two-sided 95 % interval."""


def wilson(successes: float, attempts: float, z: float = _Z) -> tuple[float, float]:
    """Wilson's score interval of a proportion (E. B. Wilson, 1927), 95 % by default; (0, 1) without attempts.

    Raises:
        GraspError: more successes than attempts, or fewer than none.
    """
    if not 0 <= successes <= attempts:
        raise GraspError(f"{successes} successes in {attempts} attempts make no rate; give counts with 0 ≤ s ≤ n")
    if attempts == 0:
        return 0.0, 1.0
    p = successes / attempts
    scale = 1 + z * z / attempts
    centre = (p + z * z / (2 * attempts)) / scale
    half = z * math.sqrt(p * (1 - p) / attempts + z * z / (4 * attempts * attempts)) / scale
    low = 0.0 if successes == 0 else max(0.0, centre - half)
    high = 1.0 if successes == attempts else min(1.0, centre + half)
    return low, high
