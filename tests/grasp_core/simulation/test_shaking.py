"""A held box is shaken; what it withstands is known from Coulomb's law."""

import math

import numpy as np
import pytest

from grasp_core.grasp import Grasp
from grasp_core.simulation.crosscheck import ENGINES
from grasp_core.simulation.evidence import Outcome, withstood_words
from grasp_core.simulation.execution import Execution
from grasp_core.simulation.recording import PHASES
from grasp_core.simulation.shaking import Shake, shake_held
from grasp_core.simulation.trial import GraspTrial

MASS = 0.5
LOW = Grasp((0, 0, 0.008), 0.0, 0.1)
"""Fingers over the box's whole height but 8 mm: the grip is near the centre of mass, so shaking turns little."""


@pytest.fixture(scope="module")
def scene(shapes):
    return shapes.alone(shapes.box(0.04, 0.06, 0.05, MASS))


def withstood(name, scene, physics, gripper, shake):
    if name == "mujoco":
        pytest.importorskip("mujoco")
    execution = Execution(
        ENGINES[name].build(scene, physics, gripper), [placed.world_from_object for placed in scene.objects]
    )
    outcome, evidence, _ = execution.run(LOW, 0.029, whole=False, recorder=None, shake=shake)
    assert outcome is Outcome.SUCCESS
    assert evidence.lift == pytest.approx(physics.lift_height, abs=0.01)  # shaken after the whole lift
    return evidence.withstood


@pytest.mark.parametrize("name", ["dart", "mujoco"])
def test_up_and_down_it_holds_what_friction_carries_beside_the_weight(name, scene, physics, gripper):
    """Both fingers carry 2 μ F at most, and the weight is part of it: a = 2 μ F / m - g = 38.2 m/s²."""
    limit = 2 * physics.friction * gripper.force / MASS - physics.gravity
    found = withstood(name, scene, physics, gripper, Shake("z", 4.0, 60.0))
    assert limit - 4.0 * 1.5 <= found.acceleration <= limit + 4.0 * 0.5
    assert found.force == pytest.approx(MASS * found.acceleration)
    assert found.axis == "z" and found.direction == (0, 0, 1)
    assert found.slipped < 0  # downwards, with the weight
    assert f"along z both ways, slipped at {found.slipped:g} m/s²" in withstood_words(found)


def test_the_most_that_is_asked_for_ends_it(scene, physics, gripper):
    found = withstood("dart", scene, physics, gripper, Shake("z", 5.0, 10.0))
    assert found.acceleration == 10.0 and found.slipped is None
    assert withstood_words(found).endswith("the most that was asked for")


def test_the_shaking_is_on_the_recording_and_follows_the_gripper(scene, physics, gripper):
    turned = Grasp(LOW.position, 0.3, LOW.width)
    trial = GraspTrial(scene, gripper, physics, None, shake=Shake("y", 60.0, 60.0))
    attempt = trial.attempt(turned, 0, record=True)
    assert attempt.outcome is Outcome.SUCCESS and "withstood no shaking along y" in attempt.evidence.words
    found = attempt.evidence.withstood
    assert found.direction == pytest.approx((-math.sin(0.3), math.cos(0.3), 0.0), abs=1e-6)
    assert (found.acceleration, found.force) == (0, 0) and abs(found.slipped) == 60.0  # 30 N are more than 24 N
    film = attempt.recording
    assert [PHASES[phase] for phase in dict.fromkeys(film.phases.tolist())] == ["approach", "close", "lift", "shake"]
    shaken = film.poses[film.phases == PHASES.index("shake"), 0, :3]
    assert np.abs((shaken[-1] - shaken[0]) @ found.direction) > 0.004
    assert np.all(np.diff(film.times) > 0)


def test_without_a_shake_an_attempt_says_nothing_of_it(scene, physics, gripper):
    plain = GraspTrial(scene, gripper, physics, None, whole=True).attempt(LOW, 0)
    shaken = GraspTrial(scene, gripper, physics, None, shake=Shake("z", 2.0, 2.0)).attempt(LOW, 0)
    assert plain.evidence.withstood is None and shaken.evidence.withstood.acceleration == 2.0
    assert (plain.outcome, plain.comfort, plain.evidence.left) == (
        shaken.outcome,
        shaken.comfort,
        shaken.evidence.left,
    )
    again = GraspTrial(scene, gripper, physics, None, whole=True).attempt(LOW, 0)
    assert plain == again


def test_an_object_that_is_lost_as_the_base_stops_withstood_nothing(scene, physics, gripper):
    engine = ENGINES["dart"].build(scene, physics, gripper)
    engine.rewind([placed.world_from_object for placed in scene.objects])
    engine.grip(Grasp((0, 0.3, 0.03), 0.0, 0.1).world_from_gripper, (0.0, 0.0))
    engine.advance(5, 0.3)
    found = shake_held(engine, LOW, 0, Shake("x"))
    assert (found.acceleration, found.slipped) == (0, 0)
    assert withstood_words(found) == "withstood no shaking along x: lost as the lift ended"


def test_levels_grow_by_steps_to_the_most():
    assert Shake("x", 2.0, 6.0).levels == [2.0, 4.0, 6.0]
    assert Shake("x", 0.1, 0.3).levels == pytest.approx([0.1, 0.2, 0.3])
    assert Shake("x", 2.0, 7.0).levels == [2.0, 4.0, 6.0]
    for wrong in ((0.0, 1.0), (-1.0, 1.0), (2.0, 1.0), (1.0, math.inf)):
        with pytest.raises(ValueError, match=r"step|most"):
            Shake("x", *wrong)
