import math

import numpy as np
import pytest

from grasp_core.config import convert
from grasp_core.errors import ConfigError
from grasp_core.grasp import angle_distance
from grasp_core.gripper import load_gripper
from grasp_core.planning.baselines.antipodal import AntipodalPlanner, AntipodalSettings
from grasp_core.sensing.noise import ImageNoise, add_noise

GRIPPER = load_gripper()


@pytest.mark.parametrize("noisy", [False, True])
def test_grasps_close_squarely_across_a_box(photo, make_box, rng, noisy):
    image = photo(make_box(0.04, 0.02, yaw=0.5))
    if noisy:
        image = add_noise(image, ImageNoise(), rng)
    plan = AntipodalPlanner(GRIPPER)(image, rng=rng)
    assert len(plan.candidates) >= 4
    across = np.array([-math.sin(0.5), math.cos(0.5)])
    for candidate in plan.candidates:
        assert angle_distance(candidate.grasp.angle, 0.5 + math.pi / 2) < 0.35
        assert abs((np.array(candidate.grasp.position[:2]) - [0.04, 0.02]) @ across) < 0.008
    scores = [c.score for c in plan.candidates]
    assert scores == sorted(scores, reverse=True) and 0.9 < scores[0] <= 1


def test_what_is_wider_than_the_opening_has_no_pair(photo, make_box, rng):
    plan = AntipodalPlanner(GRIPPER)(photo(make_box(0, 0, (0.14, 0.12, 0.05), 0.0)), rng=rng)
    assert plan.candidates == () and ("no two depth edges" in plan.reason or "fingers or rod" in plan.reason)
    assert "no object" in AntipodalPlanner(GRIPPER)(photo(), rng=rng).reason


def test_seeds_decide_which_edges_are_paired(photo, make_box):
    image = photo(make_box(0, 0))
    planner = AntipodalPlanner(GRIPPER, AntipodalSettings(edges=60))
    one, same, other = (planner(image, rng=np.random.default_rng(s)) for s in (0, 0, 1))
    assert one.candidates == same.candidates != other.candidates


def test_impossible_settings_are_refused():
    with pytest.raises(ConfigError, match="friction"):
        convert({"friction": 0.0}, AntipodalSettings, "antipodal.yaml")
