"""One attempt in dynamics: close, lift, and see whether the object comes along."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import msgspec
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from grasp_core.grasp import Grasp
from grasp_core.simulation.contacts import finger_contacts, touched, touches
from grasp_core.simulation.evidence import (
    Comfort,
    Evidence,
    FingerContact,
    Outcome,
    hold_words,
    millimetres,
    triple,
)
from grasp_core.simulation.recorder import Recorder
from grasp_core.simulation.world import World

_STILL = 0.001
"""m/s: slower fingers stand still."""
_LOOK = 5
"""Steps between two looks at the state: Python stays out of the steps between."""
_CLEAR = 0.005
"""m: an object whose lowest point is higher is clear of the table."""
_SLIDE = (0.002, 0.05)
"""m/s and rad/s: an object slower than this relative to the gripper is at rest in it."""
_LOST = 0.06
"""s without any touch after which an object is lost: the fingers have then met at the centre plane."""


@dataclass
class _State:
    """What is known while an attempt runs."""

    steps: int = 0
    held: tuple[FingerContact | None, FingerContact | None] = (None, None)
    held_lift: float = 0.0
    held_time: float = 0.0
    held_place: NDArray[np.float64] | None = None
    loose: float = 0.0
    travel: tuple[float, float] = (0.0, 0.0)
    start: list[NDArray[np.float64]] = field(default_factory=list)


class Execution:
    """Runs attempts on one world; see `run`."""

    def __init__(self, world: World, poses: Sequence[NDArray[np.float64]]) -> None:
        """Keep the world and the poses (4×4 each) from which every attempt starts."""
        assert world.gripper is not None
        self._world = world
        self._gripper = world.gripper
        self._poses = list(poses)
        self._physics = world.physics
        self._hulls = [np.asarray(item.asset.hull.vertices, float) for item in world.objects]

    def run(
        self, grasp: Grasp, advance: float, *, whole: bool, recorder: Recorder | None
    ) -> tuple[Outcome, Evidence, Comfort | None]:
        """Execute one grasp as it is.

        Args:
            grasp: as executed, noise included; known not to collide on the way in.
            advance: free way that both fingers have behind them when the simulation starts, metres.
            whole: lift the full height even when the verdict is certain earlier.
            recorder: takes frames, or None.

        Returns:
            Outcome, evidence, and comfort if the object was lifted. UNSTABLE if the solver diverged.
        """
        world, gripper = self._world, self._gripper
        world.rewind(self._poses)
        opened = (gripper.spec.opening - grasp.width) / 2
        gripper.place(grasp.world_from_gripper, (opened + advance, opened + advance))
        state = _State(start=[item.pose for item in world.objects])
        unstable = Outcome.UNSTABLE, Evidence(words="the solver diverged"), None
        if not self._close(state, recorder):
            return unstable
        left, right = gripper.travel
        state.travel = (round(left - opened, 6), round(right - opened, 6))
        sides = touched(world)
        if not (sides[0] and sides[1]):
            gap = gripper.spec.opening - left - right
            words = "closed on nothing" + ("" if gap < 0.001 else f": the fingers stopped {millimetres(gap)} apart")
            if sides[0] or sides[1]:
                words += f"; only the {'left' if sides[0] else 'right'} finger touched the object"
            return Outcome.MISSED, Evidence(words=words, travel=state.travel), None
        self._hold(state, grasp)
        if not self._lift(state, grasp, whole, recorder):
            return unstable
        return self._verdict(state, grasp)

    def _advance(self, state: _State, speed: float) -> None:
        self._gripper.command(speed)
        self._world.step()
        state.steps += 1

    def _close(self, state: _State, recorder: Recorder | None) -> bool:
        """Close until both fingers stand still; False if the solver diverged."""
        calm = 0
        for _ in range(int(self._physics.closing_time / self._physics.time_step / _LOOK)):
            for _ in range(_LOOK):
                self._advance(state, 0.0)
            if recorder:
                recorder.frame(self._world, "close", touches(self._world))
            if self._world.diverged:
                return False
            calm = calm + 1 if self._gripper.fastest < _STILL else 0
            if calm >= 2:
                break
        return True

    def _hold(self, state: _State, grasp: Grasp) -> bool:
        """Look at the grip; True and noted if both fingers touch an object."""
        found = touches(self._world)
        if not ({touch.finger for touch in found} >= {0, 1}):
            return False
        frame = grasp.world_from_gripper
        frame[2, 3] += self._gripper.lift
        state.held = finger_contacts(found, frame)
        state.held_lift = self._gripper.lift
        state.held_time = state.steps * self._physics.time_step
        state.held_place = np.mean([touch.point for touch in found], axis=0)
        state.loose = 0.0
        return True

    def _lift(self, state: _State, grasp: Grasp, whole: bool, recorder: Recorder | None) -> bool:
        """Lift to the full height, or until the verdict is certain; False if the solver diverged."""
        physics = self._physics
        begun = state.steps
        while self._gripper.lift < physics.lift_height:
            for _ in range(_LOOK):
                time = (state.steps + 1 - begun) * physics.time_step
                self._advance(state, physics.lift_speed * min(1.0, time / physics.lift_ramp))
            if recorder:
                recorder.frame(self._world, "lift", touches(self._world))
            if self._world.diverged:
                return False
            if self._hold(state, grasp):
                if not whole and self._gripper.lift >= physics.early_height and self._carried(state):
                    break
            elif not any(touched(self._world)):
                state.loose += _LOOK * physics.time_step
                if state.loose >= _LOST and not whole:
                    break
        return True

    def _objects(self, state: _State) -> set[int]:
        """Indices of the objects in the grip when it last held."""
        return {contact.object for contact in state.held if contact is not None}

    def _clearance(self, index: int) -> float:
        pose = self._world.objects[index].pose
        return float((self._hulls[index] @ pose[2, :3]).min() + pose[2, 3])

    def _carried(self, state: _State) -> bool:
        """Whether what is held is clear of the table and at rest in the gripper, so that nothing will change."""
        for index in self._objects(state):
            twist = self._world.objects[index].body.getSpatialVelocity()
            turn = self._world.objects[index].pose[:3, :3]
            velocity = turn @ twist[3:] - [0.0, 0.0, self._physics.lift_speed]
            if np.linalg.norm(velocity) > _SLIDE[0] or np.linalg.norm(twist[:3]) > _SLIDE[1]:
                return False
            if self._clearance(index) < _CLEAR:
                return False
        return True

    def _verdict(self, state: _State, grasp: Grasp) -> tuple[Outcome, Evidence, Comfort | None]:
        objects = self._objects(state)
        index = min(objects)
        if len(objects) == 2:
            index = state.held[0].object if state.held[0] else index
        sides = touched(self._world)
        clearance = min(self._clearance(each) for each in objects)
        left, right = state.held
        holds = f"; {hold_words(left, right)}" if hold_words(left, right) else ""
        known = Evidence(
            words="",
            object=index,
            travel=state.travel,
            left=left,
            right=right,
            clearance=round(clearance, 6),
            lift=round(state.held_lift, 6),
        )
        if sides[0] and sides[1] and clearance > _CLEAR:
            before = state.start[index]
            after = self._world.objects[index].pose
            after[2, 3] -= self._gripper.lift
            comfort = Comfort(
                round(float(np.linalg.norm(after[:3, 3] - before[:3, 3])), 6),
                round(float(Rotation.from_matrix(after[:3, :3] @ before[:3, :3].T).magnitude()), 6),
            )
            words = (
                f"held by both fingers and clear of the table by {millimetres(clearance)}; the object moved by"
                f" {millimetres(comfort.distance)} and turned by {np.degrees(comfort.rotation):.0f}° in the gripper"
            )
            return Outcome.SUCCESS, msgspec.structs.replace(known, words=words + holds), comfort
        if sides[0] and sides[1]:
            words = f"both fingers still hold it, but it is not clear of the table after {millimetres(state.held_lift)}"
        elif state.held_lift < 0.001:
            words = "slipped as soon as the lift began"
        else:
            words = f"slipped after {millimetres(state.held_lift)} of the lift"
        place = None if state.held_place is None else triple(state.held_place)
        time = round(state.held_time, 4)
        evidence = msgspec.structs.replace(known, words=words + holds, place=place, time=time)
        return Outcome.SLIPPED, evidence, None
