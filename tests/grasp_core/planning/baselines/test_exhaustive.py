import msgspec
import numpy as np
import pytest

from grasp_core.config import convert
from grasp_core.errors import ConfigError, MismatchError
from grasp_core.gripper import load_gripper
from grasp_core.planning.baselines.exhaustive import ExhaustivePlanner, ExhaustiveSettings
from grasp_core.planning.cascade import CascadePlanner

GRIPPER = load_gripper()
COARSE = ExhaustiveSettings(stride=8, angles=6)


def test_every_grasp_of_the_grid_is_scored_and_out_of_reach_is_worth_nothing(photo, make_box, make_runtime, rng):
    image = photo(make_box(0.03, 0.02))
    runtime = make_runtime()
    plan = ExhaustivePlanner(runtime, GRIPPER, COARSE)(image, rng=rng)
    assert sum(runtime.scored) == len(plan.scored) == 6 * len(plan.sampled)
    pruned = ExhaustivePlanner(make_runtime(), GRIPPER, msgspec.structs.replace(COARSE, prune=True))(image, rng=rng)
    assert len(pruned.scored) < len(plan.scored)
    assert [c for c in plan.scored if c.score > 0] == list(pruned.scored) and plan.candidates == pruned.candidates


def test_the_grid_covers_what_stands_above_the_table(photo, make_box, make_runtime, rng):
    settings = msgspec.structs.replace(COARSE, prune=True)
    plan = ExhaustivePlanner(make_runtime(), GRIPPER, settings)(photo(make_box(0.03, 0.02)), rng=rng)
    pixels = plan.sampled
    steps = np.unique(np.diff(np.unique(pixels[:, 0])))
    assert set(steps) == {8.0} and len(np.unique(pixels, axis=0)) == len(pixels)
    assert len(pixels) < len(plan.scored) <= 6 * len(pixels)
    scores = [candidate.score for candidate in plan.scored]
    assert scores == sorted(scores, reverse=True)


def test_it_finds_at_least_as_good_a_grasp_as_the_cascade(photo, make_box, make_runtime, rng):
    image = photo(make_box(0.03, 0.02))
    best = ExhaustivePlanner(make_runtime(), GRIPPER)(image, rng=rng).candidates[0].score
    assert best >= CascadePlanner(make_runtime(), GRIPPER)(image, rng=rng).candidates[0].score - 0.02


def test_candidates_are_distinct_and_above_t(photo, make_box, make_runtime, rng):
    plan = ExhaustivePlanner(make_runtime(), GRIPPER, COARSE)(photo(make_box(0, 0)), rng=rng)
    assert 2 <= len(plan.candidates) <= 10
    assert all(candidate.score >= 0.8 for candidate in plan.candidates)
    for i, a in enumerate(plan.candidates):
        for b in plan.candidates[:i]:
            near = np.linalg.norm(np.subtract(a.grasp.position, b.grasp.position)) < 0.01
            assert not near or abs(np.sin(a.grasp.angle - b.grasp.angle)) > np.sin(0.25)


def test_empty_plans_say_why(photo, make_box, make_runtime, rng):
    assert "no object" in ExhaustivePlanner(make_runtime(), GRIPPER, COARSE)(photo(), rng=rng).reason
    low = ExhaustivePlanner(make_runtime(factor=0.1), GRIPPER, COARSE)(photo(make_box(0, 0)), rng=rng)
    assert low.candidates == () and "below t = 0.5" in low.reason and low.scored
    slab = photo(make_box(0, 0, (0.3, 0.3, 0.05), 0.0))
    mask = np.zeros(slab.depth.shape, bool)
    mask[200:280, 280:360] = True
    blocked = ExhaustivePlanner(make_runtime(), GRIPPER, COARSE)(slab, mask=mask, rng=rng)
    assert blocked.candidates == () and "grasps of the grid" in blocked.reason


def test_a_budget_ends_the_search(photo, make_box, make_runtime, clock, rng):
    slow = make_runtime(delay=0.05, clock=clock)
    settings = ExhaustiveSettings(stride=3)
    plan = ExhaustivePlanner(slow, GRIPPER, settings)(photo(make_box(0, 0)), budget_ms=60, rng=rng)
    whole = ExhaustivePlanner(make_runtime(), GRIPPER, settings)(photo(make_box(0, 0)), rng=rng)
    assert 0 < len(plan.scored) < len(whole.scored)


def test_weights_of_another_gripper_are_refused(make_runtime):
    other = msgspec.structs.replace(GRIPPER, opening=0.08)
    with pytest.raises(MismatchError):
        ExhaustivePlanner(make_runtime(), other)


@pytest.mark.parametrize("wrong", [{"stride": 0}, {"angles": 0}, {"candidates": 0}, {"threshold": 1.5}])
def test_impossible_settings_are_refused(wrong):
    with pytest.raises(ConfigError, match=next(iter(wrong))):
        convert(wrong, ExhaustiveSettings, "exhaustive.yaml")
