"""One attempt in dynamics: close, lift, and see whether the object comes along."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import msgspec
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from grasp_core.grasp import Grasp
from grasp_core.simulation.contacts import Touch, contact_kinds, finger_contacts, strain
from grasp_core.simulation.engine import Engine
from grasp_core.simulation.evidence import (
    Comfort,
    Evidence,
    Outcome,
    hold_words,
    millimetres,
    triple,
    withstood_words,
)
from grasp_core.simulation.recorder import Recorder
from grasp_core.simulation.shaking import Shake, shake_held

_GLANCE = 0.01
_LOOK = 0.02
"""s between two looks at the state, in the closing and in the lift: Python stays out of the steps between."""
_FLICKER = 5
"""Steps in which both fingers must touch an object at least once to hold it: single contacts come and go."""
_STILL = 0.005
"""m/s, mean between two looks: slower fingers stand still. Single steps say little: contacts on facets come and go, and
a pad chatters at 5-20 mm/s about its place."""
_AGAIN = 2
"""Looks in a row at which the fingers must be found still."""
_CERTAIN = (
    (0.0020, math.radians(5.0), 2, 0.50, 0.00),
    (0.0010, math.radians(2.5), 2, 0.75, 0.00),
    (0.0005, math.radians(1.0), 3, math.inf, 0.00),
    (0.0050, math.radians(5.0), 5, math.inf, 0.12),
)
"""When the verdict on a lift is certain, any of: slower than so many m/s and rad/s relative to the gripper (means
between two looks), for so many looks in a row, in a grip that uses less than this share of its friction, at least so
many metres up. A grip near the limit of its friction may creep for 10 to 20 cm before it lets go: hence the slower the
nearer to it. What a finger holds by a point alone may turn about it and come loose at any height: it is lifted all the
way (230 of 1,094 early successes were held so, and 15 of the 18 that the whole lift called slipped)."""
_READ = 3
"""Looks between two readings of the contacts while the object moves in the gripper."""
_CLEAR = 0.005
"""m: an object whose lowest point is higher is clear of the table."""
_LOST = 0.06
"""s without any touch after which an object is lost: the fingers have then met at the centre plane."""


@dataclass
class _State:
    """What is known while an attempt runs."""

    frame: NDArray[np.float64]
    objects: frozenset[int] = frozenset()
    touches: list[Touch] = field(default_factory=list)
    touches_lift: float = 0.0
    held_lift: float = 0.0
    held_time: float = 0.0
    loose: float = 0.0
    calm: list[int] = field(default_factory=lambda: [0] * len(_CERTAIN))
    kept: bool = False
    seen: dict[int, NDArray[np.float64]] = field(default_factory=dict)
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
        self._glance = max(1, round(_GLANCE / engine.physics.time_step))
        self._steps = max(1, round(_LOOK / engine.physics.time_step))
        self._look = self._steps * engine.physics.time_step
        self._hulls = [np.asarray(item.asset.hull.vertices, float) for item in engine.objects]

    def run(
        self, grasp: Grasp, advance: float, *, whole: bool, recorder: Recorder | None, shake: Shake | None = None
    ) -> tuple[Outcome, Evidence, Comfort | None]:
        """Execute one grasp as it is.

        Args:
            grasp: as executed, noise included; known not to collide on the way in.
            advance: free way that both fingers have behind them when the simulation starts, metres.
            whole: lift the full height even when the verdict is certain earlier.
            recorder: takes frames, or None.
            shake: how an object that was lifted, then to the full height, is shaken; the outcome stays that of the
                lift, evidence says what was withstood.

        Returns:
            Outcome, evidence, and comfort if the object was lifted. UNSTABLE if the solver diverged.
        """
        engine = self.engine
        engine.rewind(self._poses)
        opened = (engine.spec.opening - grasp.width) / 2
        engine.grip(grasp.world_from_gripper, (opened + advance, opened + advance))
        state = _State(grasp.world_from_gripper, start=[item.pose for item in engine.objects])
        unstable = Outcome.UNSTABLE, Evidence(words="the solver diverged"), None
        if not self._close(recorder):
            return unstable
        left, right = engine.travel
        state.travel = (round(left - opened, 6), round(right - opened, 6))
        if not self._hold(state, patience=_FLICKER):
            return Outcome.MISSED, self._missed(state), None
        if not self._lift(state, whole or shake is not None, recorder):
            return unstable
        outcome, evidence, comfort = self._verdict(state, grasp)
        if shake is None or outcome is not Outcome.SUCCESS or evidence.object is None:
            return outcome, evidence, comfort
        film = (lambda: recorder.frame(engine, "shake")) if recorder else (lambda: None)
        withstood = shake_held(engine, grasp, evidence.object, shake, film)
        if withstood is None:
            return unstable
        words = f"{evidence.words}; {withstood_words(withstood)}"
        return outcome, msgspec.structs.replace(evidence, words=words, withstood=withstood), comfort

    def _close(self, recorder: Recorder | None) -> bool:
        """Close until both fingers stand still; False if the solver diverged."""
        engine = self.engine
        calm = 0
        glance = self._glance * self._physics.time_step
        way = _STILL * glance
        before = engine.travel
        for _ in range(round(self._physics.closing_time / glance)):
            engine.advance(self._glance)
            if recorder:
                recorder.frame(engine, "close")
            if engine.diverged:
                return False
            now = engine.travel
            calm = calm + 1 if max(abs(now[0] - before[0]), abs(now[1] - before[1])) < way else 0
            if calm >= _AGAIN:
                break
            before = now
        return True

    def _missed(self, state: _State) -> Evidence:
        """Evidence of fingers of which at most one touches something."""
        engine = self.engine
        sides, contacts = engine.touched(), finger_contacts(engine.touches(), state.frame)
        gap = engine.spec.opening - sum(engine.travel)
        words = "closed on nothing" + ("" if gap < 0.001 else f": the fingers stopped {millimetres(gap)} apart")
        if sides[0] or sides[1]:
            words += f"; only the {'left' if sides[0] else 'right'} finger touched the object"
        touched = next((contact.object for contact in contacts if contact), None)
        return Evidence(words=words, travel=state.travel, object=touched, left=contacts[0], right=contacts[1])

    def _hold(self, state: _State, speed: float = 0.0, patience: int = 0) -> bool:
        """Look at the grip; True and noted if both fingers touch an object, at the latest after `patience` steps."""
        latest: dict[int, list[Touch]] = {}
        while True:
            found = self.engine.touches()
            for finger in (0, 1):
                mine = [touch for touch in found if touch.finger == finger]
                if mine:
                    latest[finger] = mine
            if len(latest) == 2:
                break
            if patience == 0:
                return False
            patience -= 1
            self.engine.advance(1, speed)
        state.touches = latest[0] + latest[1]
        state.touches_lift = self.engine.lift
        state.objects = frozenset(touch.object for touch in state.touches)
        self._still_held(state)
        return True

    def _still_held(self, state: _State) -> None:
        state.held_lift = self.engine.lift
        state.held_time = self.engine.time
        state.loose = 0.0

    def _lift(self, state: _State, whole: bool, recorder: Recorder | None) -> bool:
        """Lift to the full height, or until the verdict is certain; False if the solver diverged."""
        engine, physics = self.engine, self._physics
        look, speed, looks = self._look, 0.0, 0
        while engine.lift < physics.lift_height:
            gain = min(physics.lift_speed * look / physics.lift_ramp, physics.lift_speed - speed)
            engine.advance(self._steps, speed, gain / look)
            speed += gain
            looks += 1
            if recorder:
                recorder.frame(engine, "lift")
            if engine.diverged:
                return False
            self._watch(state)
            if not whole and engine.lift >= physics.early_height and self._certain(state):
                break
            if state.calm[0]:  # its contacts stay what they were: no need to read them again
                self._still_held(state)
                continue
            sides = engine.touched()
            if all(sides):
                self._still_held(state)
                if looks % _READ == 0:
                    self._hold(state)
            elif not any(sides):
                state.loose += look
                if state.loose >= _LOST and not whole:
                    break
        state.kept = self._hold(state, physics.lift_speed, _FLICKER)
        return True

    def _clearance(self, index: int) -> float:
        pose = self.engine.objects[index].pose
        return float((self._hulls[index] @ pose[2, :3]).min() + pose[2, 3])

    def _watch(self, state: _State) -> None:
        """Count for how many looks in a row what is held has been as slow in the gripper as each rule wants it."""
        moved, cosine = 0.0, 1.0
        for index in state.objects:
            pose = self.engine.objects[index].pose
            pose[2, 3] -= self.engine.lift
            before = state.seen.get(index, np.zeros((4, 4)))
            state.seen[index] = pose
            moved = max(moved, float(np.abs(pose[:3, 3] - before[:3, 3]).max()))
            cosine = min(cosine, float((pose[:3, :3] * before[:3, :3]).sum() - 1) / 2)
        turned = math.acos(max(-1.0, min(1.0, cosine)))
        for number, (speed, turn, *_) in enumerate(_CERTAIN):
            slow = moved < speed * self._look and turned < turn * self._look
            state.calm[number] = state.calm[number] + 1 if slow else 0

    def _certain(self, state: _State) -> bool:
        """Whether the rest of the lift would change nothing."""
        limits = [
            limit
            for calm, (_, _, looks, limit, height) in zip(state.calm, _CERTAIN, strict=True)
            if calm >= looks and self.engine.lift >= height
        ]
        if not limits or not self._clear(state) or not self._hold(state):
            return False
        if "point" in contact_kinds(state.touches, state.frame):
            return False
        return max(limits) == math.inf or strain(state.touches, self._physics.friction) < max(limits)

    def _clear(self, state: _State) -> bool:
        """Whether what is held is clear of the table."""
        return all(self._clearance(index) > _CLEAR for index in state.objects)

    def _verdict(self, state: _State, grasp: Grasp) -> tuple[Outcome, Evidence, Comfort | None]:
        frame = grasp.world_from_gripper
        frame[2, 3] += state.touches_lift
        left, right = finger_contacts(state.touches, frame)
        index = left.object if left else min(state.objects)
        clearance = min(self._clearance(each) for each in state.objects)
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
        if state.kept and clearance > _CLEAR:
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
        if state.kept:
            words = f"both fingers still hold it, but it is not clear of the table after {millimetres(state.held_lift)}"
        elif state.held_lift < 0.001:
            words = "slipped as soon as the lift began"
        else:
            words = f"slipped after {millimetres(state.held_lift)} of the lift"
        place = np.mean([touch.point for touch in state.touches], axis=0)
        place[2] += state.held_lift - state.touches_lift  # contacts that were not read again rose with the gripper
        time = round(state.held_time, 4)
        evidence = msgspec.structs.replace(known, words=words + holds, place=triple(place), time=time)
        return Outcome.SLIPPED, evidence, None
