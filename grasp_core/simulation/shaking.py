"""A disturbance after the lift: the held object is shaken harder and harder along one axis until it slips.

The base stands still and the object feels what it would in a gripper that is shaken: a force of its mass times the
acceleration, through its centre of mass, beside its weight. As a force it is exact in every engine.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from grasp_core import config
from grasp_core.grasp import Grasp
from grasp_core.simulation.engine import Engine
from grasp_core.simulation.evidence import Withstood, triple

_AXES = ("x", "y", "z")
_REST = 0.1
"""s between the stop of the base and the first push."""
_LOOK = 0.01
"""s between two looks."""
_SLIP = 0.005
"""m that the object's centre may move between the fingers, from its place before the first push, and count as held."""


class Shake(config.Settings):
    """How a held object is shaken.

    Attributes:
        axis: of the gripper: x is the closing axis, y runs across the fingers' faces, z up.
        step: by which the acceleration grows, m/s²; also the first one.
        most: acceleration at which the shaking ends, m/s².
        push: time for which each acceleration acts one way, and then the other, s.
    """

    axis: Literal["x", "y", "z"]
    step: float = 2.0
    most: float = 60.0
    push: float = 0.1

    def __post_init__(self) -> None:
        for field in ("step", "most", "push"):
            value = getattr(self, field)
            if not 0 < value < math.inf:
                raise ValueError(f"{field} must be above 0, not {value}")
        if self.step > self.most:
            raise ValueError(f"step {self.step} is above most {self.most}: nothing would be shaken")

    @property
    def levels(self) -> list[float]:
        """The accelerations in order, m/s²."""
        return [self.step * number for number in range(1, math.floor(self.most / self.step + 1e-9) + 1)]

    def direction(self, grasp: Grasp) -> NDArray[np.float64]:
        """Unit vector of the axis in the world."""
        return np.asarray(grasp.world_from_gripper[:3, _AXES.index(self.axis)], float)


def shake_held(
    engine: Engine, grasp: Grasp, index: int, shake: Shake, frame: Callable[[], None] = lambda: None
) -> Withstood | None:
    """Stop a lifted gripper and shake what it holds.

    Args:
        engine: at the end of a lift.
        grasp: as executed.
        index: of the object that is held.
        shake: how.
        frame: called after every look.

    Returns:
        What the grasp withstood, both ways; None if the solver diverged.
    """
    physics, item = engine.physics, engine.objects[index]
    mass, axis = physics.mass(item.asset), shake.direction(grasp)
    look = max(1, round(_LOOK / physics.time_step))
    place: NDArray[np.float64] | None = None

    def held(duration: float, deceleration: float = 0.0) -> bool:
        """Let time pass; whether the object stays where it is between the fingers."""
        left = max(1, round(duration / physics.time_step))
        touched = [False, False]
        while left:
            steps = min(look, left)
            left -= steps
            engine.advance(steps, engine.rising if deceleration else 0.0, -deceleration)
            frame()
            touched = [one or other for one, other in zip(touched, engine.touched(), strict=True)]
            moved = 0.0 if place is None else float(np.linalg.norm(_between_fingers(engine, grasp, index) - place))
            if engine.diverged or moved > _SLIP:
                return False
        return all(touched)

    withstood, slipped = 0.0, 0.0
    if held(physics.lift_ramp, engine.rising / physics.lift_ramp) and held(_REST):
        place = _between_fingers(engine, grasp, index)
        for acceleration in shake.levels:
            for sign in (1.0, -1.0):
                engine.push(index, sign * acceleration * mass * axis)
                if not held(shake.push):
                    slipped = sign * acceleration
                    break
            if slipped:
                break
            withstood = acceleration
    if engine.diverged:
        return None
    return Withstood(
        shake.axis,
        triple(axis),
        round(withstood, 6),
        round(withstood * mass, 6),
        round(slipped, 6) if withstood < shake.levels[-1] else None,
    )


def _between_fingers(engine: Engine, grasp: Grasp, index: int) -> NDArray[np.float64]:
    """The object's centre of mass in the gripper's frame, along the closing axis from the middle between the fingers.

    The fingers are pushed with one force each and nothing ties them to each other: along the closing axis they move
    with the object, which is no slip.
    """
    offset = engine.objects[index].pose[:3, 3] - grasp.position
    offset[2] -= engine.lift
    place = grasp.world_from_gripper[:3, :3].T @ offset
    left, right = engine.travel
    place[0] -= (left - right) / 2
    return place
