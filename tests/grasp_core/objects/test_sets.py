import pytest

from grasp_core.errors import MeshError
from grasp_core.objects.sets import set_files, set_object, set_of


def installed(name):
    try:
        return set_files(name)
    except MeshError as error:
        assert "pip install 'grasp-workbench[objects]'" in str(error)
        pytest.skip(str(error))


def test_rgb_objects_come_in_metres_with_their_split():
    files = installed("rgb")
    assert len(files) >= 100
    asset = set_object(next(iter(files)))
    assert 0.03 < asset.extents.max() < 0.2
    assert asset.category == "rgb" and asset.meta["split"] in ("train", "heldout", "test_triplets")


def test_random_urdfs_are_united_scaled_and_weighed():
    files = installed("random_urdfs")
    assert len(files) >= 900
    asset = set_object("random_urdfs_003")
    assert asset.mesh.is_watertight
    assert 0.03 < asset.extents.max() < 0.2
    assert asset.mass == pytest.approx(0.1)
    assert asset.decomposition.startswith("exact")


def test_unknown_names_are_refused():
    with pytest.raises(MeshError, match="choose one of: rgb, random_urdfs"):
        set_files("ycb")
    with pytest.raises(MeshError, match="names begin with: rgb, random_urdfs"):
        set_object("ycb_003")


def test_the_set_of_a_name_needs_no_installation():
    assert [set_of(name) for name in ("rgb_b2", "random_urdfs_003", "mug_003")] == ["rgb", "random_urdfs", None]
