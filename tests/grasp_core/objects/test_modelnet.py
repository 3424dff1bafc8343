import os
from pathlib import Path

import pytest
import trimesh

from grasp_core.errors import MeshError
from grasp_core.objects.modelnet import find_modelnet, load_modelnet


@pytest.fixture
def modelnet(tmp_path):
    for label in ("chair", "stool"):
        for split in ("train", "test"):
            folder = tmp_path / label / split
            folder.mkdir(parents=True)
            for i in range(2):
                trimesh.creation.box((30, 20 + i, 10)).export(folder / f"{label}_{split}_{i:04d}.off")
    (tmp_path / "stool" / "train" / "stool_0009.off").write_text("OFF\n8 6 0\n")
    return tmp_path


def test_class_and_split_are_kept_and_bad_files_reported(modelnet):
    assets, refused = load_modelnet(modelnet)
    assert len(assets) == 8
    assert {(a.category, a.meta["split"]) for a in assets} == {
        (c, s) for c in ("chair", "stool") for s in ("train", "test")
    }
    assert [file.name for file in refused] == ["stool_0009.off"]
    assert all(0.1 <= a.extents.max() <= 0.2 for a in assets)


def test_choices(modelnet):
    assert len(find_modelnet(modelnet, split="test", classes=["chair"])) == 2
    assert len(load_modelnet(modelnet, split="test", per_class=1)[0]) == 2
    with pytest.raises(MeshError, match="choose from: chair, stool"):
        find_modelnet(modelnet, classes=["sofa"])
    with pytest.raises(MeshError, match="train, test"):
        find_modelnet(modelnet, split="val")
    with pytest.raises(MeshError, match="no ModelNet folder"):
        find_modelnet(modelnet / "chair")


def test_real_files_come_in():
    root = os.environ.get("GRASP_TEST_DATA")
    if not root or not (Path(root) / "modelnet").is_dir():
        pytest.skip("set GRASP_TEST_DATA to the folder with modelnet/ to test on real meshes")
    assets, refused = load_modelnet(Path(root) / "modelnet", classes=["chair", "stool"])
    assert not refused
    assert {a.category for a in assets} == {"chair", "stool"}
    for asset in assets:
        assert len(asset.parts) >= 5, asset.decomposition
        assert asset.volume < 0.6 * asset.hull.volume
        assert all(part.mesh.is_watertight and part.mesh.volume > 0 for part in asset.parts)
