import numpy as np
import pytest

from grasp_core.config import convert
from grasp_core.errors import ConfigError
from grasp_core.gripper import load_gripper
from grasp_core.planning.baselines.random import RandomPlanner, RandomSettings

GRIPPER = load_gripper()


def test_grasps_are_on_the_thing_free_and_without_opinion(photo, make_box):
    plan = RandomPlanner(GRIPPER)(photo(make_box(0.05, 0.0, yaw=0.0)), rng=np.random.default_rng(3))
    assert 5 <= len(plan.candidates) <= 10 and {c.score for c in plan.candidates} == {0.5}
    for candidate in plan.candidates:
        x, y, _ = candidate.grasp.position
        assert abs(x - 0.05) < 0.08 and abs(y) < 0.035
    angles = [abs(c.grasp.angle) for c in plan.candidates if abs(c.grasp.position[0] - 0.05) < 0.04]
    assert min(angles) > 0.4  # along the box the fingers would stand on it
    assert plan.reason is None and plan.weights == ""


def test_seeds_decide(photo, make_box):
    image = photo(make_box(0, 0))
    one, same, other = (RandomPlanner(GRIPPER)(image, rng=np.random.default_rng(s)) for s in (0, 0, 1))
    assert one.candidates == same.candidates != other.candidates


def test_empty_plans_say_why(photo, make_box, rng):
    assert "no object" in RandomPlanner(GRIPPER)(photo(), rng=rng).reason
    slab = photo(make_box(0, 0, (0.3, 0.3, 0.05), 0.0))
    mask = np.zeros(slab.depth.shape, bool)
    mask[200:280, 280:360] = True
    plan = RandomPlanner(GRIPPER)(slab, mask=mask, rng=rng)
    assert plan.candidates == () and "all 256 drawn grasps" in plan.reason


def test_impossible_settings_are_refused():
    with pytest.raises(ConfigError, match="drawn"):
        convert({"drawn": 0}, RandomSettings, "random.yaml")
