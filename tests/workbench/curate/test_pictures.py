import base64
import re

import cv2
import numpy as np
import pytest

from grasp_core.grasp import Grasp, to_image
from grasp_core.gripper import load_gripper
from workbench.curate.pictures import THUMB, coloured, crop_picture, data_url, sample_svg, thumbnail

GRIPPER = load_gripper()


def decoded(url):
    data = np.frombuffer(base64.b64decode(url.split(",")[1]), np.uint8)
    return cv2.cvtColor(cv2.imdecode(data, cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB)


@pytest.fixture
def sample(state):
    return state.sample


def test_pictures_survive_the_way_as_urls():
    picture = np.zeros((20, 30, 3), np.uint8)
    picture[:, 15:] = (200, 100, 50)
    back = decoded(data_url(picture))
    assert back.shape == (20, 30, 3) and np.abs(back[10, 28].astype(int) - (200, 100, 50)).max() < 12


def test_a_thumbnail_is_centred_on_the_grasp_with_its_fingers_marked(sample):
    grasp = Grasp((0.0, 0.0, 0.02), 0.0, 0.1)
    shown = decoded(thumbnail(coloured(sample.image), sample.image, grasp, GRIPPER))
    assert shown.shape == (THUMB, THUMB, 3)
    half = THUMB / 1.35 / 2  # of the opening, along the picture's middle row
    blue = shown.astype(int)[:, :, 2] - shown.astype(int)[:, :, 0]
    for column in (THUMB / 2 - half, THUMB / 2 + half):
        assert blue[THUMB // 2, round(column) - 2 : round(column) + 3].max() > 60
    assert blue[THUMB // 2, THUMB // 2] < 40


def test_the_crop_shows_near_things_bright(sample):
    shown = decoded(crop_picture(sample.image, Grasp((0.0, 0.0, 0.02), 0.0, 0.1), GRIPPER))
    assert shown[THUMB // 2, THUMB // 2].mean() > shown[5, 5].mean() + 20


def test_the_image_s_window_holds_the_rectangle(sample):
    svg = sample_svg(sample.image, sample.row.grasp, GRIPPER, None)
    left, top, width, height = (float(x) for x in re.search(r'viewBox="([^"]+)"', svg)[1].split())
    shown = to_image(sample.row.grasp, sample.image.camera)
    assert left < shown.u < left + width and top < shown.v < top + height and width == height
    assert "data-edited" not in svg and svg.count("<polygon") == 1


def test_an_edited_rectangle_has_handles(sample):
    edited = Grasp((0.01, 0.0, 0.02), 0.5, 0.08)
    svg = sample_svg(sample.image, sample.row.grasp, GRIPPER, edited)
    assert svg.count("<polygon") == 2 and "cdrag:" in svg and "cend:" in svg
    knob = re.search(r'cx="([\d.]+)" cy="([\d.]+)"', svg)
    shown = to_image(edited, sample.image.camera)
    away = np.hypot(float(knob[1]) - 0.5 - shown.u, float(knob[2]) - 0.5 - shown.v)
    assert away == pytest.approx(shown.width / 2, abs=0.05)
