"""The parallel-jaw gripper: its boxes, opening and force, read from a YAML file.

Gripper frame: origin p (the midpoint of the fingers' lower ends), x along the closing axis, z up. The fingers stand on
z = 0; the rod lies on top of them, the base on top of the rod. DART builds its gripper from these boxes; the URDF is
what people see.
"""

from __future__ import annotations

import math
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray

from grasp_core import config
from grasp_core.errors import ConfigError


class Box(config.Settings):
    """Size of a box in metres: x along the closing axis, y across it, z up."""

    x: float
    y: float
    z: float

    def __post_init__(self) -> None:
        if not all(0 < side < math.inf for side in self.size):
            raise ValueError(f"a box's sides are finite lengths above 0 in metres, not {self.x}, {self.y}, {self.z}")

    @property
    def size(self) -> tuple[float, float, float]:
        """(x, y, z), metres."""
        return self.x, self.y, self.z


class Gripper(config.Settings):
    """A parallel-jaw gripper.

    Attributes:
        name: what people call it.
        opening: largest distance between the fingers' inner faces, metres; the gripper's length.
        finger: one finger.
        rod: the cross-bar that carries the fingers.
        base: the block above the rod.
        finger_mass: of one finger, kg.
        force: of one finger, N.
        speed: of one finger while closing, at most, m/s.
        urdf: file beside the YAML that shows the gripper, or none.
    """

    name: str
    opening: float
    finger: Box
    rod: Box
    base: Box
    finger_mass: float
    force: float
    speed: float
    urdf: str | None = None

    def __post_init__(self) -> None:
        for field in ("opening", "finger_mass", "force", "speed"):
            if not 0 < getattr(self, field) < math.inf:
                raise ValueError(f"{field} must be a finite number above 0, not {getattr(self, field)}")
        if self.rod.x < self.opening + 2 * self.finger.x - 1e-9:
            raise ValueError(
                f"the rod is {self.rod.x} m long but must carry two fingers at full opening:"
                f" {self.opening + 2 * self.finger.x:.3f} m"
            )

    def boxes(self, opening: float | None = None) -> dict[str, tuple[Box, NDArray[np.float64]]]:
        """Name → (box, its centre (3,) in the gripper frame, metres) at an opening (default: fully open)."""
        half = (self.opening if opening is None else opening) / 2
        up = self.finger.z
        return {
            "left_finger": (self.finger, np.array([-half - self.finger.x / 2, 0, up / 2])),
            "right_finger": (self.finger, np.array([half + self.finger.x / 2, 0, up / 2])),
            "rod": (self.rod, np.array([0, 0, up + self.rod.z / 2])),
            "base": (self.base, np.array([0, 0, up + self.rod.z + self.base.z / 2])),
        }

    @property
    def digest(self) -> str:
        """A hash of what matters to physics: everything but name and URDF."""
        return config.digest(msgspec.structs.replace(self, name="", urdf=None))


def load_gripper(name: str | Path = "paper") -> Gripper:
    """Read a gripper file or a shipped gripper; `urdf` comes back as an absolute path.

    Raises:
        ConfigError: missing file, unknown, missing or ill-typed key, impossible value, or a URDF that is not there.
    """
    path = config.locate("grippers", name)
    gripper = config.load("grippers", name, Gripper)
    if gripper.urdf is None:
        return gripper
    urdf = (path.parent / gripper.urdf).resolve()
    if not urdf.is_file():
        raise ConfigError(f"{path}: urdf: {urdf} is not there; mend the path (relative to the YAML) or leave it out")
    return msgspec.structs.replace(gripper, urdf=str(urdf))
