import base64
import re
from dataclasses import replace

import cv2
import numpy as np
import pytest

from grasp_core.gripper import load_gripper
from workbench.inspector.image_view import data_url, depth_view, quality_view, rectangles, window


def test_pictures_survive_the_way_into_the_page():
    picture = np.arange(60, dtype=np.uint8).reshape(4, 5, 3)
    data = base64.b64decode(data_url(picture).split(",")[1])
    back = cv2.cvtColor(cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB)
    assert (back == picture).all()


def test_rectangles_stand_where_the_grasps_are(opened, bridge):
    svg = rectangles(opened, load_gripper(), bridge.onclick)
    shapes = re.findall(r'data-candidate="(\d+)".*?points="([^"]+)"', svg)
    assert [int(index) for index, _ in shapes] == [2, 1, 0], "the best is drawn last, on top"
    corners = np.array([[float(x) for x in pair.split(",")] for pair in shapes[-1][1].split()])
    best = opened.plan.candidates[0]
    assert corners.mean(axis=0) == pytest.approx([best.image.u + 0.5, best.image.v + 0.5], abs=0.06)
    sides = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    assert sides[0] == pytest.approx(best.image.width, abs=0.2)
    assert sides[1] == pytest.approx(best.image.width * 0.02 / 0.08, abs=0.2), "as long as the fingers are wide"


def test_the_window_holds_all_candidates_and_enough_around_them(opened):
    left, top, width, height = window(opened)
    assert 180 <= width <= 300 and width == height
    for candidate in opened.plan.candidates:
        assert left <= candidate.image.u <= left + width and top <= candidate.image.v <= top + height


def test_without_candidates_the_whole_canvas_is_shown(empty_scene):
    assert window(empty_scene) == (0, 0, 300, 300)


def test_the_views_say_what_they_show(opened, bridge):
    page = depth_view(opened, load_gripper(), bridge.onclick)
    assert 'data-view="depth"' in page and "0.640 m" in page and "0.700 m" in page
    page = quality_view(opened)
    assert 'data-view="quality"' in page and "gw-region" in page
    assert page.count("<circle") == 3
    assert "0.70</span>" in page, "the legend ends at the map's largest value"


def test_a_planner_without_a_map_says_so(opened, empty_scene):
    assert "no quality map" in quality_view(empty_scene)
    bare = replace(opened, plan=replace(opened.plan, region=None, sampled=np.zeros((0, 2))))
    assert "<circle" not in quality_view(bare)
