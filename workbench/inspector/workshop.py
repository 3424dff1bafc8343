"""What runs in the worker process: making scenes, planning on them, trying grasps.

Every function here is a short chain of calls that any script could make: the workbench adds no rule of its own. The
packages that are slow to import are imported inside, so that the page's process never loads them.
"""

from __future__ import annotations

import time
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from grasp_core.grasp import Grasp
from grasp_core.gripper import load_gripper
from grasp_core.objects.asset import ObjectAsset
from grasp_core.scene import Scene, place
from grasp_core.simulation.physics import load_physics
from workbench.inspector.orders import OpenedScene, SceneRequest, Try

if TYPE_CHECKING:
    from grasp_core.planning.planner import Planner
    from grasp_core.simulation.settling import StablePose
    from grasp_core.simulation.trial import Attempt, GraspTrial

DROPS = 16
"""Random drops that find an object's stable poses: about a second, where a dataset takes its time."""
SPREAD = 0.04
"""Metres from the table's centre within which objects are placed, along x and y."""
TRIAL_SEED = 0
"""Of the noise of trials: a candidate's attempts are the same whenever they are made."""


def prepare() -> None:
    """Import what is slow to import, so that the first scene does not wait for it alone."""
    import grasp_core.sensing.renderer
    import grasp_core.simulation.trial  # noqa: F401


@lru_cache(maxsize=32)
def _asset(family: str, shape: int) -> ObjectAsset:
    from grasp_core.objects.parametric import make

    return make(family, shape)


@lru_cache(maxsize=32)
def _rests(family: str, shape: int) -> tuple[StablePose, ...]:
    from grasp_core.simulation.settling import stable_poses

    return tuple(stable_poses(_asset(family, shape), load_physics(), drops=DROPS))


@lru_cache(maxsize=8)
def _planner(name: str) -> Planner:
    from grasp_core.planning.planner import make_planner

    return make_planner(name, gripper=load_gripper())


def open_scene(request: SceneRequest) -> OpenedScene:
    """Make the object, let it come to rest, place it, take its depth image with the paper's noise, and plan.

    Raises:
        GraspError: no such family or planner, or the object does not come to rest.
    """
    from grasp_core.sensing.noise import add_noise, load_noise
    from grasp_core.sensing.renderer import render

    stages: dict[str, float] = {}
    start = time.perf_counter()

    def lap(stage: str) -> None:
        nonlocal start
        now = time.perf_counter()
        stages[stage] = 1000 * (now - start)
        start = now

    asset = _asset(request.family, request.shape)
    lap("object")
    rests = _rests(request.family, request.shape)
    lap("settle")
    pose = request.pose % len(rests)
    rng = np.random.default_rng(np.random.SeedSequence([request.place, pose]))
    x, y = rng.uniform(-SPREAD, SPREAD, 2)
    scene = Scene.single(asset, place(rests[pose].pose, float(x), float(y), float(rng.uniform(-np.pi, np.pi))))
    clean = render(scene)
    image = add_noise(clean, load_noise("paper"), rng)
    lap("render")
    planner = _planner(request.planner)
    lap("load planner")
    plan = planner(image, rng=rng)
    lap("plan")
    return OpenedScene(
        request=replace(request, pose=pose),
        scene=scene,
        poses=len(rests),
        probability=rests[pose].probability,
        rests=tuple((rest.pose, rest.probability) for rest in rests),
        clean=clean,
        image=image,
        plan=plan,
        stages_ms=stages,
    )


_loaded: list[tuple[str, GraspTrial]] = []


def _trial(scene: Scene) -> GraspTrial:
    """The trial of this scene; the last one is kept, a click after another does not load the scene anew."""
    from grasp_core.simulation.trial import GraspTrial

    placed = scene.objects[0]
    key = placed.asset.digest + placed.world_from_object.tobytes().hex()
    if not _loaded or _loaded[0][0] != key:
        _loaded[:] = [(key, GraspTrial(scene, load_gripper(), load_physics(), whole=True))]
    return _loaded[0][1]


def _try(number: int, attempt: Attempt) -> Try:
    comfort = attempt.comfort
    return Try(
        number=number,
        outcome=str(attempt.outcome),
        words=attempt.evidence.words,
        seed=attempt.seed,
        executed=attempt.executed,
        moved=None if comfort is None else (comfort.distance, comfort.rotation),
        dynamic=attempt.dynamic,
        redraws=attempt.redraws,
        evidence=msgspec.json.encode(attempt.evidence).decode() if attempt.dynamic else None,
        recording=attempt.recording,
    )


def record_attempt(scene: Scene, grasp: Grasp, number: int) -> Try:
    """Attempt `number` of the grasp's trial, with its recording; equal to what `run_trial` finds.

    Raises:
        GraspError: the grasp cannot be executed.
    """
    from grasp_core.simulation.trial import child_seed

    return _try(number, _trial(scene).attempt(grasp, child_seed(TRIAL_SEED, number), record=True))


def run_trial(scene: Scene, grasp: Grasp, attempts: int) -> tuple[Try, ...]:
    """All attempts of the grasp's trial, without recordings.

    Raises:
        GraspError: the grasp cannot be executed.
    """
    made = _trial(scene).trial(grasp, attempts, TRIAL_SEED).attempts
    return tuple(_try(number, attempt) for number, attempt in enumerate(made))
