import math
import os
from pathlib import Path

import msgspec
import numpy as np
import pytest

from grasp_core.camera import Camera, DepthImage, load_camera
from grasp_core.config import convert
from grasp_core.errors import ConfigError, ImageError, MismatchError
from grasp_core.grasp import angle_distance, to_image
from grasp_core.gripper import load_gripper
from grasp_core.planning.cascade import CascadePlanner, CascadeSettings
from grasp_core.sensing.preprocess import read_depth

GRIPPER = load_gripper()


@pytest.fixture
def planner(make_runtime):
    return CascadePlanner(make_runtime(), GRIPPER)


def settings(**changes) -> CascadeSettings:
    return msgspec.structs.replace(CascadeSettings(), **changes)


@pytest.mark.parametrize("tilt, yaw, height", [(0.0, 0.0, 0.7), (0.4, 0.0, 0.8), (0.25, 2.0, 0.6), (0.0, -1.0, 1.0)])
def test_the_best_grasp_closes_across_the_box_in_the_world_of_the_camera_file(
    planner, photo, make_box, rng, tilt, yaw, height
):
    image = photo(make_box(0.06, -0.04, yaw=0.7), tilt=tilt, yaw=yaw, height=height)
    plan = planner(image, rng=rng)
    best = plan.candidates[0]
    along = np.array([math.cos(0.7), math.sin(0.7)])
    offset = np.array(best.grasp.position[:2]) - [0.06, -0.04]
    assert abs(offset @ along) < 0.07 and abs(offset @ [-along[1], along[0]]) < 0.025
    assert best.grasp.position[2] == pytest.approx(0.02, abs=0.004)
    assert angle_distance(best.grasp.angle, 0.7 + math.pi / 2) < 0.6
    assert best.grasp.width == GRIPPER.opening
    for candidate in plan.scored:
        expected = msgspec.structs.astuple(to_image(candidate.grasp, image.camera))
        assert msgspec.structs.astuple(candidate.image) == pytest.approx(expected)
    assert plan.camera == image.camera and plan.reason is None and plan.weights == "fake 0123"


def test_without_a_pose_grasps_are_in_the_world_under_the_camera(planner, photo, make_box, rng):
    image = photo(make_box(0.0, 0.1), tilt=0.3, height=0.8)
    plan = planner(image.with_camera(Camera(image.camera.intrinsics)), rng=rng)
    shift = 0.8 * math.tan(0.3)
    for candidate in plan.candidates:
        assert math.hypot(candidate.grasp.position[0], candidate.grasp.position[1] - 0.1 - shift) < 0.08
    assert plan.camera.pose[2, 3] == pytest.approx(0.8, abs=0.002)


def test_candidates_are_sorted_distinct_above_t_and_among_the_scored(planner, photo, make_box, rng):
    plan = planner(photo(make_box(0, 0)), rng=rng)
    scores = [candidate.score for candidate in plan.candidates]
    assert 2 <= len(scores) <= 10 and scores == sorted(scores, reverse=True) and min(scores) >= 0.8
    assert [c.score for c in plan.scored] == sorted((c.score for c in plan.scored), reverse=True)
    assert set(map(id, plan.candidates)) <= set(map(id, plan.scored)) and 64 < len(plan.scored) <= 128
    for i, one in enumerate(plan.candidates):
        for other in plan.candidates[:i]:
            apart = np.linalg.norm(np.subtract(one.grasp.position, other.grasp.position))
            assert apart >= 0.01 or angle_distance(one.grasp.angle, other.grasp.angle) >= 0.26


def test_what_was_looked_at_lies_on_the_canvas(planner, photo, make_box, rng):
    plan = planner(photo(make_box(0.1, 0.05)), rng=rng)
    u, v, radius = plan.region
    assert radius == pytest.approx(25)
    assert np.hypot(*(plan.sampled - [u, v]).T).max() <= radius
    assert plan.quality_map.shape == plan.canvas.depth.shape == (480, 640)
    assert plan.quality_map.argmax() == round(v) * 640 + round(u)
    assert (plan.canvas.depth[tuple(plan.sampled.astype(int).T[::-1])] < 0.66).all()
    assert list(plan.stages_ms) == ["rectify", "quality map", "candidates", "crops", "scores", "clearance", "output"]
    assert plan.total_ms == pytest.approx(sum(plan.stages_ms.values())) and plan.missing == 0


def test_the_same_generator_state_gives_the_same_plan(planner, photo, make_box):
    image = photo(make_box(0, 0))
    one, two, other = (planner(image, rng=np.random.default_rng(seed)) for seed in (0, 0, 1))
    assert one.candidates == two.candidates and one.candidates != other.candidates


def test_the_fingers_of_every_scored_grasp_are_free(planner, photo, make_box, rng):
    image = photo(make_box(0.0, 0.0, (0.14, 0.05, 0.05), 0.0), make_box(0.0, 0.075, (0.14, 0.03, 0.05), 0.0))
    plan = planner(image, rng=rng)
    for candidate in plan.scored:
        x, y, z = candidate.grasp.position
        for side in (-1, 1):
            finger = np.array([x, y]) + side * 0.055 * candidate.grasp.closing_axis[:2]
            inside = abs(finger[0]) < 0.066 and (abs(finger[1]) < 0.021 or abs(finger[1] - 0.075) < 0.011)
            assert not (inside and z < 0.045)


def test_the_next_region_is_tried_when_the_best_yields_nothing(make_runtime, photo, make_box, rng):
    # a slab too wide for the gripper is hotter, a bar beside it can be grasped
    image = photo(make_box(-0.1, 0.0, (0.11, 0.11, 0.05), 0.0), make_box(0.1, 0.0, (0.1, 0.02, 0.03), 1.5))
    planner = CascadePlanner(make_runtime(), GRIPPER, settings(regions=30, paired=0))
    plan = planner(image, rng=rng)
    assert plan.candidates and plan.candidates[0].grasp.position[0] > 0.05
    assert len(plan.sampled) > 64
    one = CascadePlanner(make_runtime(), GRIPPER, settings(regions=1, paired=0))(image, rng=rng)
    assert not one.candidates and one.reason.startswith("all ")


def test_a_small_place_to_grip_on_what_is_too_big_is_found_by_its_edges(make_runtime, photo, make_box):
    image = photo(make_box(0, 0, (0.17, 0.17, 0.03), 0.0), make_box(0.05, 0.05, (0.015, 0.015, 0.07), 0.0))
    without, with_pairs = (
        CascadePlanner(make_runtime(), GRIPPER, settings(regions=1, paired=paired))(image, rng=np.random.default_rng(3))
        for paired in (0, 64)
    )
    assert not without.candidates and with_pairs.candidates
    assert with_pairs.candidates[0].grasp.position[:2] == pytest.approx((0.05, 0.05), abs=0.012)


def test_an_empty_plan_says_why(make_runtime, photo, make_box, rng):
    planner = CascadePlanner(make_runtime(factor=0.3), GRIPPER)
    plan = planner(photo(make_box(0, 0)), rng=rng)
    assert plan.candidates == () and plan.scored
    assert plan.reason.startswith(f"all {len(plan.scored)} scored grasps are below t = 0.5; the best has 0.")
    plan = planner(photo(), rng=rng)
    assert plan.reason.startswith("no object above the table") and plan.region is None and plan.sampled.shape == (0, 2)
    noise = DepthImage.from_array(rng.uniform(0.3, 5, (480, 640)), Camera(photo().camera.intrinsics))
    plan = planner(noise, rng=rng)
    assert plan.reason.startswith("image invalid: no table plane") and plan.camera.world_from_camera is None
    assert plan.canvas is noise and plan.quality_map.shape == (480, 640)


def test_a_mask_limits_where_to_grasp(planner, photo, make_box, rng):
    image = photo(make_box(-0.1, 0.0), make_box(0.1, 0.0), tilt=0.2)
    for side in (slice(0, 320), slice(320, 640)):
        mask = np.zeros(image.depth.shape, bool)
        mask[:, side] = True
        plan = planner(image, mask=mask, rng=rng)
        for candidate in plan.scored:
            assert side.start - 12 <= candidate.image.u < side.stop + 12
    for wrong in (np.ones((10, 10), bool), np.ones((480, 640))):
        with pytest.raises(ImageError, match="mask"):
            planner(image, mask=wrong, rng=rng)


def test_a_budget_returns_the_best_found_in_time(make_runtime, clock, photo, make_box, rng):
    runtime = make_runtime(delay=0.05, clock=clock)
    planner = CascadePlanner(runtime, GRIPPER, settings(regions=1, polished=0))
    image = photo(make_box(0, 0))
    planner(image, rng=rng)
    assert runtime.scored == [64]
    for budget, batches in ((101, 1), (151, 2), (60_000, 4)):
        runtime.scored.clear()
        plan = planner(image, budget_ms=budget, rng=rng)
        assert runtime.scored == [16] * batches and len(plan.scored) == 16 * batches
        assert plan.candidates and plan.total_ms <= budget


def test_a_plan_that_runs_out_of_time_says_so(make_runtime, clock, photo, make_box, rng):
    runtime = make_runtime(delay=0.05, clock=clock)
    plan = CascadePlanner(runtime, GRIPPER)(photo(make_box(0, 0)), budget_ms=40, rng=rng)
    assert plan.candidates == () and runtime.scored == []
    assert plan.reason == "the time was over before any grasp was scored"


def test_a_small_thing_is_sampled_again_when_its_only_region_yields_nothing(make_runtime, photo, make_box, rng):
    image = photo(make_box(0.0, 0.0, (0.03, 0.03, 0.04)))
    runtime = make_runtime(factor=0.3)
    plan = CascadePlanner(runtime, GRIPPER, settings(regions=3, polished=0, paired=0))(image, rng=rng)
    assert runtime.scored == [64, 64, 64] and len({c.grasp for c in plan.scored}) > 100
    assert plan.reason.startswith("all 192 scored grasps are below t")


def test_grasps_around_the_best_ones_are_judged_too(make_runtime, photo, make_box):
    image = photo(make_box(0, 0, (0.14, 0.05, 0.05), 0.4))
    better, near = [], []
    for seed in range(6):
        plain, polished = (
            CascadePlanner(make_runtime(), GRIPPER, settings(polished=count))(image, rng=np.random.default_rng(seed))
            for count in (0, 64)
        )
        old, new = {c.grasp for c in plain.scored}, polished.scored
        added = [c for c in new if c.grasp not in old]
        assert len(plain.scored) == 64 and len(added) == 64 and len(polished.scored) == 128
        best = [np.array(c.grasp.position[:2]) for c in plain.scored[:8]]
        near += [min(np.linalg.norm(np.array(c.grasp.position[:2]) - p) for p in best) for c in added]
        assert polished.candidates[0].score >= plain.candidates[0].score
        better.append(np.mean([c.score for c in added]) - np.mean([c.score for c in plain.scored]))
    assert min(better) > 0.05
    assert np.median(near) < 0.008
    with pytest.raises(ConfigError, match="polished"):
        convert({"polished": -1}, CascadeSettings, "x")


def test_further_regions_are_tried_until_there_are_enough_candidates(make_runtime, photo, make_box, rng):
    image = photo(make_box(-0.1, 0.0), make_box(0.1, 0.0))
    few, many = (
        CascadePlanner(
            make_runtime(), GRIPPER, settings(threshold=0.6, enough=enough, candidates=30, regions=6, polished=0)
        )(image, rng=np.random.default_rng(0))
        for enough in (1, 15)
    )
    assert len(few.candidates) < 15 <= len(many.candidates)
    assert len(many.scored) > len(few.scored) == 64


def test_missing_pixels_are_filled_and_their_share_reported(planner, photo, make_box, rng):
    image = photo(make_box(0, 0))
    depth = image.depth.copy()
    depth[rng.random(depth.shape) < 0.2] = np.nan
    plan = planner(DepthImage.from_array(depth, image.camera), rng=rng)
    assert plan.missing == pytest.approx(0.2, abs=0.01) and plan.candidates


def test_weights_of_another_gripper_are_refused(make_runtime):
    other = msgspec.structs.replace(GRIPPER, opening=0.08)
    with pytest.raises(MismatchError, match="gripper"):
        CascadePlanner(make_runtime(other), GRIPPER)


@pytest.mark.parametrize("key, value", [("pixels", 0), ("threshold", 1.2), ("radius", 0.0), ("unknown", 1)])
def test_impossible_settings_are_refused(key, value):
    with pytest.raises(ConfigError, match=key):
        convert({key: value}, CascadeSettings, "cascade.yaml")


@pytest.mark.skipif("GRASP_TEST_DATA" not in os.environ, reason="GRASP_TEST_DATA names no folder of real files")
@pytest.mark.parametrize("name", ["clutter_0", "depth_0", "depth_1", "depth_2", "depth_3", "depth_4"])
def test_grasps_on_real_images_lie_on_objects_and_not_on_the_robot(make_runtime, name, rng):
    image = read_depth(Path(os.environ["GRASP_TEST_DATA"]) / "primesense" / f"{name}.npy", load_camera("primesense"))
    plan = CascadePlanner(make_runtime(), GRIPPER, settings(threshold=0.5))(image, rng=rng)
    assert plan.candidates
    for candidate in plan.candidates:
        assert 230 < candidate.image.u < 480 and 100 < candidate.image.v < 340
        assert candidate.grasp.position[2] >= 0.008 - 1e-9
