import pytest

from grasp_core import config
from grasp_core.errors import ConfigError
from grasp_core.gripper import load_gripper
from grasp_core.planning.variants import make_variant, needs_networks

GRIPPER = load_gripper()


def test_settings_are_changed_and_others_stay(make_runtime):
    runtime = make_runtime()
    planner = make_variant("cascade", {"threshold": 0.2, "pixels": 7}, gripper=GRIPPER, runtime=runtime)
    assert (planner.settings.threshold, planner.settings.pixels, planner.settings.angles) == (0.2, 7, 12)
    assert planner.runtime is runtime


def test_settings_of_other_planners_are_left_out():
    planner = make_variant("antipodal", {"threshold": 0.2, "candidates": 3}, gripper=GRIPPER)
    assert planner.settings.candidates == 3


@pytest.mark.parametrize("changes", [{"threshold": 2.0}, {"candidates": 0}, {"angles": "many"}])
def test_impossible_values_are_refused(make_runtime, changes):
    with pytest.raises(ConfigError, match=next(iter(changes))):
        make_variant("cascade", changes, gripper=GRIPPER, runtime=make_runtime())


@pytest.mark.parametrize("name", sorted(config.shipped("planners")))
def test_every_shipped_planner_can_be_varied(make_runtime, name):
    made = make_variant(name, {"candidates": 2}, gripper=GRIPPER, runtime=make_runtime())
    assert made.settings.candidates == 2
    assert needs_networks(name) == (name in {"cascade", "exhaustive"})


def test_unknown_planners_are_refused():
    with pytest.raises(ConfigError, match="wishful"):
        make_variant("wishful", {}, gripper=GRIPPER)
