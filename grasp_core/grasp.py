"""Grasps in the world and in the image (Eq. 1 and 3 of the paper), and the angle convention of the project.

One convention everywhere: φ is the angle of the closing axis, the line on which the fingers move. A parallel-jaw grasp
is symmetric under a half turn, so φ lives in [−π/2, π/2) and is averaged through 2φ, never raw.
"""

from __future__ import annotations

import math

import msgspec
import numpy as np
from numpy.typing import ArrayLike, NDArray

from grasp_core.camera import Camera
from grasp_core.errors import GraspError


def wrap_angle(angle: float) -> float:
    """The equivalent closing-axis angle in [−π/2, π/2), rad."""
    wrapped = (angle + math.pi / 2) % math.pi - math.pi / 2
    return wrapped if wrapped < math.pi / 2 else -math.pi / 2


def angle_distance(a: float, b: float) -> float:
    """How far apart two closing axes are, rad in [0, π/2]."""
    return abs(wrap_angle(a - b))


def mean_angle(angles: ArrayLike, weights: ArrayLike | None = None) -> float:
    """The mean closing-axis angle, through 2φ, rad in [−π/2, π/2).

    Raises:
        GraspError: no angles, or angles that cancel out so that no mean exists.
    """
    doubled = np.exp(2j * np.asarray(angles, float))
    w = np.ones(doubled.shape) if weights is None else np.asarray(weights, float)
    total = complex((doubled * w).sum())
    if abs(total) <= 1e-9 * float(np.abs(w).sum() or 1.0):
        raise GraspError("these angles have no mean: they are none or cancel out; average fewer of them")
    return wrap_angle(float(np.angle(total)) / 2)


class Grasp(msgspec.Struct, frozen=True):
    """g = (p, φ, w) in the world (Eq. 1).

    Attributes:
        position: p, the midpoint of the fingers' lower ends at the moment of closing, metres (x, y, z).
        angle: φ of the closing axis about world z, rad, counter-clockwise from x seen from above; stored in
            [−π/2, π/2).
        width: w, the opening at approach, metres.
    """

    position: tuple[float, float, float]
    angle: float
    width: float

    def __post_init__(self) -> None:
        numbers = tuple(float(value) for value in (*self.position, self.angle, self.width))
        if len(numbers) != 5 or not all(map(math.isfinite, numbers)):
            raise GraspError(f"a grasp needs three finite coordinates, an angle and a width, not {numbers}")
        if numbers[4] <= 0:
            raise GraspError(f"a grasp's width is an opening in metres above 0, not {numbers[4]}")
        msgspec.structs.force_setattr(self, "position", numbers[:3])
        msgspec.structs.force_setattr(self, "angle", wrap_angle(numbers[3]))
        msgspec.structs.force_setattr(self, "width", numbers[4])

    @property
    def closing_axis(self) -> NDArray[np.float64]:
        """Unit vector (3,) of the closing axis in the world."""
        return np.array([math.cos(self.angle), math.sin(self.angle), 0.0])

    @property
    def world_from_gripper(self) -> NDArray[np.float64]:
        """4×4 pose of the gripper frame: origin p, x along the closing axis, z up."""
        transform = np.eye(4)
        c, s = math.cos(self.angle), math.sin(self.angle)
        transform[:2, :2] = [[c, -s], [s, c]]
        transform[:3, 3] = self.position
        return transform


class ImageGrasp(msgspec.Struct, frozen=True):
    """g_i = (p_i, φ_i, w_i, d_i): a grasp in the pixels of one image (Eq. 3).

    Attributes:
        u: column of the projection of p, pixels, to the right; whole numbers are pixel centres.
        v: row, pixels, down.
        angle: φ_i, rad, counter-clockwise as displayed; in [−π/2, π/2).
        width: w_i, pixels along the closing axis.
        depth: d_i, z-depth of p in the camera frame, metres.
    """

    u: float
    v: float
    angle: float
    width: float
    depth: float

    def __post_init__(self) -> None:
        numbers = [float(value) for value in (self.u, self.v, self.angle, self.width, self.depth)]
        if not all(map(math.isfinite, numbers)):
            raise GraspError(f"an image grasp needs finite u, v, angle, width and depth, not {numbers}")
        if numbers[3] <= 0 or numbers[4] <= 0:
            raise GraspError(
                f"an image grasp's width (px) and depth (m) are above 0, not {numbers[3]} and {numbers[4]}"
            )
        numbers[2] = wrap_angle(numbers[2])
        for name, value in zip(self.__struct_fields__, numbers, strict=True):
            msgspec.structs.force_setattr(self, name, value)

    def rectangle(self, jaw: float) -> NDArray[np.float64]:
        """Corners (4, 2) as (u, v): 0→1 runs along the opening, 1→2 along the jaw, `jaw` pixels long."""
        return rectangle_corners(self.u, self.v, self.angle, self.width, jaw)


def rectangle_corners(u: float, v: float, angle: float, opening: float, jaw: float) -> NDArray[np.float64]:
    """Corners (4, 2) as (u, v) of a grasp rectangle centred on (u, v).

    Args:
        u: centre column, pixels.
        v: centre row, pixels.
        angle: of the closing axis, rad, counter-clockwise as displayed.
        opening: side along the closing axis, pixels.
        jaw: side across it, pixels.
    """
    along = np.array([math.cos(angle), -math.sin(angle)]) * opening / 2
    across = np.array([math.sin(angle), math.cos(angle)]) * jaw / 2
    centre = np.array([u, v], float)
    return np.stack(
        [centre - along - across, centre + along - across, centre + along + across, centre - along + across]
    )


def to_image(grasp: Grasp, camera: Camera) -> ImageGrasp:
    """Project a grasp into the image of a camera (Eq. 3); inverse of `to_world`.

    Angle and width follow the projection of the closing axis to first order at p, lens distortion included, so that the
    round trip is exact for tilted and distorted cameras too.

    Raises:
        GraspError: the grasp lies behind the camera.
    """
    position = np.asarray(grasp.position)
    u, v, depth = camera.project(position)
    if depth <= 0:
        raise GraspError(f"the grasp at {grasp.position} lies behind the camera; check world_from_camera")
    du, dv = camera.horizontal_jacobian(position) @ grasp.closing_axis[:2]
    return ImageGrasp(float(u), float(v), math.atan2(-dv, du), math.hypot(du, dv) * grasp.width, float(depth))


def to_world(grasp: ImageGrasp, camera: Camera) -> Grasp:
    """The world grasp of an image grasp; inverse of `to_image`.

    Raises:
        GraspError: the camera looks along the table, so that an image angle fixes no horizontal axis.
    """
    position = camera.deproject(np.array([grasp.u, grasp.v]), np.array(grasp.depth))
    jacobian = camera.horizontal_jacobian(position)
    if abs(np.linalg.det(jacobian)) < 1e-6 * np.abs(jacobian).max() ** 2:
        raise GraspError(
            "the camera looks along the table: an image angle fixes no grasp angle there; tilt it downwards"
        )
    axis = np.linalg.solve(jacobian, [math.cos(grasp.angle), -math.sin(grasp.angle)])
    return Grasp(
        (float(position[0]), float(position[1]), float(position[2])),
        math.atan2(axis[1], axis[0]),
        float(np.hypot(*axis)) * grasp.width,
    )
