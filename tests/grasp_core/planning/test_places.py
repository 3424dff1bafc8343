import numpy as np
import pytest

from grasp_core.errors import ImageError
from grasp_core.gripper import load_gripper
from grasp_core.planning.cascade import CascadePlanner
from grasp_core.planning.places import candidate_crops, score_place

GRIPPER = load_gripper()


@pytest.fixture
def planned(photo, make_box, make_runtime, rng):
    image = photo(make_box(0.03, 0.02))
    return image, CascadePlanner(make_runtime(), GRIPPER)(image, rng=rng)


def pixel(plan, x, y, z):
    u, v, _ = plan.canvas.camera.project(np.array([x, y, z]))
    return float(u), float(v)


def test_the_middle_of_a_box_is_best_across_its_long_side(planned, make_runtime):
    image, plan = planned
    found = score_place(image, plan.canvas.camera, *pixel(plan, 0.03, 0.02, 0.05), make_runtime(), GRIPPER, angles=36)
    assert found.height == pytest.approx(0.05, abs=0.002) and found.seen
    assert len(found.candidates) == len(found.reachable) == 36
    best = found.candidates[found.best]
    across = 0.4 + np.pi / 2  # the box is turned by 0.4 rad
    assert abs((best.grasp.angle - across + np.pi / 2) % np.pi - np.pi / 2) < np.radians(10)
    assert best.grasp.position[:2] == pytest.approx((0.03, 0.02), abs=0.003)
    assert not found.reachable.all(), "along the box the fingers would meet it"


def test_bare_table_is_scored_too(planned, make_runtime):
    image, plan = planned
    found = score_place(image, plan.canvas.camera, *pixel(plan, -0.12, -0.14, 0.0), make_runtime(), GRIPPER)
    assert abs(found.height) < 0.002 and found.reachable.all()


def test_a_place_that_cannot_be_reached_has_no_best(photo, make_box, make_runtime):
    image = photo(make_box(0.0, 0.0, size=(0.3, 0.3, 0.05), yaw=0.0))
    plan = CascadePlanner(make_runtime(), GRIPPER)(image, rng=np.random.default_rng(0))
    found = score_place(image, plan.canvas.camera, *pixel(plan, 0.0, 0.0, 0.05), make_runtime(), GRIPPER)
    assert found.best is None and not found.reachable.any()


@pytest.mark.parametrize("u", [-3, 1e6])
def test_pixels_outside_are_refused(planned, make_runtime, u):
    with pytest.raises(ImageError, match="outside of the canvas"):
        score_place(planned[0], planned[1].canvas.camera, u, 0, make_runtime(), GRIPPER)


def test_crops_of_candidates_are_those_that_were_scored(planned, make_runtime):
    _, plan = planned
    runtime = make_runtime()
    seen = candidate_crops(plan.canvas, plan.candidates, runtime.meta.crop, GRIPPER)
    assert seen.shape == (len(plan.candidates), 48, 48)
    assert runtime.scores(seen) == pytest.approx([candidate.score for candidate in plan.candidates], abs=0.03)
    assert candidate_crops(plan.canvas, (), runtime.meta.crop, GRIPPER).shape == (0, 48, 48)
