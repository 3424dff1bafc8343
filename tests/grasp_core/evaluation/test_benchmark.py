import dataclasses

import pytest

from grasp_core.camera import load_camera, look_down
from grasp_core.errors import GraspError
from grasp_core.evaluation.benchmark import Benchmark
from grasp_core.gripper import load_gripper
from grasp_core.sensing.noise import ImageNoise
from grasp_core.simulation.physics import load_physics
from grasp_core.simulation.trial import GraspNoise

BASE = Benchmark("catalogue", ("random",), load_camera("primesense"), load_gripper(), load_physics())


@pytest.mark.parametrize("wrong", [{"poses": 0}, {"draws": 0}, {"attempts": 0}, {"limit": 0}, {"planners": ()}])
def test_impossible_settings_are_refused_by_their_option(wrong):
    with pytest.raises(GraspError, match="planner" if "planners" in wrong else f"--{next(iter(wrong))}"):
        dataclasses.replace(BASE, **wrong)


@pytest.mark.parametrize(
    "change",
    [
        {"objects": "smoke"},
        {"scale": "paper"},
        {"seed": 1},
        {"attempts": 3},
        {"weights": "other"},
        {"camera": load_camera("kinect")},
        {"camera": load_camera("primesense").at(look_down(0.8))},
        {"image_noise": ImageNoise(sigma_d=0.002)},
        {"grasp_noise": GraspNoise(sigma_p=0.0)},
    ],
)
def test_what_changes_the_outcomes_is_another_run(change):
    assert dataclasses.replace(BASE, **change).run({}) != BASE.run({})


@pytest.mark.parametrize("change", [{"poses": 3}, {"draws": 2}, {"limit": 5}, {"planners": ("random", "oracle")}])
def test_more_scenes_or_planners_go_on_with_the_same_run(change):
    assert dataclasses.replace(BASE, **change).run({}) == BASE.run({})


def test_a_camera_without_pose_is_the_one_that_looks_straight_down():
    posed = dataclasses.replace(BASE, camera=load_camera("primesense").at(look_down(0.7)))
    assert posed.run({}) == BASE.run({})


def test_planners_of_other_settings_or_weights_are_another_run():
    assert BASE.run({"cascade": "a"}) == BASE.run({"cascade": "a"}) != BASE.run({"cascade": "b"})
