"""The protocol of an attempt, on an engine whose physics is told: what it sees decides the verdict."""

import math

import numpy as np
import pytest

from grasp_core.grasp import Grasp
from grasp_core.simulation.contacts import Touch
from grasp_core.simulation.evidence import Outcome
from grasp_core.simulation.execution import Execution
from grasp_core.simulation.world import World

GRASP = Grasp((0.0, 0.0, 0.03), 0.0, 0.08)
HALF = 0.02


class Told:
    """A box of 4 cm between the fingers that follows the gripper as it is told, kinematically."""

    def __init__(
        self,
        asset,
        pose,
        physics,
        gripper,
        *,
        fingers=(0, 1),
        lost=math.inf,
        follows=True,
        shift=0.0,
        turn=0.0,
        bad=None,
    ):
        """Fingers that touch, lift at which the object falls, its motion in the grip; `bad`: phase that diverges."""
        self.asset, self.physics, self.spec = asset, physics, gripper
        self.fingers, self.lost, self.follows, self.shift, self.turn, self.bad = (
            fingers,
            lost,
            follows,
            shift,
            turn,
            bad,
        )
        self.objects = [self]
        self._start = pose
        self.poses = [pose]

    def rewind(self, poses):
        assert [p.tolist() for p in poses] == [self._start.tolist()]
        self.time, self.lift, self.rising = 0.0, 0.0, 0.0

    def grip(self, world_from_gripper, travel):
        self.frame, self.travel = world_from_gripper, travel
        self.gripped = travel

    def advance(self, steps, speed=0.0, acceleration=0.0):
        span = steps * self.physics.time_step
        self.time += span
        self.lift += speed * span + acceleration * span**2 / 2
        self.rising = speed + acceleration * span
        stop = self.spec.opening / 2 - (HALF if self.fingers else 0.0)
        step = self.spec.speed * span
        travel = tuple(min(stop, way + step) for way in self.travel)
        self.travel = travel

    @property
    def closed(self):
        return self.travel[0] >= self.spec.opening / 2 - HALF - 1e-12

    @property
    def held(self):
        return self.closed and len(self.fingers) == 2 and self.lift < self.lost

    @property
    def pose(self):
        pose = self._start.copy()
        if self.held and self.lift > 0 and self.follows:
            pose[2, 3] += self.lift
            pose[0, 3] += self.shift
            c, s = math.cos(self.turn), math.sin(self.turn)
            pose[:2, :2] = [[c, -s], [s, c]]
        return pose

    @property
    def velocity(self):
        return (0.0, 0.0, self.rising if self.held and self.follows else 0.0, 0.0, 0.0, 0.0)

    @property
    def diverged(self):
        return self.bad == ("lift" if self.lift > 0 else "close")

    def touched(self):
        if not self.closed or self.lift >= self.lost:
            return False, False
        return tuple(finger in self.fingers for finger in (0, 1))

    def touches(self):
        found = []
        for finger, touched in enumerate(self.touched()):
            side = -1.0 if finger == 0 else 1.0
            for y in (-0.008, 0.008) if touched else ():
                for z in (-0.01, 0.01):
                    point = np.array([side * HALF, y, 0.03 + z + self.lift])
                    found.append(Touch(finger, 0, point, np.array([side, 0, 0]), np.array([-side * 5.0, 0, 0.5])))
        return found


class Frames:
    """Counts frames per phase and remembers how high the last one was."""

    def __init__(self):
        self.phases, self.lifts = [], []

    def frame(self, engine, phase):
        self.phases.append(phase)
        self.lifts.append(engine.lift)


@pytest.fixture
def told(physics, gripper, shapes):
    box = shapes.box(2 * HALF, 0.06, 0.06)
    pose = shapes.standing(box)

    def run(whole=True, recorder=None, advance=0.0, **kind):
        engine = Told(box, pose, physics, gripper, **kind)
        return engine, *Execution(engine, [pose]).run(GRASP, advance, whole=whole, recorder=recorder)

    return run


def test_held_to_the_top_is_a_success(told, physics):
    engine, outcome, evidence, comfort = told()
    assert outcome is Outcome.SUCCESS
    assert engine.lift >= physics.lift_height
    assert evidence.lift == pytest.approx(engine.lift, abs=1e-3)
    assert evidence.clearance == pytest.approx(engine.lift, abs=1e-3)
    assert evidence.object == 0 and evidence.time is None
    assert evidence.travel == pytest.approx((0.02, 0.02))  # from the grasp's 8 cm to the box's 4 cm
    assert (evidence.left.force, evidence.right.force) == (20.0, 20.0)
    assert evidence.left.friction == 2.0 and evidence.left.kind == "face"
    assert evidence.left.normal == (-1, 0, 0) and evidence.right.normal == (1, 0, 0)
    assert evidence.left.point == pytest.approx((-0.02, 0, 0))
    assert (comfort.distance, comfort.rotation) == (0, 0)
    assert "held by both fingers and clear of the table by 30." in evidence.words


def test_comfort_is_the_motion_in_the_grippers_frame(told):
    _, outcome, evidence, comfort = told(shift=0.004, turn=0.2)
    assert outcome is Outcome.SUCCESS
    assert comfort.distance == pytest.approx(0.004, abs=1e-6)
    assert comfort.rotation == pytest.approx(0.2, abs=1e-6)
    assert "moved by 4 mm and turned by 11°" in evidence.words


def test_a_certain_lift_ends_early_unless_the_whole_is_asked_for(told, physics):
    short, long = told(whole=False), told(whole=True)
    assert short[1] is long[1] is Outcome.SUCCESS
    assert physics.early_height <= short[0].lift < physics.lift_height <= long[0].lift
    assert short[3] == long[3]


def test_the_free_way_is_behind_the_fingers_when_it_starts(told):
    engine, outcome, evidence, _ = told(advance=0.015)
    assert engine.gripped == pytest.approx((0.025, 0.025))  # 1 cm to the grasp's width, 1.5 cm of free way
    assert engine.frame.tolist() == GRASP.world_from_gripper.tolist()
    assert outcome is Outcome.SUCCESS and evidence.travel == pytest.approx((0.02, 0.02))


@pytest.mark.parametrize("whole", [True, False])
def test_lost_on_the_way_is_slipped_and_says_where(told, whole):
    engine, outcome, evidence, comfort = told(lost=0.02, whole=whole)
    assert outcome is Outcome.SLIPPED and comfort is None
    assert 0 < evidence.lift <= engine.lost
    x, y, z = evidence.place
    assert (x, y) == pytest.approx((0, 0), abs=1e-6) and 0.03 <= z <= 0.03 + evidence.lift + 1e-3
    assert 0 < evidence.time < engine.time
    assert "slipped after" in evidence.words
    assert evidence.left.force == 20.0  # how it held when it last held


def test_an_object_long_gone_is_not_lifted_after(told, physics):
    short, long = told(lost=0.01, whole=False), told(lost=0.01, whole=True)
    assert short[1] is long[1] is Outcome.SLIPPED
    assert short[0].lift < 0.5 * physics.lift_height <= long[0].lift


def test_the_place_of_the_loss_has_risen_with_a_calm_object(told):
    """Contacts are not read again while an object rests in the grip; where it was lost is told all the same."""
    _, outcome, evidence, _ = told(lost=0.2)
    assert outcome is Outcome.SLIPPED
    assert evidence.lift == pytest.approx(0.2, abs=7e-3)  # a look is 6 mm
    assert evidence.place[2] == pytest.approx(0.03 + evidence.lift, abs=1e-6)


@pytest.mark.parametrize("whole", [True, False])
def test_contacts_without_force_never_make_a_lost_object_a_held_one(physics, gripper, shapes, whole):
    """Detectors report pairs that barely touch, with no force: the fingers count as touched, nothing is held."""

    class Grazed(Told):
        def touched(self):
            return (True, True) if self.closed else (False, False)

    box = shapes.box(2 * HALF, 0.06, 0.06)
    pose = shapes.standing(box)
    engine = Grazed(box, pose, physics, gripper, lost=0.01)
    outcome, _, comfort = Execution(engine, [pose]).run(GRASP, 0.0, whole=whole, recorder=None)
    assert outcome is Outcome.SLIPPED and comfort is None


def test_lost_at_once(told):
    _, outcome, evidence, _ = told(lost=1e-6)
    assert outcome is Outcome.SLIPPED
    assert evidence.words.startswith("slipped as soon as the lift began")


@pytest.mark.parametrize("whole", [True, False])
def test_held_but_left_on_the_table_is_no_success(told, whole):
    _, outcome, evidence, comfort = told(follows=False, whole=whole)
    assert outcome is Outcome.SLIPPED and comfort is None
    assert "not clear of the table" in evidence.words
    assert evidence.clearance == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize(
    ("fingers", "words"),
    [
        ((), "closed on nothing"),
        ((0,), "closed on nothing: the fingers stopped 4.0 cm apart; only the left finger touched the object"),
        ((1,), "closed on nothing: the fingers stopped 4.0 cm apart; only the right finger touched the object"),
    ],
)
def test_without_both_fingers_it_is_missed_and_not_lifted(told, fingers, words):
    engine, outcome, evidence, comfort = told(fingers=fingers)
    assert outcome is Outcome.MISSED and comfort is None
    assert evidence.words == words
    assert engine.lift == 0
    assert evidence.travel[0] == pytest.approx(0.02 if fingers else 0.04)
    assert [contact is not None for contact in (evidence.left, evidence.right)] == [0 in fingers, 1 in fingers]
    assert evidence.object == (0 if fingers else None)
    for contact in filter(None, (evidence.left, evidence.right)):
        assert contact.force == 20.0 and abs(contact.normal[0]) == 1.0


@pytest.mark.parametrize("phase", ["close", "lift"])
def test_a_solver_that_is_lost_is_unstable(told, phase):
    engine, outcome, evidence, comfort = told(bad=phase)
    assert outcome is Outcome.UNSTABLE and comfort is None
    assert "diverged" in evidence.words
    assert (engine.lift > 0) == (phase == "lift")


def test_closing_takes_no_longer_than_it_may(told, physics):
    """Fingers that never stand still are not waited for."""

    class Restless(Told):
        def advance(self, steps, speed=0.0, acceleration=0.0):
            super().advance(steps, speed, acceleration)
            if not speed and not acceleration:
                self.travel = (self.travel[0] - 0.004 * (self.time % 0.04 > 0.02), self.travel[1])

    box_engine = told()[0]
    engine = Restless(box_engine.asset, box_engine._start, physics, box_engine.spec, fingers=())
    outcome, _, _ = Execution(engine, [box_engine._start]).run(GRASP, 0.0, whole=True, recorder=None)
    assert outcome is Outcome.MISSED
    assert engine.time == pytest.approx(physics.closing_time, rel=0.1)


def test_frames_of_both_phases_are_recorded(told, physics):
    frames = Frames()
    told(recorder=frames)
    assert set(frames.phases) == {"close", "lift"}
    assert frames.phases == sorted(frames.phases)  # first all of the closing
    assert frames.lifts[-1] >= physics.lift_height
    assert max(np.diff(frames.lifts)) < 0.01


def test_in_dart_the_whole_lift_agrees_with_the_short_one(physics, gripper, shapes):
    box = shapes.box(0.04, 0.06, 0.06)
    pose = shapes.standing(box)
    execution = Execution(World([box], physics, gripper, poses=[pose]), [pose])
    short, long = (execution.run(GRASP, 0.018, whole=whole, recorder=None) for whole in (False, True))
    assert short[0] is long[0] is Outcome.SUCCESS
    assert physics.early_height <= short[1].lift < long[1].lift == pytest.approx(physics.lift_height, abs=0.01)
    assert short[2].distance == pytest.approx(long[2].distance, abs=1e-3)
