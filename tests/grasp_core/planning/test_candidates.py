import math

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grasp_core.camera import Camera, CameraIntrinsics, look_down
from grasp_core.grasp import Grasp, angle_distance, to_image
from grasp_core.gripper import load_gripper
from grasp_core.planning.candidates import (
    Batch,
    PoseNoise,
    best_region,
    distinct,
    image_grasps,
    make_batch,
    reach_share,
    reachable,
    sample_pixels,
    spread_angles,
    to_candidates,
)
from grasp_core.planning.view import ViewSettings, look

GRIPPER = load_gripper()


def pixel(view, x, y, z):
    """Window pixel of a world point."""
    return view.camera.project([x, y, z])[:2]


def test_the_region_lies_around_the_hottest_place():
    heat = np.zeros((50, 60), np.float32)
    heat[10, 20], heat[30, 40] = 2.0, 1.0
    places = np.ones(heat.shape, bool)
    places[10, 20] = False
    u, v, region = best_region(heat, places, 5.0)
    assert (u, v) == (40, 30)
    y, x = np.nonzero(region)
    assert np.hypot(x - 40, y - 30).max() <= 5 and len(x) == 81
    assert best_region(heat, np.zeros_like(places), 5.0) is None
    corner = np.zeros_like(heat)
    corner[0, 0] = 1
    assert best_region(corner, places, 5.0)[2].sum() == 26


def test_pixels_are_drawn_once_each_and_mostly_where_it_is_hot(rng):
    heat = np.zeros((20, 20), np.float32)
    heat[:, 10:] = 1.0
    heat[:, :5] = -3.0
    region = np.ones(heat.shape, bool)
    region[0] = False
    u, v = sample_pixels(heat, region, 100, rng)
    assert len({*zip(u, v, strict=True)}) == 100 and v.min() >= 1
    assert (u >= 10).mean() > 0.8
    u, v = sample_pixels(heat, region, 1000, rng)
    assert len(u) == 380
    u, _ = sample_pixels(np.zeros_like(heat), region, 10, rng)
    assert len(u) == 10


def test_angles_of_a_pixel_are_evenly_spread(rng):
    angles = spread_angles(5, 12, rng)
    assert angles.shape == (5, 12) and angles.min() >= -math.pi / 2 and angles.max() < math.pi / 2
    assert np.allclose(np.diff(np.sort(angles, axis=1)), math.pi / 12)
    assert not np.allclose(np.sort(angles[0]), np.sort(angles[1]))


@pytest.mark.parametrize("yaw", [0.0, 1.1])
@pytest.mark.parametrize("tilt", [0.0, 0.4])
def test_the_gripper_reaches_across_a_long_box_but_not_along_it(photo, make_box, yaw, tilt):
    image = photo(make_box(0.1, -0.05, (0.14, 0.05, 0.05), 0.4), yaw=yaw, tilt=tilt)
    _, view = look(image, None, ViewSettings())
    u, v = pixel(view, 0.1, -0.05, 0.05)
    angles = 0.4 - yaw + np.array([math.pi / 2, 0.0])
    batch = make_batch(view, [u, u], [v, v], angles)
    assert np.allclose(batch.position, [0.1, -0.05, 0.02], atol=0.003)
    assert reachable(batch, view, GRIPPER).tolist() == [True, False]
    across = to_candidates(batch[:1], np.array([0.5]), np.array([0.1]), view, GRIPPER)[0]
    assert angle_distance(across.grasp.angle, 0.4 + math.pi / 2) < 1e-6
    expected = to_image(across.grasp, view.rectified.camera)
    assert msgspec.structs.astuple(across.image) == pytest.approx(msgspec.structs.astuple(expected))
    assert (across.score, across.heat, across.grasp.width) == (0.5, 0.1, 0.10)


def test_tight_places_are_seldom_free_when_the_robot_strays(photo, make_box):
    shares = []
    for width in (0.03, 0.09, 0.093):
        _, view = look(photo(make_box(0.0, 0.0, (0.14, width, 0.05), 0.0)), None, ViewSettings())
        u, v = pixel(view, 0, 0, 0.05)
        batch = make_batch(view, [u, u], [v, v], [math.pi / 2] * 2)
        assert reachable(batch, view, GRIPPER).all()
        share = reach_share(batch, view, GRIPPER, PoseNoise())
        assert share[0] == share[1], "the same draws serve all grasps"
        assert (reach_share(batch, view, GRIPPER, PoseNoise(draws=0)) == 1).all()
        assert (reach_share(batch, view, GRIPPER, PoseNoise(sigma_p=0, sigma_phi=0)) == 1).all()
        assert reach_share(batch[:0], view, GRIPPER, PoseNoise()).shape == (0,)
        shares.append(float(share[0]))
    assert shares[0] == 1 and shares[0] > shares[1] > shares[2] > 0


@pytest.mark.parametrize("wrong", [{"sigma_p": -1.0}, {"sigma_phi": -1.0}, {"draws": -1}])
def test_impossible_pose_noise_is_refused(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        PoseNoise(**wrong)


def test_what_is_hidden_may_be_in_the_way(photo, make_box):
    # A tilted camera does not see the place of the finger behind a tall wall.
    wall = make_box(0.0, 0.0, (0.10, 0.04, 0.10), 0.0)
    free = []
    for tilt in (0.0, 0.3, 0.7):
        _, view = look(photo(wall, tilt=tilt), None, ViewSettings())
        u, v = pixel(view, 0.0, 0.0, 0.10)
        batch = make_batch(view, [u], [v], [math.pi / 2])
        batch.depth[:] = 0.70 - 0.055  # tips 4.5 cm below the top of the wall
        assert (view.depth < 0.62).any()
        free.append(bool(reachable(batch, view, GRIPPER)[0]))
    assert free == [True, True, False]


def test_a_tall_neighbour_stops_the_rod(photo, make_box):
    low = make_box(0.0, 0.0, (0.03, 0.03, 0.06), 0.0)
    tall = make_box(0.052, 0.03, (0.02, 0.02, 0.14), 0.0)  # beside the finger, under the end of the rod
    _, view = look(photo(low), None, ViewSettings())
    u, v = pixel(view, 0, 0, 0.06)
    assert reachable(make_batch(view, [u], [v], [0.0]), view, GRIPPER).all()
    narrow = make_box(0.03, 0.0, (0.008, 0.008, 0.13), 0.0)  # between the fingers, taller than they are long
    _, view = look(photo(low, narrow), None, ViewSettings())
    assert not reachable(make_batch(view, [u], [v], [0.0]), view, GRIPPER).any()
    _, view = look(photo(low, tall), None, ViewSettings())
    u, v = pixel(view, 0, 0, 0.06)
    assert reachable(make_batch(view, [u, u], [v, v], [0.0, 0.55]), view, GRIPPER).tolist() == [True, False]


@pytest.mark.parametrize("turn", np.linspace(-1.5, 1.5, 7).tolist())
def test_a_thin_mast_stops_the_rod_wherever_it_stands_under_it(photo, make_box, turn):
    low = make_box(0.0, 0.0, (0.03, 0.03, 0.05), 0.0)
    for along in np.linspace(-0.045, 0.045, 13).tolist():
        for across in (-0.0065, 0.002, 0.006):
            x = along * math.cos(turn) - across * math.sin(turn)
            y = along * math.sin(turn) + across * math.cos(turn)
            _, view = look(photo(low, make_box(x, y, (0.004, 0.004, 0.11), 0.0)), None, ViewSettings())
            batch = make_batch(view, *(np.atleast_1d(n) for n in pixel(view, 0, 0, 0.05)), [turn])
            batch.depth[:] = 0.70 - 0.03
            assert not reachable(batch, view, GRIPPER).any(), (along, across)


def test_what_is_taller_than_fingers_and_rod_stops_the_base(photo, make_box):
    low, tall = make_box(0.0, 0.0, (0.03, 0.03, 0.05), 0.0), make_box(0.0, 0.016, (0.006, 0.006, 0.13), 0.0)
    free = []
    for scene in ((low,), (low, tall)):
        _, view = look(photo(*scene), None, ViewSettings())
        batch = make_batch(view, *(np.atleast_1d(n) for n in pixel(view, 0, 0, 0.05)), [0.0])
        batch.depth[:] = 0.70 - 0.03
        free.append(bool(reachable(batch, view, GRIPPER)[0]))
    assert free == [True, False]


def test_distinct_candidates_differ_in_place_or_angle():
    x = np.array([0.0, 0.004, 0.004, 0.03, 0.0])
    angle = np.array([0.0, 0.1, 0.8, 0.0, math.pi - 0.05])
    batch = Batch(x, x, angle, x, np.stack([x, x * 0, x * 0], axis=1))
    assert distinct(batch.position, batch.angle, np.arange(5), 0.01, 0.26, 9).tolist() == [0, 2, 3]
    assert distinct(batch.position, batch.angle, np.array([4, 3, 2, 1, 0]), 0.01, 0.26, 2).tolist() == [4, 3]
    assert distinct(batch.position, batch.angle, np.zeros(0, np.intp), 0.01, 0.26, 2).tolist() == []


@settings(max_examples=50, deadline=None)
@given(
    st.floats(0.4, 1.2),
    st.floats(0, 0.9),
    st.lists(
        st.tuples(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2), st.floats(0, 0.2), st.floats(-1.5, 1.5)), min_size=1
    ),
)
def test_image_grasps_of_a_batch_are_those_of_each_grasp(height, tilt, rows):
    intrinsics = CameraIntrinsics(500, 510, 320, 240, 640, 480, (0.05, -0.02, 0.001, 0.001, 0.0))
    camera = Camera(intrinsics, look_down(height, tilt=tilt))
    table = np.array(rows)
    many = image_grasps(table[:, :3], table[:, 3], 0.08, camera)
    for seen, (x, y, z, angle) in zip(many, rows, strict=True):
        one = to_image(Grasp((x, y, z), angle, 0.08), camera)
        assert (seen.u, seen.v, seen.width, seen.depth) == pytest.approx((one.u, one.v, one.width, one.depth))
        assert angle_distance(seen.angle, one.angle) < 1e-9


def test_batches_join_in_order():
    parts = [Batch(*(np.full(n, float(n)) for _ in range(4)), np.full((n, 3), float(n))) for n in (1, 2)]
    joined = Batch.join(parts)
    assert joined.u.tolist() == [1, 2, 2] and joined.position.shape == (3, 3) and len(joined) == 3
