"""Why here, and why not there: one place under all angles, and what the Refined Network sees of given grasps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import CANONICAL_HEIGHT, Camera, DepthImage
from grasp_core.errors import ImageError
from grasp_core.gripper import Gripper
from grasp_core.networks.runtime import Runtime
from grasp_core.networks.weights import CropSpec
from grasp_core.planning.candidates import PoseNoise, cleared, make_batch, reachable, to_candidates
from grasp_core.planning.crops import crops, grasp_pixels
from grasp_core.planning.image_planner import NetworkSettings
from grasp_core.planning.planner import Candidate
from grasp_core.planning.view import TableView, ViewSettings
from grasp_core.sensing.rectify import rectify


@dataclass(frozen=True, eq=False)
class PlaceScores:
    """What the Refined Network says of one place under all angles.

    Attributes:
        u: column on the canonical canvas, pixels.
        v: row.
        height: of the surface there above the table, metres.
        seen: whether the camera measured it; else it was filled in.
        candidates: one an angle, evenly spread over half a turn from −π/2 on; `score` also of those that the gripper
            cannot reach.
        reachable: boolean (A,): whether fingers and rod come down without meeting what is seen.
    """

    u: float
    v: float
    height: float
    seen: bool
    candidates: tuple[Candidate, ...]
    reachable: NDArray[np.bool_]

    @property
    def best(self) -> int | None:
        """The angle with the highest score among the reachable ones; None when none is reachable."""
        if not self.reachable.any():
            return None
        scores = [candidate.score for candidate in self.candidates]
        return int(np.argmax(np.where(self.reachable, scores, -1.0)))


def score_place(
    image: DepthImage,
    canvas: Camera,
    u: float,
    v: float,
    runtime: Runtime,
    gripper: Gripper,
    settings: ViewSettings | None = None,
    *,
    noise: PoseNoise | None = None,
    threshold: float | None = None,
    angles: int = 36,
) -> PlaceScores:
    """Score one pixel of the canonical canvas under all angles.

    Args:
        image: of any camera; without a pose the table plane is found first.
        canvas: the camera of the canvas of a plan of this image (`Plan.canvas`).
        u: column on it, pixels.
        v: row.
        runtime: the networks.
        gripper: whose grasps they are.
        settings: how deep grasps reach.
        noise: how far the robot strays from the pose that it is told; as planners take it by default when None.
        threshold: t of the planner, below which it leaves scores as the network gave them; the default one when None.
        angles: evenly spread over half a turn.

    Raises:
        ImageError: no table plane, or a pixel outside of the canvas.
    """
    rectified = rectify(image).above(canvas.pose[:2, 3])
    depth = rectified.image.depth
    height, width = depth.shape
    column, row = round(u), round(v)
    if not (0 <= column < width and 0 <= row < height):
        raise ImageError(f"the pixel ({u:g}, {v:g}) lies outside of the canvas of {width} × {height} pixels")
    everywhere = np.ones(depth.shape, np.bool_)
    view = TableView(
        rectified, settings or ViewSettings(), slice(0, height), slice(0, width), everywhere, rectified.image.camera
    )
    turns = np.arange(angles) * np.pi / angles - np.pi / 2
    batch = make_batch(view, np.full(angles, float(column)), np.full(angles, float(row)), turns)
    free = reachable(batch, view, gripper)
    seen = crops(
        view.depth, view.camera, batch.u, batch.v, batch.angle, batch.depth, runtime.meta.crop, gripper.opening
    )
    scores = runtime.scores(seen)
    told = NetworkSettings()
    threshold = told.threshold if threshold is None else threshold
    scores[free] = cleared(scores[free], batch[free], view, gripper, noise or told.pose_noise, threshold)
    return PlaceScores(
        float(column),
        float(row),
        CANONICAL_HEIGHT - float(depth[row, column]),
        bool(rectified.seen[row, column]),
        to_candidates(batch, scores, np.zeros(angles), view, gripper),
        free,
    )


def candidate_crops(
    canvas: DepthImage, candidates: Sequence[Candidate], spec: CropSpec, gripper: Gripper
) -> NDArray[np.float32]:
    """The crops (N, S, S) that the Refined Network sees of grasps on a plan's canvas; see `crops.crops`."""
    if not candidates:
        return np.zeros((0, spec.size, spec.size), np.float32)
    positions = np.array([candidate.grasp.position for candidate in candidates])
    angles = np.array([candidate.grasp.angle for candidate in candidates])
    u, v, turned, depth = grasp_pixels(canvas.depth, canvas.camera, positions, angles)
    return crops(canvas.depth, canvas.camera, u, v, turned, depth, spec, gripper.opening)
