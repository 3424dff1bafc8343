import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grasp_core.camera import Camera, CameraIntrinsics, DepthImage, canonical_camera
from grasp_core.errors import ImageError
from grasp_core.sensing.preprocess import fill, fill_holes, read_depth, read_mask

CAMERA = Camera(CameraIntrinsics(525, 525, 31.5, 23.5, 64, 48))


def ramp() -> np.ndarray:
    return np.linspace(0.6, 0.7, 48 * 64, dtype=np.float32).reshape(48, 64)


def saved(path, array):
    if path.suffix == ".npy":
        np.save(path, array)
    else:
        assert cv2.imwrite(str(path), array)
    return path


def test_metres_from_npy_and_tiff(tmp_path):
    for name, array in (("a.npy", ramp()), ("b.npy", ramp()[:, :, None]), ("c.npy", ramp().astype(float))):
        assert np.array_equal(read_depth(saved(tmp_path / name, array), CAMERA).depth, ramp())
    assert np.array_equal(read_depth(saved(tmp_path / "d.tiff", ramp()), CAMERA).depth, ramp())


def test_whole_numbers_need_a_scale(tmp_path):
    millimetres = np.rint(ramp() * 1000).astype(np.uint16)
    millimetres[3, 5] = 0
    path = saved(tmp_path / "depth.png", millimetres)
    with pytest.raises(ImageError, match=r"depth\.png.*--depth-scale 0\.001"):
        read_depth(path, CAMERA)
    image = read_depth(path, CAMERA, 0.001)
    assert np.allclose(image.depth[image.valid], ramp()[image.valid], atol=6e-4)
    assert (~image.valid).sum() == 1 and not image.valid[3, 5]


@pytest.mark.parametrize(
    "array, scale, words",
    [
        (ramp() * 1000, None, "millimetres"),
        (ramp(), 0.001, "scale is wrong"),
        (ramp(), 0.0, "above 0"),
        (ramp()[:, :40], None, "camera"),
        (np.zeros((48, 64)), None, "no valid pixel"),
        (np.full((48, 64), np.nan), None, "no valid pixel"),
        (np.zeros((48, 64, 3), np.float32), None, "shape"),
        (np.full((48, 64), "far"), None, "type"),
        (np.full((48, 64), 1 + 1j), None, "type"),
        (np.full((48, 64), None), None, "NumPy array"),
    ],
)
def test_bad_content_is_refused_with_the_file_name(array, scale, words, tmp_path):
    path = tmp_path / "bad.npy"
    np.save(path, array, allow_pickle=True)
    with pytest.raises(ImageError, match=r"bad\.npy") as refused:
        read_depth(path, CAMERA, scale)
    assert words in str(refused.value)


def test_bad_files_are_refused(tmp_path):
    with pytest.raises(ImageError, match="no such file"):
        read_depth(tmp_path / "none.npy", CAMERA)
    (tmp_path / "cut.npy").write_bytes(b"\x93NUMPY\x01")
    (tmp_path / "cut.png").write_bytes(b"\x89PNG\r\n")
    for name in ("cut.npy", "cut.png"):
        with pytest.raises(ImageError, match=name):
            read_depth(tmp_path / name, CAMERA)
    with pytest.raises(ImageError, match="8 bits"):
        read_depth(saved(tmp_path / "picture.png", np.zeros((48, 64), np.uint8)), CAMERA, 0.001)
    (tmp_path / "depth.jpg").write_bytes(b"")
    with pytest.raises(ImageError, match=r"\.npy"):
        read_depth(tmp_path / "depth.jpg", CAMERA)


def test_masks(tmp_path):
    mask = np.zeros((48, 64), np.uint8)
    mask[10:20, 30:40] = 255
    for name, array in (("m.png", mask), ("c.png", np.dstack([mask * 0, mask, mask * 0])), ("m.npy", mask > 0)):
        assert np.array_equal(read_mask(saved(tmp_path / name, array), (48, 64)), mask > 0)
    with pytest.raises(ImageError, match=r"m\.png.*64×48.*32×48"):
        read_mask(tmp_path / "m.png", (48, 32))
    with pytest.raises(ImageError, match="no such file"):
        read_mask(tmp_path / "none.png", (48, 64))
    (tmp_path / "bad.png").write_bytes(b"no image")
    with pytest.raises(ImageError, match="cannot be read"):
        read_mask(tmp_path / "bad.png", (48, 64))


def test_holes_beside_an_edge_take_the_background():
    depth = np.full((100, 100), 0.7, np.float32)
    depth[30:70, 30:70] = 0.6
    valid = np.ones((100, 100), bool)
    valid[30:70, 70:80] = False
    image, missing = fill_holes(DepthImage(depth, canonical_camera(100), valid))
    assert missing == pytest.approx(0.04)
    assert np.allclose(image.depth[30:70, 70:80], 0.7) and image.valid.all()


def test_a_hole_inside_a_surface_continues_it():
    depth = np.full((100, 100), 0.7, np.float32)
    depth[20:80, 20:80] = 0.6
    valid = np.ones((100, 100), bool)
    valid[45:55, 45:55] = False
    assert np.allclose(fill(depth, valid)[45:55, 45:55], 0.6)


def test_nothing_to_fill_from():
    with pytest.raises(ImageError, match="no valid pixel"):
        fill_holes(DepthImage(np.zeros((4, 4), np.float32), canonical_camera(4), np.zeros((4, 4), bool)))


@settings(max_examples=60, deadline=None)
@given(st.integers(1, 33), st.integers(1, 33), st.integers(0, 2**32 - 1))
def test_exactly_the_holes_are_filled_within_the_range_of_what_was_seen(height, width, seed):
    rng = np.random.default_rng(seed)
    depth = rng.uniform(0.4, 0.9, (height, width)).astype(np.float32)
    valid = rng.random((height, width)) < rng.random()
    valid[rng.integers(height), rng.integers(width)] = True
    camera = Camera(CameraIntrinsics(100, 100, 0, 0, width, height))
    filled, missing = fill_holes(DepthImage(np.where(valid, depth, np.nan).astype(np.float32), camera, valid))
    assert np.array_equal(filled.depth[valid], depth[valid])
    seen = depth[valid]
    assert (filled.depth >= seen.min() - 1e-6).all() and (filled.depth <= seen.max() + 1e-6).all()
    assert missing == pytest.approx(1 - valid.mean())
