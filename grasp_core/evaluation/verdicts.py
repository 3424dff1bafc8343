"""What a cross-check judges, piece by piece, and the log that lets it go on where it was stopped."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import msgspec
import numpy as np

from grasp_core import config
from grasp_core.errors import GraspError
from grasp_core.evaluation.cache import code_digest
from grasp_core.evaluation.machine import versions
from grasp_core.evaluation.seeds import child_seed
from grasp_core.evaluation.suites import PlannedObject, poses_of
from grasp_core.grasp import Grasp
from grasp_core.gripper import Gripper
from grasp_core.parallel import Executor, map_scenes
from grasp_core.scene import Scene
from grasp_core.simulation.crosscheck import ENGINES, Judge, open_grasps
from grasp_core.simulation.evidence import Outcome
from grasp_core.simulation.physics import Physics
from grasp_core.simulation.trial import GraspNoise
from grasp_core.simulation.trial import child_seed as attempt_seed

REFERENCE = "dart"
"""The engine that the others are compared with."""
CHUNK = 50
"""Grasps that are judged between two lines of the log."""
LOG = "verdicts.jsonl"
_CODE = ("simulation", "evaluation/verdicts.py")
_SIMULATORS = ("dartpy", "mujoco")
_HERE = Executor(workers=0)


class Plan(msgspec.Struct, frozen=True, kw_only=True):
    """What is compared, and all that the verdicts follow from.

    Attributes:
        objects: name → digest of the asset, in order.
        engines: of `ENGINES`, without the reference.
        grasps: noiseless ones an object that need dynamics, spread over its poses.
        poses: stable poses an object, at most.
        noisy: grasps an object whose qualities are compared, if MuJoCo is among the engines.
        attempts: executions of each of those.
        seed: of the choice of grasps and the noise.
        physics: digest.
        gripper: digest.
        code: digest of the code that simulates and judges.
        simulators: package → installed version.
    """

    objects: dict[str, str]
    engines: tuple[str, ...]
    grasps: int
    poses: int
    noisy: int
    attempts: int
    seed: int
    physics: str
    gripper: str
    code: str
    simulators: dict[str, str]

    @property
    def digest(self) -> str:
        """A hash of everything: comparisons that differ in anything have folders of their own."""
        return config.digest(self)


def make_plan(
    sources: Sequence[PlannedObject],
    engines: Sequence[str],
    gripper: Gripper,
    physics: Physics,
    *,
    grasps: int,
    poses: int,
    noisy: int,
    attempts: int,
    seed: int,
    executor: Executor = _HERE,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Plan:
    """Describe a comparison, see `Plan`; makes the objects, since verdicts follow from what they are.

    Raises:
        GraspError: no or an unknown engine, the reference among them, or numbers below what they can be.
    """
    if grasps < 1 or poses < 1 or noisy < 0 or attempts < 1 or seed < 0:
        raise GraspError("--grasps, --poses and --attempts must be at least 1, --noisy and --seed at least 0")
    others = ", ".join(name for name in ENGINES if name != REFERENCE)
    if not engines:
        raise GraspError(f"--engines names nothing to compare with DART; choose from: {others}")
    for name in engines:
        if name == REFERENCE:
            raise GraspError(f"'{name}' is what the other engines are compared with; choose from: {others}")
        if name not in ENGINES:
            raise GraspError(f"'{name}' is no engine; choose from: {others}")
    used = _SIMULATORS if "mujoco" in engines else _SIMULATORS[:1]
    digests: dict[int, str] = {}
    progress(0, len(sources))
    for index, digest in map_scenes(_asset_digest, sources, executor):
        digests[index] = digest
        progress(len(digests), len(sources))
    return Plan(
        objects={source.name: digests[index] for index, source in enumerate(sources)},
        engines=tuple(dict.fromkeys(engines)),
        grasps=grasps,
        poses=poses,
        noisy=noisy,
        attempts=attempts,
        seed=seed,
        physics=physics.digest,
        gripper=gripper.digest,
        code=code_digest(*_CODE),
        simulators={name: version for name, version in versions().items() if name in used},
    )


def _asset_digest(source: PlannedObject) -> str:
    return source.make().digest


class Line(msgspec.Struct, frozen=True):
    """One line of the log: some grasps on one pose in one engine; with nothing in it, the pose has no more grasps.

    Attributes:
        object: name.
        pose: index of the stable pose.
        engine: of `ENGINES`.
        start: number of the first grasp on this pose.
        noisy: whether the grasps were executed with noise.
        outcomes: one a grasp without noise.
        qualities: one a grasp with noise: successes over the attempts that did not diverge, None if all did.
        diverged: attempts with noise that did.
    """

    object: str
    pose: int
    engine: str
    start: int
    noisy: bool
    outcomes: tuple[str, ...] = ()
    qualities: tuple[float | None, ...] = ()
    diverged: int = 0

    @property
    def key(self) -> tuple[str, int, str, int, bool]:
        """What tells one piece of work from another."""
        return self.object, self.pose, self.engine, self.start, self.noisy


class Work(msgspec.Struct, frozen=True):
    """One piece of work for a process."""

    source: PlannedObject
    pose: int
    engine: str
    start: int
    noisy: bool
    plan: Plan
    gripper: Gripper
    physics: Physics

    @property
    def key(self) -> tuple[str, int, str, int, bool]:
        """That of the line it makes."""
        return self.source.name, self.pose, self.engine, self.start, self.noisy


def all_work(sources: Sequence[PlannedObject], plan: Plan, gripper: Gripper, physics: Physics) -> list[Work]:
    """Everything that the plan judges; with noise DART and MuJoCo alone, and only if MuJoCo is compared at all."""
    noiseless = (REFERENCE, *plan.engines)
    noisy = (REFERENCE, "mujoco") if "mujoco" in plan.engines else ()
    return [
        Work(source, pose, engine, start, with_noise, plan, gripper, physics)
        for source in sources
        for with_noise in (False, True)
        for pose in range(plan.poses)
        for engine in (noisy if with_noise else noiseless)
        for start in range(0, plan.noisy if with_noise else plan.grasps, CHUNK)
    ]


def scene_and_grasps(work: Work) -> tuple[Scene, list[Grasp]]:
    """The scene, and all grasps that are judged on it; none where the object has no such pose."""
    asset = work.source.make()
    poses = poses_of(asset, work.physics)[: work.plan.poses]
    if work.pose >= len(poses):
        return Scene.single(asset, poses[0].pose), []
    scene = Scene.single(asset, poses[work.pose].pose)
    total = work.plan.noisy if work.noisy else work.plan.grasps
    share = total // len(poses) + (work.pose < total % len(poses))
    seed = child_seed(work.plan.seed, "crosscheck", work.source.name, work.pose, int(work.noisy))
    return scene, open_grasps(scene, work.gripper, work.physics, share, seed)


def judge(work: Work) -> Line:
    """Judge one chunk of grasps in one engine."""
    scene, grasps = scene_and_grasps(work)
    chunk = grasps[work.start : work.start + CHUNK]
    line = Line(*work.key)
    if not chunk:
        return line
    judge_ = Judge(work.engine, scene, work.gripper, work.physics)
    if not work.noisy:
        return msgspec.structs.replace(line, outcomes=tuple(str(judge_.verdict(grasp)) for grasp in chunk))
    noise = GraspNoise()
    qualities: list[float | None] = []
    diverged = 0
    for number, grasp in enumerate(chunk, work.start):
        seed = child_seed(work.plan.seed, "crosscheck noise", work.source.name, work.pose, number)
        seeds = [attempt_seed(seed, attempt) for attempt in range(work.plan.attempts)]
        outcomes = [judge_.verdict(noise.draw(grasp, np.random.default_rng(each))) for each in seeds]
        decided = [outcome is Outcome.SUCCESS for outcome in outcomes if outcome is not Outcome.UNSTABLE]
        qualities.append(sum(decided) / len(decided) if decided else None)
        diverged += len(outcomes) - len(decided)
    return msgspec.structs.replace(line, qualities=tuple(qualities), diverged=diverged)


def open_log(out: Path, plan: Plan) -> list[Line]:
    """The lines of an earlier run of the same plan; a new log begins with the plan.

    Raises:
        GraspError: the folder holds the log of another comparison, or one made with other code, objects or simulators.
    """
    out.mkdir(parents=True, exist_ok=True)
    path = out / LOG
    if not path.exists() or not path.read_bytes().strip():
        path.write_bytes(msgspec.json.encode(plan) + b"\n")
        return []
    head, *rest = path.read_bytes().splitlines()
    other = _differences(head, plan)
    if other:
        raise GraspError(
            f"{path}: belongs to another comparison (other {', '.join(other)}): its verdicts tell nothing of this one;"
            " give another --out, or remove that file to judge everything anew"
        )
    lines = []
    for line in rest:
        try:
            lines.append(msgspec.json.decode(line, type=Line))
        except msgspec.DecodeError:  # the last line of a run that was killed
            continue
    path.write_bytes(b"\n".join([head, *(msgspec.json.encode(line) for line in lines)]) + b"\n")
    return lines


def _differences(head: bytes, plan: Plan) -> list[str]:
    """Names of the fields in which the first line of a log differs from a plan."""
    try:
        known = msgspec.json.decode(head, type=dict)
    except msgspec.DecodeError:
        known = {}
    mine = msgspec.json.decode(msgspec.json.encode(plan))
    return [name for name, value in mine.items() if known.get(name) != value]
