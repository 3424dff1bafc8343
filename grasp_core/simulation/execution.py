"""One attempt in dynamics: close, lift, and see whether the object comes along."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import msgspec
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from grasp_core.grasp import Grasp
from grasp_core.simulation.contacts import finger_contacts
from grasp_core.simulation.engine import Engine
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

_STILL = 0.001
"""m/s: slower fingers stand still."""
_LOOK = 5
"""Steps between two looks at the state: Python stays out of the steps between."""
_CLEAR = 0.005
"""m: an object whose lowest point is higher is clear of the table."""
_SLIDE = (0.002, 0.05)
"""m/s and rad/s: an object slower than this relative to the gripper is at rest in it."""
_REST = 4
"""Looks in a row at which an object must be at rest in the gripper before a lift may end early."""
_LOST = 0.06
"""s without any touch after which an object is lost: the fingers have then met at the centre plane."""


@dataclass
class _State:
    """What is known while an attempt runs."""

    held: tuple[FingerContact | None, FingerContact | None] = (None, None)
    held_lift: float = 0.0
    held_time: float = 0.0
    held_place: NDArray[np.float64] | None = None
    loose: float = 0.0
    rest: int = 0
    travel: tuple[float, float] = (0.0, 0.0)
    start: list[NDArray[np.float64]] = field(default_factory=list)


class Execution:
    """Runs attempts on one engine; see `run`.

    Attributes:
        engine: where they run.
    """

    def __init__(self, engine: Engine, poses: Sequence[NDArray[np.float64]]) -> None:
        """Keep the engine and the poses (4×4 each) from which every attempt starts."""
        self.engine = engine
        self._poses = list(poses)
        self._physics = engine.physics
        self._hulls = [np.asarray(item.asset.hull.vertices, float) for item in engine.objects]

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
        engine = self.engine
        engine.rewind(self._poses)
        opened = (engine.spec.opening - grasp.width) / 2
        engine.grip(grasp.world_from_gripper, (opened + advance, opened + advance))
        state = _State(start=[item.pose for item in engine.objects])
        unstable = Outcome.UNSTABLE, Evidence(words="the solver diverged"), None
        if not self._close(state, recorder):
            return unstable
        left, right = engine.travel
        state.travel = (round(left - opened, 6), round(right - opened, 6))
        sides = engine.touched()
        if not (sides[0] and sides[1]):
            gap = engine.spec.opening - left - right
            words = "closed on nothing" + ("" if gap < 0.001 else f": the fingers stopped {millimetres(gap)} apart")
            if sides[0] or sides[1]:
                words += f"; only the {'left' if sides[0] else 'right'} finger touched the object"
            return Outcome.MISSED, Evidence(words=words, travel=state.travel), None
        self._hold(state, grasp)
        if not self._lift(state, grasp, whole, recorder):
            return unstable
        return self._verdict(state, grasp)

    def _close(self, state: _State, recorder: Recorder | None) -> bool:
        """Close until both fingers stand still; False if the solver diverged."""
        engine = self.engine
        calm = 0
        for _ in range(int(self._physics.closing_time / self._physics.time_step / _LOOK)):
            engine.advance(_LOOK)
            if recorder:
                recorder.frame(engine, "close")
            if engine.diverged:
                return False
            calm = calm + 1 if engine.fastest < _STILL else 0
            if calm >= 2:
                break
        return True

    def _hold(self, state: _State, grasp: Grasp) -> bool:
        """Look at the grip; True and noted if both fingers touch an object."""
        found = self.engine.touches()
        if not ({touch.finger for touch in found} >= {0, 1}):
            return False
        frame = grasp.world_from_gripper
        frame[2, 3] += self.engine.lift
        state.held = finger_contacts(found, frame)
        state.held_place = np.mean([touch.point for touch in found], axis=0)
        self._still_held(state)
        return True

    def _still_held(self, state: _State) -> None:
        state.held_lift = self.engine.lift
        state.held_time = self.engine.time
        state.loose = 0.0

    def _lift(self, state: _State, grasp: Grasp, whole: bool, recorder: Recorder | None) -> bool:
        """Lift to the full height, or until the verdict is certain; False if the solver diverged."""
        engine, physics = self.engine, self._physics
        look = _LOOK * physics.time_step
        speed = 0.0
        while engine.lift < physics.lift_height:
            gain = min(physics.lift_speed * look / physics.lift_ramp, physics.lift_speed - speed)
            engine.advance(_LOOK, speed, gain / look)
            speed += gain
            if recorder:
                recorder.frame(engine, "lift")
            if engine.diverged:
                return False
            state.rest = state.rest + 1 if self._resting(state) else 0
            if state.rest:  # its contacts stay what they were: no need to read them again
                self._still_held(state)
                early = not whole and state.rest >= _REST and engine.lift >= physics.early_height
                if early and self._clear(state) and self._hold(state, grasp):
                    break
            elif not self._hold(state, grasp) and not any(engine.touched()):
                state.loose += look
                if state.loose >= _LOST and not whole:
                    break
        if state.rest:
            self._hold(state, grasp)
        return True

    def _objects(self, state: _State) -> set[int]:
        """Indices of the objects in the grip when it last held."""
        return {contact.object for contact in state.held if contact is not None}

    def _clearance(self, index: int) -> float:
        pose = self.engine.objects[index].pose
        return float((self._hulls[index] @ pose[2, :3]).min() + pose[2, 3])

    def _resting(self, state: _State) -> bool:
        """Whether what is held moves no more than the gripper does."""
        rising = self.engine.rising
        for index in self._objects(state):
            vx, vy, vz, wx, wy, wz = self.engine.objects[index].velocity
            if max(abs(vx), abs(vy), abs(vz - rising)) > _SLIDE[0] or max(abs(wx), abs(wy), abs(wz)) > _SLIDE[1]:
                return False
        return True

    def _clear(self, state: _State) -> bool:
        """Whether what is held is clear of the table."""
        return all(self._clearance(index) > _CLEAR for index in self._objects(state))

    def _verdict(self, state: _State, grasp: Grasp) -> tuple[Outcome, Evidence, Comfort | None]:
        objects = self._objects(state)
        index = min(objects)
        if len(objects) == 2:
            index = state.held[0].object if state.held[0] else index
        sides = self.engine.touched()
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
            after = self.engine.objects[index].pose
            after[2, 3] -= self.engine.lift
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
