"""One scene of the success benchmark: rendered with Eq. 5 noise, planned on, and all that is returned executed."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import DepthImage
from grasp_core.errors import GraspError
from grasp_core.evaluation.benchmark import ORACLE, Benchmark
from grasp_core.evaluation.gallery import draw_failure
from grasp_core.evaluation.oracle import Oracle, Verified
from grasp_core.evaluation.records import CandidateRecord, PlanRecord, SceneRecord
from grasp_core.evaluation.scenes import SceneSpec, make_scene, over_the_table, shape_off
from grasp_core.evaluation.seeds import child_seed, generator
from grasp_core.evaluation.variety import count_distinct
from grasp_core.grasp import Grasp
from grasp_core.gripper import Gripper
from grasp_core.objects.asset import ObjectAsset
from grasp_core.planning.image_planner import ImagePlanner
from grasp_core.planning.planner import Plan, make_planner
from grasp_core.scene import Scene
from grasp_core.sensing.noise import add_noise
from grasp_core.sensing.renderer import render
from grasp_core.simulation.trial import GraspTrial


@dataclass(frozen=True)
class SceneItem:
    """Everything that a process needs to judge planners on one scene.

    Attributes:
        benchmark: what is measured.
        spec: which scene.
        asset: its object.
        pose: its stable pose, 4×4.
        probability: of that pose.
        planners: those that are not in the log yet.
        pictures: folder of the pictures of failures, or None.
        verified: what the oracle knows of the pose.
    """

    benchmark: Benchmark
    spec: SceneSpec
    asset: ObjectAsset
    pose: NDArray[np.float64]
    probability: float
    planners: tuple[str, ...]
    pictures: Path | None
    verified: Verified | None = None


@lru_cache(maxsize=16)
def ready_planner(name: str, gripper: Gripper, weights: str) -> ImagePlanner[Any]:
    """A planner by name, made once a process.

    Raises:
        GraspError: an unknown name (the message lists the valid ones), or weights for another gripper.
    """
    return make_planner(name, gripper=gripper, weights=weights)


@dataclass(frozen=True)
class Judged:
    """The records of one scene, one a planner."""

    scene: SceneRecord
    plans: tuple[PlanRecord, ...]


def judge_scene(item: SceneItem) -> Judged | str:
    """Plan with every planner on one scene and execute all candidates; or say why the scene cannot be made."""
    b, name = item.benchmark, item.spec.name
    assert item.verified is not None
    try:
        scene = make_scene(item.asset, item.pose, over_the_table(b.camera), item.spec, b.seed)
    except GraspError as error:
        return str(error)
    clean = render(scene)
    image = add_noise(clean, b.image_noise, generator(b.seed, "image", name))
    trials = GraspTrial(scene, b.gripper, b.physics, b.grasp_noise)
    records = []
    for planner in item.planners:
        answer = _ask(planner, scene, image, item)
        candidates = tuple(
            _execute(trials, grasp, score, b.attempts, child_seed(b.seed, "execute", name, rank))
            for rank, (grasp, score) in enumerate(answer.grasps)
        )
        record = PlanRecord(
            name, planner, round(answer.ms, 3), answer.reason, candidates, answer.plan.weights if answer.plan else ""
        )
        records.append(record)
        if item.pictures is not None and _failed(record, item.verified.graspable):
            draw_failure(
                item.pictures / Path(planner).stem / f"{name.replace('/', '_')}.png", image, answer.plan, record
            )
    rows = [[float(value) for value in row] for row in scene.objects[0].world_from_object]
    quality = item.verified.grasps[0].score if item.verified.grasps else 0.0
    record_of_scene = SceneRecord(
        spec=item.spec,
        category=item.asset.category,
        probability=item.probability,
        world_from_object=rows,
        graspable=item.verified.graspable,
        quality=quality,
        shape_off=round(shape_off(scene, clean.depth), 4),
        distinct=count_distinct([known.grasp for known in item.verified.grasps]),
    )
    return Judged(record_of_scene, tuple(records))


@dataclass(frozen=True)
class _Answer:
    grasps: list[tuple[Grasp, float]]
    reason: str | None
    ms: float
    plan: Plan | None = None


def _ask(planner: str, scene: Scene, image: DepthImage, item: SceneItem) -> _Answer:
    """One planner's grasps for a scene, and how long they took."""
    b = item.benchmark
    assert item.verified is not None
    rng = generator(b.seed, "plan", item.spec.name)
    if planner == ORACLE:
        start = time.perf_counter()
        found = [(known.grasp, known.score) for known in Oracle(item.verified)(scene, rng=rng)]
        ms = 1000 * (time.perf_counter() - start)
        return _Answer(found, None if found else "the oracle knows no grasp", ms)
    call = ready_planner(planner, b.gripper, b.weights)
    if planner not in _WARM:
        call(image, rng=generator(b.seed, "warm"))
        _WARM.add(planner)
    start = time.perf_counter()
    plan = call(image, rng=rng)
    ms = 1000 * (time.perf_counter() - start)
    return _Answer([(found.grasp, found.score) for found in plan.candidates], plan.reason, ms, plan)


_WARM: set[str] = set()
"""Planners that have planned once in this process: the first plan loads and compiles, and is not timed."""


def _failed(record: PlanRecord, graspable: bool) -> bool:
    """Whether any execution of the best candidate failed, or the plan is empty where there is something to grasp."""
    if not record.candidates:
        return graspable
    return record.candidates[0].successes < len(record.candidates[0].outcomes)


def _execute(trials: GraspTrial, grasp: Grasp, score: float, attempts: int, seed: int) -> CandidateRecord:
    done = [trials.attempt(grasp, child_seed(seed, number)) for number in range(attempts)]
    return CandidateRecord(
        grasp=grasp,
        score=float(score),
        outcomes=tuple(attempt.outcome.value for attempt in done),
        seeds=tuple(attempt.seed for attempt in done),
        redraws=tuple(attempt.redraws for attempt in done),
        shift=tuple(None if attempt.comfort is None else attempt.comfort.distance for attempt in done),
    )
