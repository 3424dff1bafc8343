import cv2
import numpy as np
import pytest

from grasp_core.errors import GraspError
from workbench.inspector.orders import Photo
from workbench.inspector.worker.photos import check_camera, read_photo


@pytest.fixture
def files(tmp_path):
    depth = np.full((480, 640), 0.7, np.float32)
    np.save(tmp_path / "aa--table.npy", depth)
    cv2.imwrite(str(tmp_path / "bb--table.png"), (depth * 1000).astype(np.uint16))
    (tmp_path / "cc--cam.yaml").write_text("fx: 500\nfy: 500\ncx: 319.5\ncy: 239.5\nwidth: 640\nheight: 480\n")
    (tmp_path / "dd--broken.npy").write_bytes(b"\x93NUMPY no")
    np.save(tmp_path / "ee--flat.npy", depth[0])
    keys = {"image-a": "aa--table.npy", "image-b": "bb--table.png", "camera-c": "cc--cam.yaml",
            "image-d": "dd--broken.npy", "image-e": "ee--flat.npy"}  # fmt: skip
    return {key: str(tmp_path / name) for key, name in keys.items()}


def test_images_are_read_with_each_kind_of_camera(files):
    shipped = read_photo(Photo("image-a", "primesense"), files)
    own = read_photo(Photo("image-a", "camera-c"), files)
    typed = read_photo(Photo("image-b", "", (510.0, 511.0, 320.0, 240.0), 0.001), files)
    assert [image.camera.intrinsics.fx for image in (shipped, own, typed)] == [525, 500, 510]
    assert np.allclose(typed.depth, 0.7) and shipped.camera.world_from_camera is None


@pytest.mark.parametrize(
    ("photo", "told"),
    [
        (Photo("image-a", ""), "has no camera"),
        (Photo("image-a", "canonical"), "300"),
        (Photo("image-b", "primesense"), "set the unit to mm"),
        (Photo("image-a", "", (1.0, 1.0, 0.0, 0.0), 0.001), "unit"),
        (Photo("image-d", "primesense"), "broken.npy"),
        (Photo("image-d", "", (1.0, 1.0, 0.0, 0.0)), "broken.npy"),
        (Photo("image-e", "", (1.0, 1.0, 0.0, 0.0)), "flat.npy"),
        (Photo("image-z", "primesense"), "no longer has"),
    ],
)
def test_what_is_wrong_is_told_in_the_words_of_the_page(files, photo, told):
    with pytest.raises(GraspError, match=told) as caught:
        read_photo(photo, files)
    assert "--depth-scale" not in str(caught.value)
    assert not any(path in str(caught.value) for path in files.values()), "where uploads are kept is nobody's business"


def test_a_camera_file_is_checked_by_itself(files, tmp_path):
    check_camera("camera-c", files)
    (tmp_path / "ff--half.yaml").write_text("fy: 500\ncx: 319.5\ncy: 239.5\nwidth: 640\nheight: 480\n")
    with pytest.raises(GraspError, match=r"^half\.yaml: .*fx"):
        check_camera("camera-f", {**files, "camera-f": str(tmp_path / "ff--half.yaml")})
