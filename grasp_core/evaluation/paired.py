"""Two planners on the same graspable scenes: the difference of their rates of success, with its interval."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
import numpy as np

from grasp_core.evaluation.records import PlanRecord

_Z = 1.959963984540054
"""Standard normal quantile of a two-sided 95 % interval."""


class Difference(msgspec.Struct, frozen=True):
    """One planner's rate of success less another's.

    Attributes:
        scenes: that were compared.
        difference: of the rates pooled over these scenes; None without scenes.
        low: lower end of its 95 % interval.
        high: its upper end.
    """

    scenes: int
    difference: float | None
    low: float
    high: float

    @property
    def text(self) -> str:
        """For people: `-1.2 (-2.9 to +0.4), 282 scenes`, in percentage points."""
        if self.difference is None:
            return "no scenes"
        return f"{100 * self.difference:+.1f} ({100 * self.low:+.1f} to {100 * self.high:+.1f}), {self.scenes} scenes"


class Paired(msgspec.Struct, frozen=True):
    """One planner against another.

    Attributes:
        top1: of the best candidates, on all graspable scenes that both planned on; an empty plan counts as failed.
        all: of all returned candidates, on those of these scenes where both returned some.
    """

    top1: Difference
    all: Difference


def compare(pairs: Sequence[tuple[PlanRecord, PlanRecord]], attempts: int) -> Paired:
    """What the first of two planners has over the second.

    Args:
        pairs: both plans for each graspable scene that both planned on.
        attempts: executions a candidate, which an empty plan loses.
    """
    both = [(one, two) for one, two in pairs if one.candidates and two.candidates]
    return Paired(
        _difference([(_best(one, attempts), _best(two, attempts)) for one, two in pairs]),
        _difference([(_whole(one), _whole(two)) for one, two in both]),
    )


def _best(plan: PlanRecord, attempts: int) -> tuple[int, int]:
    return (plan.candidates[0].successes, len(plan.candidates[0].outcomes)) if plan.candidates else (0, attempts)


def _whole(plan: PlanRecord) -> tuple[int, int]:
    return sum(c.successes for c in plan.candidates), sum(len(c.outcomes) for c in plan.candidates)


def _difference(counts: Sequence[tuple[tuple[int, int], tuple[int, int]]]) -> Difference:
    """Difference of pooled rates from (S, 2, 2) counts, scene by planner by (successes, attempts).

    The interval is the normal one over scenes, each with both its plans: the variance is that of the difference of two
    ratios, linearised (W. G. Cochran, Sampling Techniques, 3rd edition 1977, section 6.19). With one candidate a plan
    that is the paired normal interval of the mean difference.
    """
    if not counts:
        return Difference(0, None, -1.0, 1.0)
    table, scenes = np.array(counts, float), len(counts)  # (S, planner, successes or attempts)
    good, made = table.sum(axis=0).T
    rates = good / made
    off = ((table[:, :, 0] - rates * table[:, :, 1]) / made * scenes) @ [1, -1]
    difference = float(rates[0] - rates[1])
    half = _Z * float(np.sqrt((off**2).sum() / (scenes * (scenes - 1)))) if scenes > 1 else 2.0
    return Difference(scenes, difference, max(-1.0, difference - half), min(1.0, difference + half))
