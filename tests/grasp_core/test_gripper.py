import math
from pathlib import Path

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from grasp_core import config
from grasp_core.errors import ConfigError
from grasp_core.gripper import Box, Gripper, load_gripper

LINES = {
    "name": "mine",
    "opening": "0.08",
    "finger": "{x: 0.01, y: 0.02, z: 0.05}",
    "rod": "{x: 0.1, y: 0.02, z: 0.02}",
    "base": "{x: 0.04, y: 0.04, z: 0.04}",
    "finger_mass": "4e-1",
    "force": "20",
    "speed": "0.2",
}


def write(folder: Path, **changes: str | None) -> Path:
    path = folder / "mine.yaml"
    path.write_text("".join(f"{k}: {v}\n" for k, v in (LINES | changes).items() if v is not None))
    return path


def test_the_papers_gripper():
    gripper = load_gripper("paper")
    assert gripper.opening == 0.10
    assert gripper.finger.size == (0.01, 0.02, 0.05)
    assert gripper.rod.x == pytest.approx(0.12)


@given(st.floats(0, 0.1))
def test_boxes_touch_the_opening_and_stand_on_each_other(opening):
    boxes = load_gripper("paper").boxes(opening)
    left, right = boxes["left_finger"], boxes["right_finger"]
    inner_left = left[1][0] + left[0].x / 2
    inner_right = right[1][0] - right[0].x / 2
    assert (inner_left, inner_right) == pytest.approx((-opening / 2, opening / 2))
    bottom = {name: centre[2] - box.z / 2 for name, (box, centre) in boxes.items()}
    top = {name: centre[2] + box.z / 2 for name, (box, centre) in boxes.items()}
    assert bottom["left_finger"] == pytest.approx(0) and bottom["right_finger"] == pytest.approx(0)
    assert bottom["rod"] == pytest.approx(top["left_finger"])
    assert bottom["base"] == pytest.approx(top["rod"])
    assert all(centre[1] == 0 for _, centre in boxes.values())


def test_the_rod_carries_both_fingers_fully_open():
    boxes = load_gripper("paper").boxes()
    outer = boxes["right_finger"][1][0] + boxes["right_finger"][0].x / 2
    assert outer <= boxes["rod"][0].x / 2 + 1e-9


def test_a_gripper_file_of_ones_own(tmp_path):
    gripper = load_gripper(write(tmp_path))
    assert gripper.finger_mass == 0.4 and gripper.force == 20.0 and gripper.urdf is None


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"opening": "0"}, "opening"),
        ({"force": "-1"}, "force"),
        ({"force": ".nan"}, "force"),
        ({"speed": ".inf"}, "speed"),
        ({"finger_mass": "heavy"}, "finger_mass"),
        ({"finger": "{x: 0.01, y: 0.02}"}, r"`z`.*finger"),
        ({"finger": "{x: 0.01, y: 0.02, z: 0.0}"}, "above 0"),
        ({"finger": "{x: 0.01, y: 0.02, z: 0.05, w: 1}"}, r"`w`.*finger.*keys there are: x, y, z"),
        ({"rod": "{x: 0.09, y: 0.02, z: 0.02}"}, r"rod.*0\.100 m"),
        ({"speed": None}, "speed"),
        ({"colour": "red"}, r"colour.*opening"),
        ({"urdf": "none.urdf"}, r"urdf.*none\.urdf.*not there"),
    ],
)
def test_wrong_gripper_files_are_refused_by_file_and_key(tmp_path, changes, words):
    with pytest.raises(ConfigError, match=words) as caught:
        load_gripper(write(tmp_path, **changes))
    assert "mine.yaml" in str(caught.value)


def test_the_urdf_is_found_beside_its_yaml(tmp_path):
    (tmp_path / "mine.urdf").write_text("<robot name='mine'/>")
    gripper = load_gripper(write(tmp_path, urdf="mine.urdf"))
    assert gripper.urdf is not None and Path(gripper.urdf) == (tmp_path / "mine.urdf").resolve()


def test_digest_follows_what_matters_to_physics():
    gripper = load_gripper("paper")
    assert gripper.digest == msgspec.structs.replace(gripper, name="other", urdf="shown.urdf").digest
    for field in ("opening", "force", "speed", "finger_mass"):
        smaller = msgspec.structs.replace(gripper, **{field: getattr(gripper, field) * 0.9})
        assert smaller.digest != gripper.digest, field
    assert msgspec.structs.replace(gripper, finger=Box(x=0.01, y=0.03, z=0.05)).digest != gripper.digest


@pytest.mark.parametrize("name", list(config.shipped("grippers")))
def test_shipped_grippers_decode(name):
    gripper = load_gripper(name)
    assert isinstance(gripper, Gripper) and math.isfinite(gripper.opening)
    assert np.all(np.array(gripper.finger.size) > 0)
