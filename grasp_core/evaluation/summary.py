"""The metrics of the success benchmark, computed from its log alone."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from itertools import combinations

import msgspec
import numpy as np

from grasp_core.evaluation.benchmark import ORACLE
from grasp_core.evaluation.paired import Paired, compare
from grasp_core.evaluation.records import Log, PlanRecord, SceneRecord
from grasp_core.evaluation.report import Rate, pool, table
from grasp_core.evaluation.variety import FIVE, count_distinct
from grasp_core.training.metrics import ece

THRESHOLDS = (0.3, 0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95)
"""Least scores t at which a planner with networks is looked at again."""


class AtThreshold(msgspec.Struct, frozen=True):
    """What a planner would have come to with a higher t; it would also have looked at more regions.

    Attributes:
        threshold: t.
        top1: as in `PlannerSummary`.
        all: as there.
        empty: as there.
        abstained_on_ungraspable: as there.
    """

    threshold: float
    top1: Rate
    all: Rate
    empty: int
    abstained_on_ungraspable: int


class PlannerSummary(msgspec.Struct, frozen=True):
    """One planner's figures.

    Attributes:
        top1: executions of the best candidate on graspable scenes; an empty plan there counts as that many failures.
        all: executions of every returned candidate on graspable scenes.
        scenes: scenes that were planned on.
        graspable: those in which the oracle knows a grasp.
        ungraspable: the others.
        empty: empty plans on graspable scenes.
        abstained_on_ungraspable: empty plans on ungraspable scenes.
        grasped_ungraspable: ungraspable scenes where the best candidate succeeded every time: the oracle's grid missed
            a grasp there.
        plan_median_ms: of the wall time of a plan; None without scenes.
        candidates_median: returned candidates on graspable scenes.
        five_candidates: graspable scenes with at least five candidates.
        calibration_error: of the scores of all executed candidates against the shares of them that succeeded, in ten
            bins; None for planners without networks and without candidates.
        at_thresholds: of planners with networks, from the least score that they returned on.
        outcomes: of the best candidates' executions on graspable scenes, by name.
        redrawn: executions whose solver diverged, on all scenes; they count as failures.
        weights: name and digest of what was planned with, one unless the weights changed under their name.
        objects: per object, top1 on graspable scenes.
        oracle_five: graspable scenes in which the oracle knows at least five distinct grasps; of logs that do not tell
            how many it knows, those where five of the grasps that it returned are distinct.
        five_where_oracle: of these, the scenes where this planner returned at least five, which are distinct.
        against: other planner → what this one has over it on the graspable scenes that both planned on.
        shape_off: per object, the share of what is seen where its simulated parts stand off it; see `SceneRecord`.
    """

    top1: Rate
    all: Rate
    scenes: int
    graspable: int
    ungraspable: int
    empty: int
    abstained_on_ungraspable: int
    grasped_ungraspable: int
    plan_median_ms: float | None
    candidates_median: float | None
    five_candidates: int
    calibration_error: float | None
    at_thresholds: tuple[AtThreshold, ...]
    outcomes: dict[str, int]
    redrawn: int
    weights: list[str]
    objects: dict[str, Rate]
    shape_off: dict[str, float]
    oracle_five: int
    five_where_oracle: int
    against: dict[str, Paired]


def summarise(log: Log, attempts: int) -> dict[str, PlannerSummary]:
    """Planner → its figures over the scenes of a log.

    Args:
        log: the raw outcomes.
        attempts: executions a candidate, which an empty plan loses.
    """
    names = dict.fromkeys(planner for _, planner in log.plans)
    plans = {name: {scene: plan for (scene, planner), plan in log.plans.items() if planner == name} for name in names}
    oracle = plans.get(ORACLE, {})
    rich = {name for name, scene in log.scenes.items() if _known(scene, oracle.get(name)) >= FIVE}
    return {
        name: _planner(
            [(log.scenes[scene], plan) for scene, plan in own.items()],
            attempts,
            rich,
            {
                other: compare([(own[s], theirs[s]) for s in own if s in theirs and log.scenes[s].graspable], attempts)
                for other, theirs in plans.items()
                if other != name
            },
        )
        for name, own in plans.items()
    }


def _known(scene: SceneRecord, oracle: PlanRecord | None) -> int:
    """How many distinct grasps the oracle knows, at least."""
    if scene.distinct is not None:
        return scene.distinct
    return count_distinct([candidate.grasp for candidate in oracle.candidates]) if oracle else 0


def _planner(
    pairs: list[tuple[SceneRecord, PlanRecord]], attempts: int, rich: set[str], against: dict[str, Paired]
) -> PlannerSummary:
    good = [(scene, plan) for scene, plan in pairs if scene.graspable]
    bad = [plan for scene, plan in pairs if not scene.graspable]
    by_object: dict[str, list[PlanRecord]] = {}
    for scene, plan in good:
        by_object.setdefault(scene.spec.object, []).append(plan)
    outcomes: Counter[str] = Counter()
    for _, plan in good:
        outcomes.update(plan.candidates[0].outcomes if plan.candidates else {"EMPTY": attempts})
    times = [plan.plan_ms for _, plan in pairs]
    return PlannerSummary(
        top1=_top1((plan for _, plan in good), attempts),
        all=_all([plan for _, plan in good]),
        scenes=len(pairs),
        graspable=len(good),
        ungraspable=len(bad),
        empty=sum(not plan.candidates for _, plan in good),
        abstained_on_ungraspable=sum(not plan.candidates for plan in bad),
        grasped_ungraspable=sum(
            bool(plan.candidates) and plan.candidates[0].successes == len(plan.candidates[0].outcomes) for plan in bad
        ),
        plan_median_ms=round(float(np.median(times)), 3) if times else None,
        candidates_median=float(np.median([len(plan.candidates) for _, plan in good])) if good else None,
        five_candidates=sum(len(plan.candidates) >= FIVE for _, plan in good),
        calibration_error=_calibration([plan for _, plan in pairs if plan.weights]),
        at_thresholds=_at_thresholds([plan for _, plan in good], bad, attempts),
        outcomes=dict(sorted(outcomes.items())),
        redrawn=sum(bool(r) for _, plan in pairs for candidate in plan.candidates for r in candidate.redraws),
        weights=sorted({plan.weights for _, plan in pairs if plan.weights}),
        objects={name: _top1(plans, attempts) for name, plans in sorted(by_object.items())},
        shape_off={scene.spec.object: scene.shape_off for scene, _ in sorted(good, key=lambda pair: pair[0].spec.name)},
        oracle_five=sum(scene.spec.name in rich for scene, _ in good),
        five_where_oracle=sum(scene.spec.name in rich and len(plan.candidates) >= FIVE for scene, plan in good),
        against=against,
    )


def _top1(plans: Iterable[PlanRecord], attempts: int) -> Rate:
    counts = [
        (plan.candidates[0].successes, len(plan.candidates[0].outcomes)) if plan.candidates else (0, attempts)
        for plan in plans
    ]
    return pool([s for s, _ in counts], [n for _, n in counts])


def _all(plans: Sequence[PlanRecord]) -> Rate:
    return pool(
        [sum(candidate.successes for candidate in plan.candidates) for plan in plans],
        [sum(len(candidate.outcomes) for candidate in plan.candidates) for plan in plans],
    )


def _calibration(plans: Sequence[PlanRecord]) -> float | None:
    """Expected calibration error in ten bins of the executed candidates of planners with networks."""
    executed = [candidate for plan in plans for candidate in plan.candidates]
    if not executed:
        return None
    scores = [candidate.score for candidate in executed]
    shares = [candidate.successes / len(candidate.outcomes) for candidate in executed]
    return round(ece(scores, shares, 10), 4)


def _at_thresholds(good: Sequence[PlanRecord], bad: Sequence[PlanRecord], attempts: int) -> tuple[AtThreshold, ...]:
    """The figures for every threshold that lies above what was returned anyway."""
    scores = [candidate.score for plan in (*good, *bad) if plan.weights for candidate in plan.candidates]
    found = []
    for threshold in THRESHOLDS if scores else ():
        if threshold < min(scores):
            continue
        kept_good, kept_bad = (
            [
                msgspec.structs.replace(plan, candidates=tuple(c for c in plan.candidates if c.score >= threshold))
                for plan in plans
            ]
            for plans in (good, bad)
        )
        found.append(
            AtThreshold(
                threshold,
                _top1(kept_good, attempts),
                _all(kept_good),
                sum(not plan.candidates for plan in kept_good),
                sum(not plan.candidates for plan in kept_bad),
            )
        )
    return tuple(found)


def text(summaries: dict[str, PlannerSummary]) -> str:
    """The figures for people: planners first, then the objects; intervals are the ones over scenes."""
    if not summaries:
        return "nothing was planned: no object came through"
    rows = [
        (
            name,
            s.top1.text,
            s.all.text,
            f"{s.graspable}/{s.scenes}",
            s.empty,
            f"{s.five_where_oracle}/{s.oracle_five}",
            f"{s.abstained_on_ungraspable}/{s.ungraspable}",
            "-" if s.plan_median_ms is None else f"{s.plan_median_ms:.1f}",
        )
        for name, s in summaries.items()
    ]
    head = ("planner", "top-1", "all candidates", "graspable", "empty", "five", "abstained", "plan ms")
    objects = list(dict.fromkeys(name for s in summaries.values() for name in s.objects))
    off = {name: f"{100 * s.shape_off[name]:.0f} %" for s in summaries.values() for name in s.shape_off}
    cells = [
        (
            name,
            *(
                f"{s.objects[name].successes}/{s.objects[name].attempts}" if name in s.objects else "-"
                for s in summaries.values()
            ),
            off[name],
        )
        for name in objects
    ]
    lines = [table(head, rows), "", table(("top-1 by object", *summaries, "parts off"), cells)]
    lines += ["", *(f"{name}: {', '.join(f'{o} {n}' for o, n in s.outcomes.items())}" for name, s in summaries.items())]
    for name, s in summaries.items():
        if s.at_thresholds:
            lines += ["", *_threshold_lines(name, s)]
    if len(summaries) > 1:
        lines += ["", *_difference_lines(summaries)]
    lines += ["", "five: scenes with at least five candidates, of those where the oracle knows five distinct grasps"]
    return "\n".join(lines)


def _difference_lines(summaries: dict[str, PlannerSummary]) -> list[str]:
    """Every pair of planners once, those with networks first."""
    names = sorted(summaries, key=lambda name: not summaries[name].weights)
    rows = [
        (f"{one} - {two}", summaries[one].against[two].top1.text, summaries[one].against[two].all.text)
        for one, two in combinations(names, 2)
    ]
    return [
        table(("difference", "top-1", "all, where both returned some"), rows),
        "percentage points on the same graspable scenes, with paired 95 % intervals over scenes",
    ]


def _threshold_lines(name: str, s: PlannerSummary) -> list[str]:
    rows = [
        (f"{a.threshold:.2f}", a.top1.text, a.all.text, a.empty, f"{a.abstained_on_ungraspable}/{s.ungraspable}")
        for a in s.at_thresholds
    ]
    head = (f"{name} with t", "top-1", "all candidates", "empty", "abstained")
    return [table(head, rows), f"calibration error of what was executed: {s.calibration_error:.3f}"]
