import json

import numpy as np
import pytest
import trimesh

from grasp_core.cli import main
from grasp_core.cli.trial import read_pose
from grasp_core.errors import GraspError
from grasp_core.simulation.recording import Recording


@pytest.fixture(scope="module")
def mesh(tmp_path_factory):
    path = tmp_path_factory.mktemp("mesh") / "block.stl"
    trimesh.creation.box([0.04, 0.06, 0.05]).export(path)
    return path


@pytest.fixture
def pose(tmp_path):
    path = tmp_path / "pose.txt"
    np.savetxt(path, [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.025], [0, 0, 0, 1]])
    return path


def run(mesh, *rest):
    words = [str(word) for word in rest]
    return main(["trial", str(mesh), "--angle", "0", "--width", "0.1", *words])


def test_json_holds_outcomes_and_evidence(mesh, pose, capsys):
    rest = ("--position", 0, 0, 0.02, "--pose", pose, "--attempts", 2, "--json")
    assert run(mesh, *rest) == 0
    out = capsys.readouterr().out
    found = json.loads(out)
    assert found["outcomes"] == ["SUCCESS", "SUCCESS"]
    assert found["quality"] == 1.0
    assert found["seed"] == 0
    assert len(found["attempts"]) == 2
    first = found["attempts"][0]
    assert first["evidence"]["left"]["force"] == pytest.approx(20, rel=0.05)
    assert first["evidence"]["lift"] == pytest.approx(0.3, abs=0.01)
    assert run(mesh, *rest) == 0
    assert capsys.readouterr().out == out


def test_shaking_says_what_was_withstood(mesh, pose, capsys):
    rest = ("--position", 0, 0, 0.02, "--pose", pose, "--attempts", 1, "--noiseless", "--shake", "z")
    assert run(mesh, *rest, "--shake-step", 10, "--shake-most", 20, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    withstood = found["attempts"][0]["evidence"]["withstood"]
    assert withstood["axis"] == "z" and withstood["direction"] == [0, 0, 1]
    assert withstood["acceleration"] == 20 and withstood["slipped"] is None
    assert withstood["force"] == pytest.approx(20 * found["mass"])
    assert run(mesh, *rest, "--shake-step", 10, "--shake-most", 5) == 2
    assert "--shake-most" in capsys.readouterr().err


def test_words_and_recording(mesh, pose, capsys, tmp_path):
    file = tmp_path / "film.npz"
    rest = ("--position", 0.5, 0, 0.02, "--pose", pose, "--attempts", 1, "--noiseless", "--record", file)
    assert run(mesh, *rest) == 0
    assert "MISSED     closed on nothing" in capsys.readouterr().out
    assert Recording.load(file).outcome == "MISSED"


def test_index_of_a_stable_pose(mesh, capsys):
    assert run(mesh, "--position", 0, 0, 0.02, "--pose", 0, "--attempts", 1, "--json") == 0
    assert json.loads(capsys.readouterr().out)["world_from_object"][2][3] == pytest.approx(0.02, abs=1e-3)
    assert run(mesh, "--position", 0, 0, 0.02, "--pose", 99) == 2
    assert "stable poses" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("rest", "text"),
    [
        (("--position", 0, 0, 0.02, "--pose", "nowhere.txt"), "no such file"),
        (("--position", 0, 0, 0.02, "--seed", -1), "--seed"),
        (("--position", 0, 0, 0.02, "--attempts", 0), "at least one attempt"),
        (("--position", 0, 0, 0.02, "--gripper", "hand"), "hand"),
    ],
)
def test_bad_input_is_one_line(mesh, capsys, pose, rest, text):
    if "--pose" not in rest:
        rest = (*rest, "--pose", pose)
    assert run(mesh, *rest) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert text in printed.err
    assert printed.err.count("\n") == 1


def test_poses_from_every_format(tmp_path):
    pose = trimesh.transformations.euler_matrix(0.1, 0.2, 0.3)
    pose[:3, 3] = [0.1, 0.2, 0.3]
    np.save(tmp_path / "a.npy", pose)
    np.savetxt(tmp_path / "b.txt", pose)
    (tmp_path / "c.yaml").write_text(f"world_from_object: {pose.tolist()}\n")
    (tmp_path / "d.yaml").write_text(f"{pose.tolist()}\n")
    for name in ("a.npy", "b.txt", "c.yaml", "d.yaml"):
        assert np.allclose(read_pose(tmp_path / name), pose), name


@pytest.mark.parametrize(
    ("text", "why"),
    [("1 2 3", "4×4"), ("word", "holds no numbers"), ("2 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1", "rotation")],
)
def test_what_is_no_pose_is_refused(tmp_path, text, why):
    path = tmp_path / "pose.txt"
    path.write_text(text)
    with pytest.raises(GraspError, match=why):
        read_pose(path)


def test_a_pose_that_does_not_rest_on_the_table_is_refused(mesh, capsys, tmp_path):
    floating = np.eye(4)
    floating[2, 3] = 0.3
    path = tmp_path / "floating.txt"
    np.savetxt(path, floating)
    assert run(mesh, "--position", 0, 0, 0.3, "--pose", path) == 2
    assert "must rest on the table" in capsys.readouterr().err
