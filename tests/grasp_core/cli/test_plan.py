import json
import math
import os
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest
import trimesh

from grasp_core.camera import Camera, CameraIntrinsics, look_down
from grasp_core.cli import main
from grasp_core.objects.asset import ObjectAsset, Part
from grasp_core.scene import Scene, place
from grasp_core.sensing.renderer import render

POSE = look_down(0.75, tilt=0.2)


@pytest.fixture
def files(tmp_path):
    """A depth image of a box at (0.05, 0.02), turned by 0.4 rad, its camera file, and the folder."""
    mesh = trimesh.creation.box(extents=(0.14, 0.05, 0.05))
    vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces, np.int32)
    asset = ObjectAsset("box", "test", vertices, faces, (Part(vertices, faces),), mesh.volume, np.eye(3))
    lifted = np.eye(4)
    lifted[2, 3] = 0.025
    camera = Camera(CameraIntrinsics(525, 525, 319.5, 239.5, 640, 480), POSE)
    image = render(Scene.single(asset, place(lifted, 0.05, 0.02, 0.4), camera))
    np.save(tmp_path / "depth.npy", image.depth)
    rows = "\n".join(f"  - {row.tolist()}" for row in POSE)
    text = "fx: 525.0\nfy: 525.0\ncx: 319.5\ncy: 239.5\nwidth: 640\nheight: 480\n"
    (tmp_path / "camera.yaml").write_text(f"{text}world_from_camera:\n{rows}\n")
    return tmp_path


def plan(files, *options, camera="camera.yaml", depth="depth.npy"):
    return main(["plan", str(files / depth), "--camera", str(files / camera), "--planner", "antipodal", *options])


def test_json_is_one_object_in_the_contract(files, capsys):
    assert plan(files, "--json") == 0
    captured = capsys.readouterr()
    found = json.loads(captured.out)
    assert captured.out.count("\n") == 1 and captured.err == ""
    assert list(found)[:5] == ["grasps", "reason", "stages_ms", "camera", "weights"]
    assert found["reason"] is None and found["weights"] is None and found["missing"] == 0
    assert found["camera"]["world_from_camera"] == POSE.tolist() and found["camera"]["fx"] == 525
    scores = [grasp["score"] for grasp in found["grasps"]]
    assert scores and scores == sorted(scores, reverse=True)
    best = found["grasps"][0]
    assert set(best) == {"position", "angle", "width", "score", "image"}
    assert set(best["image"]) == {"u", "v", "angle", "width", "depth"}
    assert math.hypot(best["position"][0] - 0.05, best["position"][1] - 0.02) < 0.07
    assert best["position"][2] == pytest.approx(0.02, abs=0.004) and best["width"] == 0.1
    assert abs(math.sin(best["angle"] - 0.4)) > 0.93
    assert found["stages_ms"]["rectify"] > 0


def test_seeds_repeat_and_differ(files, capsys):
    outputs = []
    for seed in ("0", "0", "1"):
        plan(files, "--json", "--seed", seed)
        outputs.append(json.loads(capsys.readouterr().out)["grasps"])
    assert outputs[0] == outputs[1] != outputs[2]


def test_the_table_and_the_picture(files, capsys):
    picture = files / "out.png"
    assert plan(files, "--picture", str(picture)) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("score") and "rectify" in lines[-1] and len(lines) > 3
    assert cv2.imread(str(picture)).shape[1] > 1280


def test_millimetres_and_masks(files, capsys):
    depth = np.load(files / "depth.npy")
    cv2.imwrite(str(files / "depth.png"), np.rint(depth * 1000).astype(np.uint16))
    assert plan(files, "--json", "--depth-scale", "0.001", depth="depth.png") == 0
    assert json.loads(capsys.readouterr().out)["grasps"]
    mask = np.zeros((480, 640), np.uint8)
    for words in ("the mask is empty", "under the mask"):
        cv2.imwrite(str(files / "mask.png"), mask)
        assert plan(files, "--json", "--mask", str(files / "mask.png")) == 0
        found = json.loads(capsys.readouterr().out)
        assert found["grasps"] == [] and words in found["reason"]
        mask[:20, :20] = 255  # bare table


def test_empty_plans_exit_with_0_and_say_why(files, capsys):
    np.save(files / "empty.npy", np.full((480, 640), 0.7))
    text = (files / "camera.yaml").read_text().split("world_from_camera")[0]
    (files / "free.yaml").write_text(text)
    assert plan(files, depth="empty.npy", camera="free.yaml") == 0
    assert capsys.readouterr().out.startswith("no grasp: no object above the table")


@pytest.mark.parametrize(
    "options, words",
    [
        (["none.npy"], "none.npy: no such file"),
        (["millimetres.npy"], "millimetres"),
        (["narrow.npy"], "(600, 480)"),
        (["depth.npy", "--mask", "narrow.npy"], "mask"),
        (["depth.npy", "--budget-ms", "0"], "--budget-ms"),
        (["depth.npy", "--seed", "-1"], "--seed"),
        (["depth.npy", "--planner", "magic"], "antipodal"),
        (["depth.npy", "--gripper", "magic"], "paper"),
        (["depth.npy", "--planner", "cascade", "--weights", "magic"], "magic"),
        (["depth.npy", "--picture", "none/out.png"], "cannot be written"),
        (["depth.npy", "--camera", "none.yaml"], "none.yaml"),
    ],
)
def test_bad_input_exits_with_2_and_one_clear_line(options, words, files, capsys, monkeypatch):
    monkeypatch.chdir(files)
    depth = np.load("depth.npy")
    np.save("millimetres.npy", depth * 1000)
    np.save("narrow.npy", depth[:, :600])
    given = ["plan", *options]
    for name, value in (("--camera", "camera.yaml"), ("--planner", "antipodal")):
        given += [] if name in given else [name, value]
    assert main(given) == 2
    captured = capsys.readouterr()
    assert captured.out == "" and captured.err.count("\n") == 1 and words in captured.err


def test_the_camera_is_mandatory(files, capsys):
    assert main(["plan", str(files / "depth.npy")]) == 2
    assert "--camera" in capsys.readouterr().err


def test_planning_needs_neither_torch_nor_the_network(files):
    code = (
        "import socket, sys\n"
        "def refuse(*a, **k): raise OSError('no network')\n"
        "socket.socket.connect = socket.create_connection = refuse\n"
        "from grasp_core.cli import main\n"
        "status = main(sys.argv[1:])\n"
        "heavy = {'torch', 'matplotlib', 'dartpy', 'viser', 'trimesh'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
        "sys.exit(status)\n"
    )
    arguments = ["plan", "depth.npy", "--camera", "camera.yaml", "--planner", "antipodal", "--json"]
    done = subprocess.run([sys.executable, "-c", code, *arguments], cwd=files, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["grasps"]


@pytest.mark.skipif("GRASP_TEST_DATA" not in os.environ, reason="GRASP_TEST_DATA names no folder of real files")
def test_the_real_scene_of_many_things(capsys):
    depth = Path(os.environ["GRASP_TEST_DATA"]) / "realsense" / "depth.png"
    given = ["plan", str(depth), "--camera", "realsense", "--planner", "antipodal", "--json", "--depth-scale", "0.001"]
    assert main(given) == 0
    found = json.loads(capsys.readouterr().out)
    assert len(found["grasps"]) == 10 and found["missing"] == pytest.approx(0.105, abs=0.002)
