"""Editing the rectangle of a grasp in its image: moved, turned or widened, it is a new grasp of its scene."""

from __future__ import annotations

import numpy as np

from grasp_core import config
from grasp_core.camera import DepthImage
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import GraspError
from grasp_core.grasp import Grasp, ImageGrasp, to_image, to_world
from grasp_core.planning.crops import DepthRule, deepen, grasp_pixels, sample, surface_map

LEAST_WIDTH = 0.005
"""Metres: the smallest opening that an edited grasp may have."""


def edited(
    image: DepthImage,
    grasp: Grasp,
    *,
    right: float = 0.0,
    down: float = 0.0,
    turn: float = 0.0,
    widen: float = 1.0,
    opening: float,
    rule: DepthRule,
) -> Grasp:
    """A grasp whose rectangle was moved, turned or widened in its image.

    p keeps its height where the camera is tilted; where it looks straight down the height follows the depth rule at the
    new place.

    Args:
        image: of the scene.
        grasp: as it was.
        right: by how many pixels the rectangle moves along u.
        down: likewise along v.
        turn: counter-clockwise as displayed, rad.
        widen: factor of the width.
        opening: of the gripper, the largest width, metres.
        rule: how deep grasps reach.

    Raises:
        GraspError: the rectangle's centre leaves the image.
    """
    camera, k = image.camera, image.camera.intrinsics
    before = to_image(grasp, camera)
    u, v = before.u + right, before.v + down
    if not (0 <= u <= k.width - 1 and 0 <= v <= k.height - 1):
        raise GraspError("the rectangle's centre would leave the image; move it less")
    ends = camera.deproject([[u, v], [u, v]], [1.0, 2.0])  # two points of the pixel's ray
    along = ends[1] - ends[0]
    place = ends[0] + along * (grasp.position[2] - ends[0, 2]) / along[2]
    depth = float(camera.project(place)[2])
    moved = to_world(ImageGrasp(u, v, before.angle + turn, before.width, depth), camera)
    z = moved.position[2]
    if np.allclose(camera.pose[:3, 2], [0, 0, -1], atol=1e-6):
        above = grasp_pixels(image.depth, camera, place[None], [moved.angle])
        z = float(camera.pose[2, 3] - deepen(sample(surface_map(image.depth), above[0], above[1]), camera, rule)[0])
    width = min(max(grasp.width * widen, LEAST_WIDTH), opening)
    return Grasp((moved.position[0], moved.position[1], z), moved.angle, width)


def depth_rule(store: DatasetStore) -> DepthRule:
    """The depth rule of a dataset's recipe; the default one where it has none."""
    rule = store.meta.recipe.get("depth_rule")
    return DepthRule() if rule is None else config.convert(rule, DepthRule, f"{store.file}, depth_rule")


def add_edited(store: DatasetStore, grasp_id: int, grasp: Grasp, person: str) -> int:
    """Store an edited grasp beside the one that it was made from; its id.

    Raises:
        GraspError: nothing was changed.
        StoreError: no such grasp, or it cannot be written.
    """
    row = store.grasp(grasp_id)
    if grasp == row.grasp:
        raise GraspError("the rectangle is as it was; move, turn or widen it first")
    return store.add_grasp(row.scene, grasp, person=person, parent=grasp_id)
