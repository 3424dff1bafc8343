"""Shapes of the 3D scene as arrays: meshes, small grippers, forces, frames of a replay."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import trimesh
from numpy.typing import NDArray

from grasp_core.grasp import Grasp
from grasp_core.gripper import Gripper
from grasp_core.simulation.recording import Recording

_MOST_SMOOTHED = 50_000
_METRES_PER_NEWTON = 0.004
FAR_AWAY = np.array([[0.0, 0.0, -10.0]], np.float32)
"""Where instances go that are not to be seen."""


def fork(gripper: Gripper) -> trimesh.Trimesh:
    """A small stand-in for a gripper, in the gripper frame at full opening: two prongs, a bar and a stem, metres."""
    half, up, thin = gripper.opening / 2, gripper.finger.z, 0.0022
    pieces = [
        ((-half, 0, up / 2), (thin, thin, up)),
        ((half, 0, up / 2), (thin, thin, up)),
        ((0, 0, up), (2 * half + thin, thin, thin)),
        ((0, 0, up * 1.3), (thin, thin, up * 0.6)),
    ]
    boxes = []
    for centre, size in pieces:
        box = trimesh.creation.box(size)
        box.apply_translation(centre)
        boxes.append(box)
    return trimesh.Trimesh(
        np.concatenate([box.vertices for box in boxes]),
        np.concatenate([box.faces + 8 * number for number, box in enumerate(boxes)]),
        process=False,
    )


def shaded(mesh: trimesh.Trimesh) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Vertices and faces to be shown: sharp edges are cut apart, so that light does not run round them."""
    if len(mesh.faces) > _MOST_SMOOTHED:
        return np.asarray(mesh.vertices, np.float32), np.asarray(mesh.faces, np.uint32)
    merged = trimesh.Trimesh(mesh.vertices, mesh.faces)  # joins equal corners, without which nothing is smooth
    cut = trimesh.graph.smooth_shade(merged, angle=math.radians(35))
    return np.asarray(cut.vertices, np.float32), np.asarray(cut.faces, np.uint32)


def batch(grasps: Sequence[Grasp], hidden: Sequence[int]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Orientations (N, 4) w x y z and positions (N, 3) of the forks; the `hidden` ones are put far away."""
    if not grasps:
        return np.array([[1, 0, 0, 0]], np.float32), FAR_AWAY
    turns = np.array([[math.cos(g.angle / 2), 0, 0, math.sin(g.angle / 2)] for g in grasps], np.float32)
    places = np.array([g.position for g in grasps], np.float32)
    places[list(hidden)] = FAR_AWAY
    return turns, places


def frame_at(recording: Recording, position: float) -> tuple[int, int, float]:
    """The recorded frames before and after a time (seconds from the start), and how far between them, 0 to 1."""
    times = np.asarray(recording.times, float) - float(recording.times[0])
    after = int(np.clip(np.searchsorted(times, position), 1, max(len(times) - 1, 1)))
    if len(times) < 2:
        return 0, 0, 0.0
    before = after - 1
    span = times[after] - times[before]
    return before, after, float(np.clip((position - times[before]) / span, 0, 1)) if span > 0 else 1.0


def body_at(recording: Recording, body: int, position: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Orientation (4,) w x y z and position (3,) of a body at a time, between frames."""
    before, after, part = frame_at(recording, position)
    start, end = recording.poses[before, body], recording.poses[after, body]
    turn_end = end[3:7] if float(start[3:7] @ end[3:7]) >= 0 else -end[3:7]
    turn = np.asarray(start[3:7] * (1 - part) + turn_end * part, float)
    return turn / np.linalg.norm(turn), np.asarray(start[:3] * (1 - part) + end[:3] * part, float)


def force_lines(recording: Recording, frame: int) -> NDArray[np.float32] | None:
    """Contact forces on the object in one frame as lines (C, 2, 3), world metres; None without contact."""
    low, high = np.searchsorted(recording.contact_frames, [frame, frame + 1])
    if low == high:
        return None
    points, pushes = recording.contact_points[low:high], recording.contact_forces[low:high]
    return np.stack([points - _METRES_PER_NEWTON * pushes, points], axis=1).astype(np.float32)
