import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from grasp_core.camera import DepthImage, canonical_camera
from grasp_core.dataset import files
from grasp_core.errors import StoreError


def image(depth):
    return DepthImage.from_array(depth, canonical_camera())


def test_depth_round_trip_is_exact_to_half_a_unit(tmp_path):
    depth = np.random.default_rng(0).uniform(0.3, 0.9, (300, 300)).astype(np.float32)
    depth[5, 7] = np.nan
    path = tmp_path / "a.png"
    files.write_durably(path, files.png_bytes(files.depth_units(image(depth))))
    back = files.depth_image(files.read_png(path), canonical_camera())
    assert not back.valid[5, 7]
    assert back.valid.sum() == 300 * 300 - 1
    assert np.abs(back.depth - depth)[back.valid].max() <= 0.5e-4 + 1e-7
    assert files.pixels_digest(files.depth_units(back)) == files.pixels_digest(files.depth_units(image(depth)))


def test_too_far_is_refused():
    with pytest.raises(StoreError, match=r"6\.55 m"):
        files.depth_units(image(np.full((300, 300), 7.0)))


def test_damaged_png_is_named(tmp_path):
    path = tmp_path / "bad.png"
    path.write_bytes(b"nothing")
    with pytest.raises(StoreError, match=r"bad\.png"):
        files.read_png(path)
    with pytest.raises(StoreError, match=r"missing\.png"):
        files.read_png(tmp_path / "missing.png")


@given(st.text(), st.text())
def test_names_never_share_a_file(a, b):
    assert (files.file_name(a, ".png") == files.file_name(b, ".png")) == (a == b)
    assert "/" not in files.file_name(a, ".png")


def test_failed_write_leaves_nothing(tmp_path):
    folder = tmp_path / "none"
    with pytest.raises(StoreError, match="cannot be written"):
        files.write_durably(folder / "x.png", b"1")
    assert list(tmp_path.iterdir()) == []
