"""Seeing and planning: the depth image of a scene, what planners make of it, and what the network says of one place."""

from __future__ import annotations

import os
import time
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import Camera, DepthImage
from grasp_core.errors import GraspError
from grasp_core.gripper import Gripper
from grasp_core.planning.places import PlaceScores, candidate_crops, score_place
from grasp_core.planning.planner import Plan, Planner, make_planner, needs_networks
from grasp_core.scene import Scene
from grasp_core.sensing.noise import ImageNoise, add_noise
from workbench.inspector.orders import OpenedScene, SceneRequest, Sight
from workbench.inspector.setup import Setup
from workbench.inspector.worker.photos import read_photo
from workbench.inspector.worker.scenes import Files, gripper_of, make_scene

if TYPE_CHECKING:
    from grasp_core.networks.runtime import Runtime
    from grasp_core.sensing.renderer import Renderer


@lru_cache(maxsize=2)
def _runtime(weights: str) -> Runtime:
    from grasp_core.networks.runtime import load_runtime

    # The browser draws meanwhile, and a plan on all cores costs the processor a sixth more.
    return load_runtime(weights, threads=max(1, (os.cpu_count() or 2) // 2), precision="auto")


@lru_cache(maxsize=32)
def _planner(name: str, settings: tuple[tuple[str, float], ...], gripper: str, weights: str) -> Planner:
    runtime = _runtime(weights) if needs_networks(name) else None
    changes = dict(settings)
    if runtime is None:
        del changes["threshold"]  # t is a probability, which their scores are not
    return make_planner(name, gripper=gripper_of(gripper), weights=weights, runtime=runtime, changes=changes)


class _Clock:
    def __init__(self) -> None:
        self.ms: dict[str, float] = {}
        self._start = time.perf_counter()

    def lap(self, stage: str) -> None:
        now = time.perf_counter()
        self.ms[stage] = 1000 * (now - self._start)
        self._start = now


def open_scene(request: SceneRequest, setup: Setup, files: Files) -> OpenedScene:
    """Make a scene (or read an own image), take its depth image with noise, and plan.

    Raises:
        GraspError: an object, file or camera is not there or of no use, or objects do not come to rest.
    """
    clock = _Clock()
    gripper = gripper_of(setup.gripper)
    if request.photo is not None:
        image = read_photo(request.photo, files)
        clock.lap("read")
        sight = _plan(image, setup, gripper, clock)
        return OpenedScene(request, setup, Scene((), image.camera), (), gripper, sight)
    request, scene, rests = make_scene(request, setup, files)
    clock.lap("scene")
    return OpenedScene(request, setup, scene, rests, gripper, _see(scene, setup, gripper, clock))


def see(request: SceneRequest, setup: Setup, files: Files) -> Sight:
    """The same without the scene itself: for one that is known but was moved or is planned on anew.

    Raises:
        GraspError: as `open_scene`.
    """
    clock = _Clock()
    gripper = gripper_of(setup.gripper)
    if request.photo is not None:
        image = read_photo(request.photo, files)
        clock.lap("read")
        return _plan(image, setup, gripper, clock)
    _, scene, _ = make_scene(request, setup, files)
    clock.lap("scene")
    return _see(scene, setup, gripper, clock)


_rendered: list[tuple[tuple[int, ...], Renderer]] = []


def _renderer(scene: Scene) -> Renderer:
    """The renderer of these objects; the last one is kept, wherever they were moved."""
    from grasp_core.sensing.renderer import Renderer

    key = tuple(id(placed.asset) for placed in scene.objects)
    if not _rendered or _rendered[0][0] != key:
        _rendered[:] = [(key, Renderer(scene))]
    return _rendered[0][1]


def _see(scene: Scene, setup: Setup, gripper: Gripper, clock: _Clock) -> Sight:
    poses = [placed.world_from_object for placed in scene.objects]
    clean = _renderer(scene).render(scene.camera, poses)
    noise = ImageNoise(sigma_u=setup.sigma_u, sigma_v=setup.sigma_v, sigma_d=setup.sigma_d)
    image = add_noise(clean, noise, np.random.default_rng(np.random.SeedSequence([setup.seed, 0])))
    clock.lap("render")
    return _plan(image, setup, gripper, clock)


def _plan(image: DepthImage, setup: Setup, gripper: Gripper, clock: _Clock) -> Sight:
    plans: list[Plan | None] = []
    failures: list[str] = []
    crops: list[NDArray[np.float32] | None] = []
    for name in setup.planners:
        try:
            planner = _planner(name, tuple(setup.plans.items()), setup.gripper, setup.weights)
            clock.lap("load planner")
            plan = planner(image, rng=np.random.default_rng(np.random.SeedSequence([setup.seed, 1])))
            plans.append(replace(plan, scored=plan.candidates))  # the others are not shown and many
            failures.append("")
            crops.append(_crops(plan, setup, gripper))
        except GraspError as error:
            plans.append(None)
            failures.append(str(error))
            crops.append(None)
    context = _runtime(setup.weights).meta.crop.context
    return Sight(image, tuple(plans), tuple(failures), tuple(crops), context, clock.ms)


def _crops(plan: Plan, setup: Setup, gripper: Gripper) -> NDArray[np.float32] | None:
    runtime = _runtime(setup.weights)
    try:
        runtime.meta.check(gripper)
    except GraspError:
        return None
    return candidate_crops(plan.canvas, plan.candidates, runtime.meta.crop, gripper)


def ask_place(image: DepthImage, canvas: Camera, setup: Setup, u: float, v: float) -> PlaceScores:
    """Score a pixel of a plan's canvas, of which the camera is given, over all angles.

    Raises:
        GraspError: the weights are for another gripper, or the pixel lies outside.
    """
    gripper = gripper_of(setup.gripper)
    runtime = _runtime(setup.weights)
    runtime.meta.check(gripper)
    return score_place(image, canvas, u, v, runtime, gripper, threshold=setup.threshold)
