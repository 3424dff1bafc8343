"""The speed of DART trials on the paper's grid over a fixed mix of objects, beside MuJoCo on the same grasps.

Rates are attempts per second of processor time of one process, so that other work on the machine changes them little;
each process takes one thread. MuJoCo executes the very attempts that took dynamics in DART, with the same noise, the
same protocol and the same stopping rules.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial

import msgspec
import numpy as np

from grasp_core.camera import canonical_camera
from grasp_core.dataset.generate import grid_grasps
from grasp_core.dataset.recipe import load_recipe
from grasp_core.errors import GraspError
from grasp_core.evaluation.seeds import generator
from grasp_core.evaluation.suites import PlannedObject, poses_of
from grasp_core.grasp import Grasp
from grasp_core.gripper import Gripper
from grasp_core.parallel import Executor, map_scenes
from grasp_core.scene import Scene
from grasp_core.sensing.renderer import render
from grasp_core.simulation.execution import Execution
from grasp_core.simulation.mujoco_engine import MujocoEngine
from grasp_core.simulation.physics import Physics
from grasp_core.simulation.trial import Attempt, GraspTrial, Outcome
from grasp_core.simulation.world import World

_ROUNDS = 6
"""Comparisons of one process with two, by turns: the speed of machines that others share drifts within seconds."""


class Spent(msgspec.Struct, frozen=True):
    """Dynamic attempts of one outcome in DART.

    Attributes:
        count: how many.
        dart: processor time of executing them, s.
        mujoco: processor time of executing the same in MuJoCo, however they end there, s.
    """

    count: int = 0
    dart: float = 0.0
    mujoco: float = 0.0

    def __add__(self, other: Spent) -> Spent:
        """Both together."""
        return Spent(self.count + other.count, self.dart + other.dart, self.mujoco + other.mujoco)


class Timed(msgspec.Struct, frozen=True):
    """Trials on one object.

    Attributes:
        name: of the object.
        outcomes: outcome → attempts.
        seconds: processor time of all of them, loading not counted.
        dynamic: attempts that took dynamics.
        by_outcome: outcome in DART → dynamic attempts that ended so, executed alone in both engines.
        agreement: share of them that MuJoCo calls a success or not as DART does.
        redraws: diverged executions.
        started: wall clock, s.
        ended: wall clock, s.
    """

    name: str
    outcomes: dict[str, int]
    seconds: float
    dynamic: int
    by_outcome: dict[str, Spent] = {}
    agreement: float | None = None
    redraws: int = 0
    started: float = 0.0
    ended: float = 0.0

    @property
    def executed(self) -> Spent:
        """All dynamic attempts."""
        return sum(self.by_outcome.values(), Spent())


class ObjectRow(msgspec.Struct, frozen=True):
    """One object of the benchmark: see `TrialSpeed`."""

    attempts: int
    dynamic: int
    attempts_per_second_per_core: float
    dynamic_attempts_per_second_per_core: float | None
    mujoco_dynamic_attempts_per_second_per_core: float | None


class OutcomeRow(msgspec.Struct, frozen=True):
    """The dynamic attempts of one outcome in DART: how many, and how fast each engine executes these very attempts."""

    dynamic: int
    dynamic_attempts_per_second_per_core: float | None
    mujoco_dynamic_attempts_per_second_per_core: float | None


class TrialSpeed(msgspec.Struct, frozen=True):
    """The benchmark's results.

    Attributes:
        attempts_per_second_per_core: all attempts, precheck included.
        dynamic_attempts_per_second_per_core: of those that take dynamics, DART.
        mujoco_dynamic_attempts_per_second_per_core: of the same, MuJoCo.
        mujoco_ratio: how many times faster MuJoCo is.
        mujoco_agreement: share of the dynamic attempts that both call a success or not alike, noise included.
        outcomes: outcome → attempts.
        dynamic_ms: outcome → processor time of a dynamic attempt in DART that ended so, ms, mean.
        by_outcome: outcome in DART → the rates of its dynamic attempts in both engines.
        two_process_speedup: how many times as many trials two processes get through in a second of work as one, median
            of the rounds, see `two_process_speedups`; None if not measured.
        two_process_rounds: of each round.
        attempts: all.
        dynamic_attempts: that took dynamics.
        unstable_share: diverged executions over all.
        objects: name → its rates.
    """

    attempts_per_second_per_core: float
    dynamic_attempts_per_second_per_core: float
    mujoco_dynamic_attempts_per_second_per_core: float
    mujoco_ratio: float
    mujoco_agreement: float
    outcomes: dict[str, int]
    dynamic_ms: dict[str, float]
    by_outcome: dict[str, OutcomeRow]
    two_process_speedup: float | None
    two_process_rounds: tuple[float, ...]
    attempts: int
    dynamic_attempts: int
    unstable_share: float
    objects: dict[str, ObjectRow]


class Work(msgspec.Struct, frozen=True):
    """What one process does: some of an object's grid."""

    plan: PlannedObject
    gripper: Gripper
    physics: Physics
    share: float
    attempts: int
    seed: int
    piece: int = 0
    pieces: int = 1


def _grasps(work: Work) -> tuple[Scene, list[Grasp]]:
    """The object in its likeliest pose, and this piece of a random share of the paper's grid on it."""
    asset = work.plan.make()
    scene = Scene.single(asset, poses_of(asset, work.physics)[0].pose, canonical_camera())
    grid = grid_grasps(scene.objects[0], render(scene), work.gripper, load_recipe("paper"))
    count = max(1, round(len(grid) * work.share))
    chosen = generator(work.seed, "trials", work.plan.name).permutation(len(grid))[:count]
    return scene, [grid[index] for index in chosen[work.piece :: work.pieces]]


def time_dart(work: Work) -> tuple[Timed, list[Attempt], Scene]:
    """Run the trials of one piece of work, after one attempt that warms up."""
    scene, grasps = _grasps(work)
    trial = GraspTrial(scene, work.gripper, work.physics)
    trial.attempt(Grasp((0.0, 0.0, 0.02), 0.0, work.gripper.opening), 0, record=True)
    started, begun = time.time(), time.process_time()
    done = trial.batch(grasps, work.attempts, work.seed)
    seconds, ended = time.process_time() - begun, time.time()
    attempts = [attempt for each in done for attempt in each.attempts]
    outcomes = Counter(str(attempt.outcome) for attempt in attempts)
    dynamic = [attempt for attempt in attempts if attempt.dynamic]
    redraws = sum(attempt.redraws for attempt in attempts)
    timed = Timed(work.plan.name, dict(outcomes), seconds, len(dynamic), redraws=redraws, started=started, ended=ended)
    return timed, dynamic, scene


def time_both(work: Work) -> Timed:
    """Run the trials, then their dynamic attempts alone in DART and in MuJoCo, turn by turn."""
    timed, dynamic, scene = time_dart(work)
    poses = [placed.world_from_object for placed in scene.objects]
    assets = [placed.asset for placed in scene.objects]
    trial = GraspTrial(scene, work.gripper, work.physics, None)
    runs = [
        Execution(World(assets, work.physics, work.gripper, poses=poses), poses),
        Execution(MujocoEngine(assets, work.physics, work.gripper), poses),
    ]
    by_outcome: dict[str, Spent] = {}
    same = 0
    for number, attempt in enumerate(dynamic):
        way = trial.free_way(attempt.executed)
        outcomes, spent = [Outcome.UNSTABLE] * 2, [0.0, 0.0]
        for index in (0, 1) if number % 2 else (1, 0):
            begun = time.process_time()
            outcomes[index], _, _ = runs[index].run(attempt.executed, way, whole=False, recorder=None)
            spent[index] = time.process_time() - begun
        ended = str(outcomes[0])
        by_outcome[ended] = by_outcome.get(ended, Spent()) + Spent(1, *spent)
        same += (outcomes[0] is Outcome.SUCCESS) == (outcomes[1] is Outcome.SUCCESS)
    agreement = same / len(dynamic) if dynamic else None
    return msgspec.structs.replace(timed, by_outcome=by_outcome, agreement=agreement)


def _time_piece(work: Work) -> Timed:
    return time_dart(work)[0]


def two_process_speedups(works: Sequence[Work]) -> list[float]:
    """Throughput of two processes over that of one on the same trials, of each round.

    The wall time that a process spends in trials is summed over the pieces of work; the ratio is that sum in one
    process over half that in two. It says what two processes cost each other, through shared caches, memory and power.
    Loading objects, handing out work and waiting for the last piece do not count: a whole run gains a little less.
    Each round takes other pieces of the works, and begins with the one or with the two by turns.
    """
    speedups = []
    for number in range(_ROUNDS):
        pieces = [msgspec.structs.replace(work, piece=number, pieces=_ROUNDS) for work in works]
        busy = {}
        for workers in (1, 2) if number % 2 else (2, 1):
            timed = [result for _, result in map_scenes(_time_piece, pieces, Executor(workers=workers))]
            busy[workers] = sum(each.ended - each.started for each in timed) / workers
        speedups.append(busy[1] / busy[2])
    return speedups


def run_trials(
    plans: Sequence[PlannedObject],
    gripper: Gripper,
    physics: Physics,
    *,
    share: float = 1.0,
    attempts: int = 5,
    seed: int = 0,
    two: bool = True,
    progress: Callable[[str], None] = lambda name: None,
) -> TrialSpeed:
    """Measure the speed of trials.

    Args:
        plans: the objects, each taken in its likeliest stable pose.
        gripper: executes.
        physics: of the world.
        share: of the paper's 726 grasps, drawn at random.
        attempts: a grasp.
        seed: of everything random.
        two: also compare the throughput of two processes with that of one.
        progress: is told the name of each object as it begins.

    Raises:
        GraspError: no objects, a share outside (0, 1], no attempt that takes dynamics, or MuJoCo is not installed.
    """
    if not plans or not 0 < share <= 1:
        raise GraspError(f"the benchmark needs objects and a share of their grids above 0 and up to 1, not {share}")
    works = [Work(plan, gripper, physics, share, attempts, seed) for plan in plans]
    timed = []
    for work in works:
        progress(work.plan.name)
        timed.append(time_both(work))
    if not sum(each.dynamic for each in timed):
        raise GraspError("no attempt took dynamics; take a larger share of the grid or other objects")
    return summarise(timed, two_process_speedups(works) if two else [])


def summarise(timed: Sequence[Timed], speedups: Sequence[float]) -> TrialSpeed:
    """Pool the objects, and the rounds with two processes."""
    outcomes = sum((Counter(each.outcomes) for each in timed), Counter())
    count, dynamic = sum(outcomes.values()), sum(each.dynamic for each in timed)
    by_outcome: dict[str, Spent] = {}
    for name, spent in (item for each in timed for item in each.by_outcome.items()):
        by_outcome[name] = by_outcome.get(name, Spent()) + spent
    executed = sum(by_outcome.values(), Spent())
    redraws = sum(each.redraws for each in timed)
    same = sum((each.agreement or 0.0) * each.dynamic for each in timed)
    return TrialSpeed(
        attempts_per_second_per_core=_rate(count, sum(each.seconds for each in timed)) or 0.0,
        dynamic_attempts_per_second_per_core=_rate(dynamic, executed.dart) or 0.0,
        mujoco_dynamic_attempts_per_second_per_core=_rate(dynamic, executed.mujoco) or 0.0,
        mujoco_ratio=round(executed.dart / executed.mujoco, 3) if executed.mujoco else 0.0,
        mujoco_agreement=round(same / dynamic, 4) if dynamic else 0.0,
        outcomes=dict(outcomes),
        dynamic_ms={name: round(spent.dart / spent.count * 1000, 3) for name, spent in sorted(by_outcome.items())},
        by_outcome={
            name: OutcomeRow(spent.count, _rate(spent.count, spent.dart), _rate(spent.count, spent.mujoco))
            for name, spent in sorted(by_outcome.items())
        },
        two_process_speedup=round(float(np.median(speedups)), 3) if speedups else None,
        two_process_rounds=tuple(round(speedup, 3) for speedup in speedups),
        attempts=count,
        dynamic_attempts=dynamic,
        unstable_share=round(redraws / (count + redraws), 6),
        objects={each.name: _row(each) for each in timed},
    )


def _rate(count: int, seconds: float) -> float | None:
    return round(count / seconds, 2) if seconds > 0 else None


def _row(each: Timed) -> ObjectRow:
    count, executed = sum(each.outcomes.values()), each.executed
    rate = partial(_rate, each.dynamic)
    return ObjectRow(count, each.dynamic, _rate(count, each.seconds) or 0.0, rate(executed.dart), rate(executed.mujoco))
