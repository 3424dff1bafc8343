import cv2
import numpy as np
import pytest

from grasp_core.camera import Camera, DepthImage
from grasp_core.errors import ImageError
from grasp_core.gripper import load_gripper
from grasp_core.planning.cascade import CascadePlanner
from grasp_core.planning.picture import draw_plan, save_picture


@pytest.fixture
def planner(make_runtime):
    return CascadePlanner(make_runtime(), load_gripper())


def test_rectangles_are_drawn_where_the_grasps_are_in_the_colour_of_their_score(planner, photo, make_box, rng):
    image = photo(make_box(0.1, 0.05), tilt=0.2)
    plan = planner(image, rng=rng)
    picture = draw_plan(plan, image)
    assert picture.dtype == np.uint8 and picture.shape[1] == image.depth.shape[1] + plan.canvas.depth.shape[1]
    best = plan.candidates[0].image
    corners = best.rectangle(0.2 * best.width)
    u, v = np.rint((corners[1] + corners[2]) / 2).astype(int)  # the middle of a finger
    blue, green, red = picture[v, u].astype(int)
    assert green > 200 and blue < 120 and abs(red - 255 * min(1, 2 - 2 * plan.candidates[0].score)) < 60
    drawn = np.ptp(picture[:, :640].astype(int), axis=2) > 60
    rows, columns = np.nonzero(drawn[: image.depth.shape[0]])
    assert abs(np.median(columns) - best.u) < 60 and abs(np.median(rows) - best.v) < 60


def test_the_quality_map_is_clipped_for_display_only(planner, photo, make_box, rng):
    image = photo(make_box(0, 0))
    plan = planner(image, rng=rng)
    plan.quality_map[:] *= 5
    before = plan.quality_map.copy()
    draw_plan(plan, image)
    assert np.array_equal(plan.quality_map, before)


def test_empty_plans_and_images_without_a_table_can_be_drawn(planner, photo, rng):
    empty = photo()
    assert draw_plan(planner(empty, rng=rng), empty).shape[2] == 3
    noise = DepthImage.from_array(rng.uniform(0.3, 5, (480, 640)), Camera(empty.camera.intrinsics))
    assert draw_plan(planner(noise, rng=rng), noise).shape[1] == 1280


def test_pictures_are_written_or_refused(planner, photo, make_box, rng, tmp_path):
    image = photo(make_box(0, 0))
    plan = planner(image, rng=rng)
    save_picture(tmp_path / "plan.png", plan, image)
    assert np.array_equal(cv2.imread(str(tmp_path / "plan.png")), draw_plan(plan, image))
    for wrong in (tmp_path / "none" / "plan.png", tmp_path / "plan.unknown"):
        with pytest.raises(ImageError, match="cannot be written"):
            save_picture(wrong, plan, image)
