"""What an attempt needs from a physics engine, so that one protocol runs in DART and in those that check it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from grasp_core.gripper import Gripper
from grasp_core.objects.asset import ObjectAsset
from grasp_core.simulation.contacts import Touch
from grasp_core.simulation.physics import Physics

Velocity = tuple[float, float, float, float, float, float]


class EngineObject(Protocol):
    """One object in an engine."""

    @property
    def asset(self) -> ObjectAsset:
        """What it is."""
        ...

    @property
    def pose(self) -> NDArray[np.float64]:
        """world_from_object, 4×4; a copy."""
        ...

    @property
    def velocity(self) -> Velocity:
        """Linear (m/s) then angular (rad/s) velocity in the world."""
        ...


class Engine(Protocol):
    """Objects on the table and one gripper."""

    @property
    def physics(self) -> Physics:
        """The settings it follows."""
        ...

    @property
    def spec(self) -> Gripper:
        """The gripper."""
        ...

    @property
    def objects(self) -> Sequence[EngineObject]:
        """In the order of the scene."""
        ...

    def rewind(self, poses: Sequence[NDArray[np.float64]]) -> None:
        """Start afresh, the objects at rest at these poses (4×4), the gripper out of the way."""
        ...

    def grip(self, world_from_gripper: NDArray[np.float64], travel: tuple[float, float]) -> None:
        """Put the gripper at a pose (4×4, z up), each finger at its travel from fully open, metres, and closing."""
        ...

    def advance(self, steps: int, speed: float = 0.0, acceleration: float = 0.0) -> None:
        """Close with full force for some steps while the base rises: at `speed` before the first, then accelerating."""
        ...

    def push(self, index: int, force: NDArray[np.float64]) -> None:
        """Push an object with a force (3,) at its centre of mass, world, N, from now on; a rewind ends it."""
        ...

    @property
    def time(self) -> float:
        """Seconds since the last rewind."""
        ...

    @property
    def lift(self) -> float:
        """How far the base has risen, metres."""
        ...

    @property
    def rising(self) -> float:
        """How fast it rises, m/s."""
        ...

    @property
    def travel(self) -> tuple[float, float]:
        """How far each finger has closed from fully open (left, right), metres."""
        ...

    @property
    def diverged(self) -> bool:
        """Whether the solver lost it."""
        ...

    def touched(self) -> tuple[bool, bool]:
        """Whether the left and the right finger touch an object."""
        ...

    def touches(self) -> list[Touch]:
        """Every contact between a finger and an object."""
        ...
