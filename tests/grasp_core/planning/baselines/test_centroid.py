import math

import numpy as np
import pytest

from grasp_core.config import convert
from grasp_core.errors import ConfigError
from grasp_core.grasp import angle_distance
from grasp_core.gripper import load_gripper
from grasp_core.planning.baselines.centroid import CentroidPlanner, CentroidSettings

GRIPPER = load_gripper()


@pytest.mark.parametrize("yaw, view_yaw, tilt", [(0.3, 0.0, 0.0), (-1.2, 0.9, 0.3)])
def test_the_grasp_is_central_and_across(photo, make_box, rng, yaw, view_yaw, tilt):
    plan = CentroidPlanner(GRIPPER)(photo(make_box(0.04, 0.02, yaw=yaw), yaw=view_yaw, tilt=tilt), rng=rng)
    (best,) = plan.candidates  # along the box the fingers would stand on it
    assert np.allclose(best.grasp.position, [0.04, 0.02, 0.02], atol=0.008)
    assert angle_distance(best.grasp.angle, yaw + math.pi / 2) < 0.08
    assert best.score == 1.0


def test_larger_things_come_first_and_short_ones_have_two_axes(photo, make_box, rng):
    image = photo(make_box(-0.1, 0.0, (0.04, 0.03, 0.05)), make_box(0.1, 0.0, (0.08, 0.06, 0.05)))
    plan = CentroidPlanner(GRIPPER)(image, rng=rng)
    assert [round(c.grasp.position[0], 1) for c in plan.candidates] == [0.1, 0.1, -0.1, -0.1]
    scores = [c.score for c in plan.candidates]
    assert (
        scores[1] == pytest.approx(scores[0] / 2)
        and scores[0] + scores[2] == pytest.approx(1)
        and scores[1] > scores[2]
    )
    few = CentroidPlanner(GRIPPER, CentroidSettings(candidates=1))(image, rng=rng)
    assert len(few.candidates) == 1


def test_empty_plans_say_why(photo, make_box, rng):
    assert "no object" in CentroidPlanner(GRIPPER)(photo(), rng=rng).reason
    slab = CentroidPlanner(GRIPPER)(photo(make_box(0, 0, (0.25, 0.2, 0.05))), rng=rng)
    assert slab.candidates == () and "centroids" in slab.reason


def test_impossible_settings_are_refused():
    with pytest.raises(ConfigError, match="candidates"):
        convert({"candidates": 0}, CentroidSettings, "centroid.yaml")
