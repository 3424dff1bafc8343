"""The cross-check over a list of objects: resumable, in parallel, with tables and a picture of each disagreement."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

import msgspec
import numpy as np

from grasp_core.errors import GraspError
from grasp_core.evaluation.disagreements import Disagreement, Key, disagreements
from grasp_core.evaluation.suites import PlannedObject
from grasp_core.evaluation.verdicts import LOG, REFERENCE, Line, Plan, Work, all_work, judge, open_log, scene_and_grasps
from grasp_core.grasp import Grasp
from grasp_core.gripper import Gripper
from grasp_core.parallel import Executor, map_scenes
from grasp_core.rates import wilson
from grasp_core.scene import Scene
from grasp_core.simulation.crosscheck import ENGINES, Agreement, agree, correlation
from grasp_core.simulation.evidence import Outcome
from grasp_core.simulation.physics import Physics

_CORRELATION, _UNSTABLE = 0.95, 0.001
"""Goals: least correlation of qualities, largest share of diverged executions."""
_Z = 1.96


class Goal(msgspec.Struct, frozen=True):
    """A figure beside what it should be.

    Attributes:
        figure: measured; None where it is undefined.
        low: lower end of its 95 % interval: Wilson's of a share, Fisher's of a correlation.
        high: upper end.
        goal: least figure wanted, of "unstable" the bound that it should stay below.
        met: whether the figure itself reaches it; None where it is undefined.
    """

    figure: float | None
    low: float | None
    high: float | None
    goal: float
    met: bool | None


class Comparison(msgspec.Struct, frozen=True):
    """One engine against DART, over the grasps on which neither diverged.

    Attributes:
        words: what the engine is.
        goal: least agreement.
        all: over every grasp.
        objects: name → agreement on it.
        pictures: class of disagreement ("ONE→OTHER") → file.
        disagreements: the same classes → how many, of which objects, and what the films say.
        left_out: share of the grasps on which either engine diverged.
    """

    words: str
    goal: float
    all: Agreement
    objects: dict[str, Agreement]
    pictures: dict[str, str]
    disagreements: dict[str, Disagreement]
    left_out: float


class Unstable(msgspec.Struct, frozen=True):
    """Executions of one engine that diverged, out of all, noisy ones included."""

    diverged: int
    executions: int


class Crosscheck(msgspec.Struct, frozen=True):
    """The report.

    Attributes:
        engines: name → how it compares with DART.
        quality_correlation: of DART's and MuJoCo's qualities under Eq. 4 noise; None if not measured, or undefined
            because all qualities of an engine are equal.
        quality_difference: mean absolute difference of those.
        qualities: how many grasps that is.
        unstable: engine → diverged executions.
        goals: engine, "correlation" or "unstable" (of DART) → its figure beside its goal.
    """

    engines: dict[str, Comparison]
    quality_correlation: float | None
    quality_difference: float | None
    qualities: int
    unstable: dict[str, Unstable]
    goals: dict[str, Goal]


def run_crosscheck(
    sources: Sequence[PlannedObject],
    plan: Plan,
    gripper: Gripper,
    physics: Physics,
    out: Path,
    executor: Executor | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Crosscheck:
    """Judge everything that the log in `out` does not hold yet, then compare and draw.

    Raises:
        GraspError: `out` holds the log of another comparison, MuJoCo is needed and not installed, or no grasp can be
            compared.
    """
    lines = open_log(out, plan)
    works = all_work(sources, plan, gripper, physics)
    known = {line.key for line in lines}
    left = [work for work in works if work.key not in known]
    progress(len(works) - len(left), len(works))
    with (out / LOG).open("ab") as log:
        for number, (_, line) in enumerate(map_scenes(judge, left, executor), 1):
            log.write(msgspec.json.encode(line) + b"\n")
            log.flush()
            lines.append(line)
            progress(len(works) - len(left) + number, len(works))
    return _report(sources, plan, gripper, physics, lines, out)


def _report(
    sources: Sequence[PlannedObject], plan: Plan, gripper: Gripper, physics: Physics, lines: Sequence[Line], out: Path
) -> Crosscheck:
    verdicts: dict[str, dict[Key, str]] = {name: {} for name in (REFERENCE, *plan.engines)}
    qualities: dict[str, dict[Key, float]] = {REFERENCE: {}, "mujoco": {}}
    for line in lines:
        for number, outcome in enumerate(line.outcomes, line.start):
            verdicts[line.engine][line.object, line.pose, number] = outcome
        for number, quality in enumerate(line.qualities, line.start):
            if quality is not None:
                qualities[line.engine][line.object, line.pose, number] = quality
    by_name = {source.name: source for source in sources}

    def grasp_of(key: Key) -> tuple[Scene, Grasp]:
        scene, grasps = scene_and_grasps(Work(by_name[key[0]], key[1], REFERENCE, 0, False, plan, gripper, physics))
        return scene, grasps[key[2]]

    reference = verdicts[REFERENCE]
    if not reference:
        raise GraspError("no grasp on these objects needs dynamics; take other objects or more grasps")
    engines = {}
    for name in plan.engines:
        classes = disagreements(reference, verdicts[name], name, grasp_of, gripper, physics, out)
        engines[name] = _compare(name, list(by_name), reference, verdicts[name], classes)
    both = sorted(set(qualities[REFERENCE]) & set(qualities["mujoco"]))
    first, second = ([qualities[name][key] for key in both] for name in (REFERENCE, "mujoco"))
    defined = both and min(np.ptp(first), np.ptp(second)) > 0
    unstable = {name: _unstable(name, plan, lines) for name in verdicts}
    result = Crosscheck(
        engines,
        round(correlation(first, second), 4) if defined else None,
        round(float(np.abs(np.subtract(first, second)).mean()), 4) if both else None,
        len(both),
        unstable,
        {},
    )
    return msgspec.structs.replace(result, goals=_goals(result))


def _compare(
    name: str,
    objects: Sequence[str],
    first: dict[Key, str],
    second: dict[Key, str],
    classes: dict[str, Disagreement],
) -> Comparison:
    keys = [key for key in sorted(first) if Outcome.UNSTABLE not in (first[key], second[key])]
    if not keys:
        raise GraspError(f"DART or '{name}' diverged on every grasp, so that nothing can be compared; mend the physics")
    mine = {source: [key for key in keys if key[0] == source] for source in objects}

    def agreement(chosen: Sequence[Key]) -> Agreement:
        return agree([first[key] for key in chosen], [second[key] for key in chosen])

    return Comparison(
        words=ENGINES[name].words,
        goal=ENGINES[name].goal,
        all=agreement(keys),
        objects={source: agreement(chosen) for source, chosen in mine.items() if chosen},
        pictures={words: each.picture for words, each in classes.items()},
        disagreements=classes,
        left_out=round(1 - len(keys) / len(first), 6),
    )


def _unstable(name: str, plan: Plan, lines: Sequence[Line]) -> Unstable:
    mine = [line for line in lines if line.engine == name]
    outcomes = Counter(outcome for line in mine for outcome in line.outcomes)
    noisy = sum(len(line.qualities) for line in mine) * plan.attempts
    diverged = outcomes[Outcome.UNSTABLE] + sum(line.diverged for line in mine)
    return Unstable(diverged, outcomes.total() + noisy)


def _goals(result: Crosscheck) -> dict[str, Goal]:
    goals = {}
    for name, comparison in result.engines.items():
        pairs = comparison.all.confusion.items()
        same = sum(n for pair, n in pairs if pair.split("→").count(Outcome.SUCCESS) != 1)
        goals[name] = _share(
            same, comparison.all.count, comparison.goal, same >= comparison.goal * comparison.all.count - 1e-9
        )
    if result.qualities:
        goals["correlation"] = _correlation(result.quality_correlation, result.qualities)
    dart = result.unstable[REFERENCE]
    goals["unstable"] = _share(dart.diverged, dart.executions, _UNSTABLE, dart.diverged < _UNSTABLE * dart.executions)
    return goals


def _share(count: int, total: int, goal: float, met: bool) -> Goal:
    low, high = wilson(count, total)
    return Goal(round(count / total, 6), round(low, 6), round(high, 6), goal, met)


def _correlation(r: float | None, count: int) -> Goal:
    """The correlation with Fisher's interval (R. A. Fisher, 1921), which needs four grasps and |r| < 1."""
    if r is None:
        return Goal(None, None, None, _CORRELATION, None)
    low = high = None
    if count > 3 and abs(r) < 1:
        z, half = math.atanh(r), _Z / math.sqrt(count - 3)
        low, high = round(math.tanh(z - half), 4), round(math.tanh(z + half), 4)
    return Goal(r, low, high, _CORRELATION, r >= _CORRELATION)
