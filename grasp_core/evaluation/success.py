"""The success benchmark: plans on scenes that nobody has seen, each candidate executed in DART with fresh seeds.

Three maps over processes: objects are made and dropped, the oracle searches each stable pose, then every scene is
rendered with the noise of Eq. 5, planned on by every planner, and all that is returned is executed with that of Eq. 4.
Raw outcomes go to the log (`records.py`), figures are computed from it (`summary.py`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from grasp_core import config
from grasp_core.errors import GraspError
from grasp_core.evaluation.benchmark import ORACLE, Benchmark
from grasp_core.evaluation.judge import SceneItem, judge_scene, ready_planner
from grasp_core.evaluation.oracle import OracleSettings, Verified, verified_grasps
from grasp_core.evaluation.records import Log
from grasp_core.evaluation.scenes import SceneSpec, choose_poses
from grasp_core.evaluation.suites import PlannedObject, object_plans, poses_of
from grasp_core.objects.asset import ObjectAsset
from grasp_core.parallel import Executor, map_scenes
from grasp_core.simulation.physics import Physics

Tell = Callable[[str, int, int], None]
"""Progress: stage, done, total."""


def run_benchmark(
    benchmark: Benchmark,
    out: Path | None = None,
    executor: Executor | None = None,
    tell: Tell = lambda *_: None,
) -> tuple[Log, dict[str, str]]:
    """Run a benchmark, or what is missing of it.

    Args:
        benchmark: what to measure.
        out: folder of the log and of the pictures of failures, gone on with where it exists; None keeps neither.
        executor: where the work runs.
        tell: progress.

    Returns:
        The log, and object or scene → why it could not be used.

    Raises:
        GraspError: no objects, an unknown planner, or a folder that cannot be used.
    """
    run = benchmark.run({name: _identity(benchmark, name) for name in benchmark.planners})
    plans = object_plans(benchmark.objects, benchmark.scale, benchmark.seed)
    log = Log(run, None if out is None else out / "outcomes.jsonl")
    made: list[_Made] = []
    refused: dict[str, str] = {}
    while plans and (benchmark.limit is None or len(made) < benchmark.limit):
        # Every usable object yields a scene, so that the limit bounds how many must be made.
        count = len(plans) if benchmark.limit is None else benchmark.limit - len(made)
        more, unusable = _make_objects(benchmark, plans[:count], executor, tell)
        made, refused, plans = made + more, refused | unusable, plans[count:]
    items = _scene_items(benchmark, made, log, out)
    if items:
        log.check_more()
    items = _with_oracle(benchmark, items, executor, tell)
    tell("scenes", 0, len(items))
    for done, (index, judged) in enumerate(map_scenes(judge_scene, items, executor), start=1):
        if isinstance(judged, str):
            refused[items[index].spec.name] = judged
        else:
            if log.scenes.get(judged.scene.spec.name) != judged.scene:
                log.add(judged.scene)
            for plan in judged.plans:
                log.add(plan)
        tell("scenes", done, len(items))
    return log, refused


def _identity(benchmark: Benchmark, planner: str) -> str:
    """What a planner's grasps follow from; the planner is ready then."""
    if planner == ORACLE:
        return f"Oracle {config.digest(OracleSettings())}"
    return ready_planner(planner, benchmark.gripper, benchmark.weights).identity


@dataclass(frozen=True)
class _ObjectItem:
    plan: PlannedObject
    physics: Physics


@dataclass(frozen=True)
class _Made:
    asset: ObjectAsset
    poses: tuple[tuple[NDArray[np.float64], float], ...]


def _make_object(item: _ObjectItem) -> _Made | str:
    try:
        asset = item.plan.make()
        return _Made(asset, tuple((pose.pose, pose.probability) for pose in poses_of(asset, item.physics)))
    except GraspError as error:
        return str(error)


def _make_objects(
    benchmark: Benchmark, plans: Sequence[PlannedObject], executor: Executor | None, tell: Tell
) -> tuple[list[_Made], dict[str, str]]:
    tell("objects", 0, len(plans))
    made: dict[int, _Made] = {}
    refused: dict[str, str] = {}
    items = [_ObjectItem(plan, benchmark.physics) for plan in plans]
    for index, result in map_scenes(_make_object, items, executor):
        if isinstance(result, str):
            refused[plans[index].name] = result
        else:
            made[index] = result
        tell("objects", len(made) + len(refused), len(plans))
    return [made[index] for index in sorted(made)], refused


def _scene_items(benchmark: Benchmark, made: Sequence[_Made], log: Log, out: Path | None) -> list[SceneItem]:
    """The scenes that are not in the log for every planner: first poses first."""
    ordered: list[tuple[tuple[int, int, int], SceneItem]] = []
    for number, item in enumerate(made):
        chosen = choose_poses([p for _, p in item.poses], benchmark.poses, benchmark.seed, item.asset.name)
        for rank, index in enumerate(chosen):
            for draw in range(benchmark.draws):
                spec = SceneSpec(item.asset.name, item.asset.digest, index, draw)
                pose, probability = item.poses[index]
                missing = tuple(name for name in benchmark.planners if (spec.name, name) not in log.plans)
                pictures = None if out is None else out / "failures"
                scene = SceneItem(benchmark, spec, item.asset, pose, probability, missing, pictures)
                ordered.append(((rank, draw, number), scene))
    ordered.sort(key=lambda pair: pair[0])
    return [scene for _, scene in ordered[: benchmark.limit] if scene.planners]


@dataclass(frozen=True)
class _OracleItem:
    asset: ObjectAsset
    pose: NDArray[np.float64]
    benchmark: Benchmark


def _search(item: _OracleItem) -> Verified:
    b = item.benchmark
    return verified_grasps(item.asset, item.pose, b.gripper, b.physics, b.grasp_noise)


def _with_oracle(
    benchmark: Benchmark, items: Sequence[SceneItem], executor: Executor | None, tell: Tell
) -> list[SceneItem]:
    keys = list({(item.spec.object, item.spec.digest, item.spec.pose): item for item in items}.items())
    tell("oracle", 0, len(keys))
    searches = [_OracleItem(item.asset, item.pose, benchmark) for _, item in keys]
    known = {}
    for done, (index, verified) in enumerate(map_scenes(_search, searches, executor), start=1):
        known[keys[index][0]] = verified
        tell("oracle", done, len(keys))
    return [replace(item, verified=known[item.spec.object, item.spec.digest, item.spec.pose]) for item in items]
