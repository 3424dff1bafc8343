"""A recording as one picture: a row of frames, drawn without OpenGL, for reports and for looking at disagreements."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

import cv2
import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from grasp_core.gripper import Gripper
from grasp_core.lettering import plain
from grasp_core.objects.asset import ObjectAsset
from grasp_core.simulation.recording import PHASES, Recording

_OBJECTS = ((200, 130, 60), (90, 170, 90), (170, 90, 170), (80, 140, 220))
_GRIPPER = {"base": (90, 90, 90), "rod": (70, 190, 210), "left_finger": (70, 70, 220), "right_finger": (160, 60, 160)}
_TABLE = (222, 222, 222)
_LIGHT = np.array([0.4, 0.5, 0.77])


def filmstrip(
    assets: Sequence[ObjectAsset],
    gripper: Gripper,
    recording: Recording,
    *,
    frames: int = 7,
    size: int = 220,
    span: float = 0.26,
    title: str = "",
) -> NDArray[np.uint8]:
    """Frames of an attempt side by side, seen across the closing axis; the view rises with the gripper.

    Args:
        assets: of the recorded objects, drawn by their convex parts.
        gripper: that was recorded.
        recording: the attempt.
        frames: how many.
        size: of a frame, pixels.
        span: side of what a frame shows, metres.
        title: above the frames; the recording's own words by default.

    Returns:
        (size + 26, frames · size, 3) uint8, blue first as OpenCV has it.
    """
    shapes: list[tuple[trimesh.Trimesh, tuple[int, int, int]]] = []
    boxes = gripper.boxes()
    for name in recording.names:
        if name.startswith("object_"):
            index = int(name.removeprefix("object_"))
            mesh = cast(trimesh.Trimesh, trimesh.util.concatenate([part.mesh for part in assets[index].parts]))
            shapes.append((mesh, _OBJECTS[index % len(_OBJECTS)]))
        else:
            shapes.append((trimesh.creation.box(boxes[name][0].size), _GRIPPER[name]))
    chosen = _moments(recording, frames)
    rod = recording.names.index("rod")
    yaw = Rotation.from_quat(recording.poses[0, rod, [4, 5, 6, 3]]).as_euler("ZYX")[0]
    strip = np.full((size + 26, len(chosen) * size, 3), 255, np.uint8)
    for column, moment in enumerate(chosen):
        poses = recording.poses[moment].astype(float)
        x, y, z = poses[rod, :3]
        frame = _frame(shapes, poses, np.array([x, y, z - 0.3 * span]), yaw, size, span)
        text = f"{PHASES[recording.phases[moment]]} {recording.times[moment]:.2f} s"
        cv2.putText(frame, text, (5, 14), cv2.FONT_HERSHEY_SIMPLEX, 0.4, (0, 0, 0), 1, cv2.LINE_AA)
        strip[26:, column * size : (column + 1) * size] = frame
    words = title or f"{recording.outcome}: {recording.words}"
    cv2.putText(strip, plain(words), (5, 17), cv2.FONT_HERSHEY_SIMPLEX, 0.42, (0, 0, 0), 1, cv2.LINE_AA)
    return strip


def _moments(recording: Recording, count: int) -> list[int]:
    """Frames to show: the end of the approach, the closing, and the lift in equal steps."""
    ends = [np.flatnonzero(recording.phases == phase) for phase in range(len(PHASES))]
    approach, close = ends[0], ends[1]
    later = np.flatnonzero(recording.phases >= 2)
    picked = [int(approach[-1])] if len(approach) else []
    if len(close):
        picked += [int(close[len(close) // 3]), int(close[-1])]
    if len(later) and count > len(picked):
        picked += [int(later[k]) for k in np.linspace(0, len(later) - 1, count - len(picked)).round().astype(int)]
    return picked[:count]


def _frame(
    shapes: Sequence[tuple[trimesh.Trimesh, tuple[int, int, int]]],
    poses: NDArray[np.float64],
    centre: NDArray[np.float64],
    yaw: float,
    size: int,
    span: float,
) -> NDArray[np.uint8]:
    """One frame: triangles painted from far to near, orthographic, a little from above."""
    turn = yaw - np.pi / 2 + 0.45
    away = np.array([np.cos(turn) * 0.95, np.sin(turn) * 0.95, 0.31])
    right = np.array([-np.sin(turn), np.cos(turn), 0.0])
    up = np.cross(away, right)
    axes = np.stack([right, -up, away], axis=1)
    scale = size / span

    def pixels(points: NDArray[np.float64]) -> NDArray[np.float64]:
        seen = (points - centre) @ axes
        seen[..., :2] = seen[..., :2] * scale + size / 2
        return seen

    image = np.full((size, size, 3), 255, np.uint8)
    corners = np.array([[x, y, 0.0] for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    cv2.fillConvexPoly(image, pixels(corners * [0.5, 0.5, 0])[:, :2].round().astype(np.int32), _TABLE)
    triangles, colours = [], []
    for (mesh, colour), pose in zip(shapes, poses, strict=True):
        rotation = Rotation.from_quat(pose[[4, 5, 6, 3]]).as_matrix()
        corners = mesh.triangles @ rotation.T + pose[:3]
        normals = mesh.face_normals @ rotation.T
        facing = normals @ away > 0
        triangles.append(pixels(corners[facing]))
        shade = 0.55 + 0.45 * np.abs(normals[facing] @ _LIGHT)
        colours.append(np.array(colour) * shade[:, None])
    every, paint = np.concatenate(triangles), np.concatenate(colours)
    for index in np.argsort(every[:, :, 2].mean(axis=1)):
        points = (every[index, :, :2] * 16).round().astype(np.int32)
        cv2.fillConvexPoly(image, points, paint[index].tolist(), cv2.LINE_AA, 4)
    return image
