import base64
from dataclasses import replace

import cv2
import msgspec
import numpy as np
import pytest

from grasp_core.camera import Camera, DepthImage
from workbench import colours
from workbench.inspector import images
from workbench.inspector.orders import Choice, Place
from workbench.inspector.state import TrialState


def test_pictures_survive_the_way_into_a_data_url():
    picture = np.random.default_rng(0).integers(0, 255, (5, 7, 3)).astype(np.uint8)
    data = base64.b64decode(images.data_url(picture).partition(",")[2])
    assert np.array_equal(cv2.cvtColor(cv2.imdecode(np.frombuffer(data, np.uint8), 1), cv2.COLOR_BGR2RGB), picture)
    assert images.data_url(picture, quick=True).startswith("data:image/jpeg")


def test_everything_of_a_plan_is_on_its_canvas(shown, bridge):
    page = images.canvas(shown, 0, bridge)
    assert page.count("<image") == 2 and page.count("data-candidate") == 3 and "gw-region" in page
    assert "gw-sampled" not in page, "samples are off at first"
    bare = replace(shown, picture=replace(shown.picture, marks=frozenset({"samples"})))
    page = images.canvas(bare, 0, bridge)
    assert "data-candidate" not in page and page.count("<circle") == 2


def test_the_filter_and_the_threshold_of_the_list_hold_in_the_image(shown, bridge):
    assert images.rectangles(replace(shown, least=0.5), 0, bridge).count("data-candidate") == 2


def test_no_quality_map_no_overlay(shown, bridge, make_scene):
    assert images.canvas(replace(shown, scene=make_scene(quality=False)), 0, bridge).count("<image") == 1


def test_the_window_holds_all_that_stands_on_the_table(shown, one_plan):
    assert images.window(shown.scene.sight.plans[0]) == (0, 0, 300, 300)
    large = one_plan()
    k = msgspec.structs.replace(large.canvas.camera.intrinsics, width=900, height=700)
    depth = np.full((700, 900), 0.7, np.float32)
    depth[400:440, 500:620] = 0.65
    image = DepthImage.from_array(depth, Camera(k, large.canvas.camera.pose))
    left, top, width, height = images.window(replace(large, canvas=image))
    assert left < 500 and left + width > 620 and top < 400 and top + height > 440 and width == height < 400
    image.depth[:] = 0.7
    assert images.window(replace(large, canvas=image)) == (0, 0, 900, 700)


def test_candidates_take_the_colour_of_score_or_physics(shown, attempt):
    choice = Choice(0, 0)
    assert images.tint(shown, choice, 0.9) == colours.css(colours.score(0.9))
    physics = replace(shown, by_physics=True)
    assert images.tint(physics, choice, 0.9) == colours.css(colours.UNKNOWN)
    tried = physics.with_trial(choice, TrialState({0: attempt(0, "MISSED")}, complete=True))
    assert images.tint(tried, choice, 0.9) == colours.css(colours.score(0.0))


def test_the_range_of_the_depth_colours(shown):
    plan = shown.scene.sight.plans[0]
    assert images.depth_range(shown, plan) == pytest.approx((0.64, 0.7), abs=1e-3)
    half = replace(shown, picture=replace(shown.picture, near=0.5, far=1.0))
    assert images.depth_range(half, plan) == pytest.approx((0.67, 0.7), abs=1e-3)


def test_a_place_is_marked_with_its_best_axis(shown, bridge, scores):
    asked = replace(shown, place=Place(150.0, 140.0, 0.64, 0.7))
    assert "gw-place" in images.canvas(asked, 0, bridge) and "gw-axis" not in images.canvas(asked, 0, bridge)
    known = replace(shown, place=Place(150.0, 140.0, 0.64, 0.7, scores(150.0, 140.0)))
    assert "gw-axis" in images.canvas(known, 0, bridge)


def test_the_crop_shows_where_the_fingers_close():
    page = images.crop_picture(np.zeros((48, 48), np.float32), 1.4)
    assert page.count("<path") == 2 and "M6.9," in page and "M41.1," in page


def test_two_plans_have_two_canvases(shown, bridge, make_scene):
    setup = msgspec.structs.replace(shown.setup, beside="random")
    two = replace(shown, scene=make_scene(setup=setup), setup=setup)
    assert "select:1.0" in images.canvas(two, 1, bridge) and "select:0.0" in images.canvas(two, 0, bridge)
