import numpy as np
import pytest

from grasp_core.errors import GraspError
from grasp_core.grasp import Grasp
from grasp_core.simulation.crosscheck import ENGINES, Judge, agree, correlation, open_grasps
from grasp_core.simulation.evidence import Outcome
from grasp_core.simulation.precheck import Verdict
from grasp_core.simulation.trial import GraspTrial


@pytest.fixture(scope="module")
def scene(shapes):
    return shapes.alone(shapes.box(0.04, 0.10, 0.06))


@pytest.fixture(scope="module")
def grasps(scene, physics, gripper):
    return open_grasps(scene, gripper, physics, 20, seed=0)


def test_grasps_need_dynamics_and_follow_the_seed(scene, grasps, physics, gripper):
    trial = GraspTrial(scene, gripper, physics, None)
    assert len(grasps) == len(set(grasps)) == 20
    assert all(trial.check(grasp) is Verdict.OPEN for grasp in grasps)
    assert grasps == open_grasps(scene, gripper, physics, 20, seed=0)
    assert grasps != open_grasps(scene, gripper, physics, 20, seed=1)


@pytest.mark.parametrize("name", ["whole", "half", "fcl", "mujoco"])
def test_engines_agree_on_a_box(name, scene, grasps, physics, gripper):
    """A small part of the cross-check; `grasp-core crosscheck` runs all of it."""
    if name == "mujoco":
        pytest.importorskip("mujoco")
    dart, other = Judge("dart", scene, gripper, physics), Judge(name, scene, gripper, physics)
    found = agree([dart.verdict(g) for g in grasps], [other.verdict(g) for g in grasps])
    assert found.count == 20
    assert found.agreement >= 0.9 if name != "mujoco" else found.agreement >= 0.8


@pytest.fixture(scope="module")
def rims(shapes, physics, gripper):
    """A mug with walls of 3 mm, grasps on it, and DART's verdicts."""
    mug = shapes.alone(shapes.mug())
    chosen = open_grasps(mug, gripper, physics, 12, seed=0)
    judge = Judge("dart", mug, gripper, physics)
    return mug, chosen, [judge.verdict(grasp) for grasp in chosen]


@pytest.mark.parametrize("name", ["half", "mujoco"])
def test_engines_agree_on_thin_walls(name, rims, physics, gripper):
    """Of 60 such grasps half the time step agrees on 60 and MuJoCo on 58; of these few one or two may differ."""
    if name == "mujoco":
        pytest.importorskip("mujoco")
    mug, chosen, verdicts = rims
    assert {Outcome.SUCCESS, Outcome.MISSED} <= set(verdicts)
    other = Judge(name, mug, gripper, physics)
    assert agree(verdicts, [other.verdict(grasp) for grasp in chosen]).agreement >= 0.8


def test_judge_uses_the_height_map_first(scene, physics, gripper):
    judge = Judge("dart", scene, gripper, physics)
    assert judge.verdict(Grasp((0.04, 0, 0.03), 0.0, 0.1)) is Outcome.COLLISION
    assert judge.verdict(Grasp((0, 0.3, 0.03), 0.0, 0.1)) is Outcome.MISSED


def test_judge_records_the_whole_lift(scene, physics, gripper):
    film = Judge("dart", scene, gripper, physics).record(Grasp((0, 0, 0.03), 0.0, 0.1))
    assert film.outcome == "SUCCESS"
    assert film.poses[-1, 0, 2] - film.poses[0, 0, 2] > 0.28
    assert len(film.names) == 5


def test_unknown_engines_are_refused(scene, physics, gripper):
    with pytest.raises(GraspError, match=r"choose from: dart, whole"):
        Judge("bullet", scene, gripper, physics)
    assert ENGINES["mujoco"].goal == 0.90


def test_agreement_and_kappa_by_hand():
    first = ["SUCCESS"] * 4 + ["SLIPPED"] * 4 + ["MISSED"] * 2
    second = ["SUCCESS"] * 3 + ["SLIPPED"] * 4 + ["MISSED"] * 3
    found = agree(first, second)
    assert found.agreement == 0.9
    chance = 0.4 * 0.3 + 0.6 * 0.7
    assert found.kappa == pytest.approx((0.9 - chance) / (1 - chance), abs=1e-4)
    assert found.outcomes == 0.8
    assert found.confusion == {"MISSED→MISSED": 2, "SLIPPED→MISSED": 1, "SLIPPED→SLIPPED": 3, "SUCCESS→SLIPPED": 1} | {
        "SUCCESS→SUCCESS": 3
    }
    assert agree(["SLIPPED"], ["MISSED"]).kappa == 1.0
    with pytest.raises(GraspError, match="same grasps"):
        agree(["SUCCESS"], [])


def test_correlation():
    a = np.array([0.0, 0.5, 1.0, 0.2])
    assert correlation(a, a) == pytest.approx(1)
    assert correlation(a, 1 - a) == pytest.approx(-1)
    assert correlation([1, 1], [1, 1]) == 1.0
    assert correlation([1, 1], [0.5, 1]) == 0.0
