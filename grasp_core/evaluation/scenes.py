"""Scenes to judge planners on: an object in a stable pose at a random place and yaw, wholly in the camera's view."""

from __future__ import annotations

import math
from dataclasses import replace

import msgspec
import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import Camera, look_down
from grasp_core.errors import GraspError
from grasp_core.evaluation.seeds import generator
from grasp_core.objects.asset import ObjectAsset
from grasp_core.scene import Scene, place
from grasp_core.sensing.renderer import render

MARGIN = 12
"""Pixels that stay free between an object and the border of the image."""

_TRIES = 400


class SceneSpec(msgspec.Struct, frozen=True):
    """Which scene: it follows from the object, its stable pose and these words alone.

    Attributes:
        object: the asset's name.
        digest: of the asset: the same name may stand for another mesh elsewhere.
        pose: index of the stable pose, likeliest first.
        draw: which of the random places of this pose.
    """

    object: str
    digest: str
    pose: int
    draw: int

    @property
    def name(self) -> str:
        """Unique in a run, for example `mug_003-1f0c-p1-d0`."""
        return f"{self.object}-{self.digest[:4]}-p{self.pose}-d{self.draw}"


def choose_poses(probabilities: list[float], count: int, seed: int, name: str) -> list[int]:
    """Which stable poses of an object are used: `count` different ones (or all), drawn by their probability.

    Args:
        probabilities: of the stable poses, above 0.
        count: at most so many.
        seed: of the run.
        name: of the object.
    """
    weights = np.asarray(probabilities, float)
    rng = generator(seed, "poses", name)
    order = rng.choice(len(weights), size=len(weights), replace=False, p=weights / weights.sum())
    return [int(index) for index in order[:count]]  # more poses later keep the first ones


def over_the_table(camera: Camera, height: float = 0.70) -> Camera:
    """The camera with a pose: its own, or straight down from 0.70 m above the table if it has none."""
    return camera if camera.world_from_camera is not None else camera.at(look_down(height))


def make_scene(asset: ObjectAsset, pose: NDArray[np.float64], camera: Camera, spec: SceneSpec, seed: int) -> Scene:
    """Place an object at random, uniformly over the places and yaws at which the camera sees all of it.

    Args:
        asset: the object.
        pose: 4×4, a stable pose resting on z = 0.
        camera: with a pose.
        spec: which scene.
        seed: of the run.

    Raises:
        GraspError: the object does not fit into the camera's view.
    """
    rng = generator(seed, "place", spec.name)
    low, high = _footprint(camera)
    for _ in range(_TRIES):
        x, y = rng.uniform(low, high)
        placed = place(pose, float(x), float(y), float(rng.uniform(-math.pi, math.pi)))
        scene = Scene.single(asset, placed, camera)
        if camera.sees(scene.objects[0].vertices, MARGIN):
            return scene
    raise GraspError(
        f"{asset.name}: nowhere on the table does the camera see all of it; give a wider or higher camera, or leave"
        " the object out"
    )


def shape_off(scene: Scene, exact: NDArray[np.float32]) -> float:
    """Share of the object's pixels at which its convex parts stand more than 5 mm off its mesh.

    Args:
        scene: of one object.
        exact: (H, W) its clean depth, metres.
    """
    placed = scene.objects[0]
    parts = placed.asset.parts
    starts = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])])
    faces = np.concatenate([part.faces + start for part, start in zip(parts, starts, strict=True)]).astype(np.int32)
    solid = replace(placed.asset, vertices=np.concatenate([part.vertices for part in parts]), faces=faces)
    depth = render(Scene((replace(placed, asset=solid),), scene.camera)).depth
    bare = render(Scene((), scene.camera)).depth
    either = (np.abs(exact - bare) > 1e-4) | (np.abs(depth - bare) > 1e-4)
    return float((np.abs(exact - depth)[either] > 0.005).mean()) if either.any() else 0.0


def _footprint(camera: Camera) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Least and greatest (x, y) of the table that the image shows."""
    k = camera.intrinsics
    corners = np.array([[0, 0], [k.width - 1, 0], [0, k.height - 1], [k.width - 1, k.height - 1]], float)
    ends = camera.deproject(corners, np.ones(4))
    start = camera.pose[:3, 3]
    slopes = ends - start
    if not np.isfinite(slopes).all() or (slopes[:, 2] > -0.05).any():
        raise GraspError("this camera sees the horizon, not only the table; tilt it further down")
    table = start + slopes * (start[2] / -slopes[:, 2])[:, None]
    return table[:, :2].min(axis=0), table[:, :2].max(axis=0)
