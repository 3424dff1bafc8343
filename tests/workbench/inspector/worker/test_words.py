import numpy as np
import pytest

from grasp_core.camera import load_camera
from grasp_core.errors import GraspError
from grasp_core.objects.library import load_object
from grasp_core.sensing.preprocess import read_depth
from workbench.inspector.worker.words import named, reworded


def test_own_files_are_called_what_people_called_them():
    assert named("/var/kept/0123456789ab--my image.npy") == "my image.npy"
    assert named("/home/ann/depth.npy") == "depth.npy"
    assert reworded("/kept/ab--a.npy: too small", ["/kept/ab--a.npy"]) == "a.npy: too small"


@pytest.mark.parametrize(("array", "told"), [("whole", "set the unit to mm"), ("no array", "not a NumPy array")])
def test_images(tmp_path, array, told):
    path = tmp_path / "ab--depth.npy"
    np.save(path, np.ones((4, 4), np.uint16))
    if array == "no array":
        path.write_bytes(b"no array")
    with pytest.raises(GraspError) as caught:
        read_depth(path, load_camera("primesense"), None)
    said = reworded(str(caught.value), [path])
    assert said.startswith("depth.npy: ") and told in said
    assert not any(word in said for word in ("--depth-scale", "say what", "pickle"))


def test_meshes_of_another_unit(tmp_path):
    import trimesh

    path = tmp_path / "ab--box.stl"
    trimesh.creation.box((120, 40, 60)).export(path)
    with pytest.raises(GraspError) as caught:
        load_object(path, scale="keep", name="box")
    assert reworded(str(caught.value), [path]) == "box.stl: its longest side would be 120 m; set another mesh unit"
