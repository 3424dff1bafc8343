import numpy as np
import pytest
import trimesh

from grasp_core.errors import MeshError
from grasp_core.objects.library import catalogue, load_folder, load_object
from grasp_core.objects.parametric import make
from grasp_core.objects.urdf import write_urdf


@pytest.fixture
def box(tmp_path):
    file = tmp_path / "crate_07.off"
    trimesh.creation.box((4, 2, 1)).export(file)
    return file


def test_catalogue_knows_family_and_seed():
    assert catalogue("mug_003").digest == make("mug", 3).digest
    assert catalogue("wine_glass_012").category == "wine_glass"
    for name in ("mug", "mug_3", "Mug_003"):
        with pytest.raises(MeshError, match="such as mug_003"):
            catalogue(name)
    with pytest.raises(MeshError, match="choose one of"):
        catalogue("spaceship_001")


def test_paper_scale_is_drawn_between_10_and_20_cm_and_repeats(box):
    sides = [load_object(box, scale="paper", seed=seed).extents.max() for seed in range(8)]
    assert all(0.10 <= side <= 0.20 for side in sides) and len(set(sides)) == 8
    assert load_object(box, scale="paper", seed=0).digest == load_object(box, scale="paper", seed=0).digest


def test_factor_and_names(box):
    asset = load_object(box, scale=0.02)
    assert np.allclose(asset.extents, [0.08, 0.04, 0.02])
    assert (asset.name, asset.category, asset.mass) == ("crate_07", "crate", None)
    assert load_object(box, scale=0.02, name="x", category="y").category == "y"


@pytest.mark.parametrize(
    ("scale", "says"),
    [
        ("keep", "would be 4 m"),
        (1e-6, "in metres give a factor"),
        (-1.0, "above 0"),
        (float("nan"), "above 0"),
        ("huge", "keep, paper"),
    ],
)
def test_impossible_sizes_are_refused(box, scale, says):
    with pytest.raises(MeshError, match=says):
        load_object(box, scale=scale)


def test_a_folder_survives_bad_files_and_reports_them(tmp_path, box):
    (tmp_path / "bad.obj").write_text("rubbish")
    (tmp_path / "cut.off").write_text("OFF\n4 2 0\n0 0 0\n")
    (tmp_path / "notes.txt").write_text("not a mesh")
    (tmp_path / "sub").mkdir()
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "sub" / "crate_07.stl")
    write_urdf(make("box", 0), tmp_path / "robots")
    seen = []
    assets, refused = load_folder(tmp_path, "paper", progress=lambda done, of: seen.append((done, of)))
    assert [asset.name for asset in assets] == ["crate_07", "box_000", "sub_crate_07"]
    assert {file.name for file in refused} == {"bad.obj", "cut.off"}
    assert "ends after 1 lines" in refused[tmp_path / "cut.off"]
    assert seen[-1] == (5, 5)


def test_folders_without_objects_are_refused(tmp_path):
    with pytest.raises(MeshError, match="holds no object"):
        load_folder(tmp_path)
    with pytest.raises(MeshError, match="no such folder"):
        load_folder(tmp_path / "none")
