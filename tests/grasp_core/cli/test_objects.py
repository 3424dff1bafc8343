import json

import cv2
import trimesh
import yourdfpy

from grasp_core.cli import main
from grasp_core.objects.asset import ObjectAsset


def test_list_as_json_is_one_object(capsys):
    assert main(["objects", "list", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert "mug" in found["families"]["kitchen"] and set(found["sets"]) == {"rgb", "random_urdfs"}


def test_list_for_people(capsys):
    assert main(["objects", "list"]) == 0
    assert "such as mug_003" in capsys.readouterr().out


def test_sheet_draws_families_names_and_files(tmp_path, capsys):
    trimesh.creation.box((4, 2, 1)).export(tmp_path / "crate.stl")
    picture = tmp_path / "sheet.png"
    names = ["mug", "box_004", str(tmp_path / "crate.stl")]
    assert main(["objects", "sheet", *names, "--out", str(picture), "--seeds", "2", "--size", "80"]) == 0
    assert cv2.imread(str(picture)).shape == (129, 320, 3)
    assert "4 objects" in capsys.readouterr().out


def test_sheet_of_a_folder_names_what_it_left_out(tmp_path, capsys):
    trimesh.creation.box((4, 2, 1)).export(tmp_path / "crate.stl")
    (tmp_path / "bad.off").write_text("nothing")
    assert main(["objects", "sheet", "--folder", str(tmp_path), "--out", str(tmp_path / "a.png")]) == 0
    assert "bad.off: does not begin with OFF" in capsys.readouterr().err


def test_unwritable_pictures_and_unknown_names_end_with_status_2(tmp_path, capsys):
    assert main(["objects", "sheet", "box", "--seeds", "1", "--out", str(tmp_path / "no" / "a.png")]) == 2
    assert main(["objects", "export", "spaceship_001", "--out", str(tmp_path)]) == 2
    assert "choose one of" in capsys.readouterr().err


def test_export_writes_urdf_and_asset(tmp_path, capsys):
    assert main(["objects", "export", "can_000", "mug_001", "--out", str(tmp_path)]) == 0
    files = capsys.readouterr().out.split()
    assert len(files) == 2
    assert yourdfpy.URDF.load(files[1]).link_map["mug_001"].inertial.mass > 0
    assert main(["objects", "export", "can_000", "--format", "npz", "--out", str(tmp_path)]) == 0
    assert ObjectAsset.load(tmp_path / "can_000.npz").category == "can"
