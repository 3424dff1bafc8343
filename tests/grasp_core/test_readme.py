"""What the README tells people to write works as written."""

import re
import textwrap
from pathlib import Path

import numpy as np
import trimesh

from grasp_core.camera import load_camera, look_down
from grasp_core.objects.asset import ObjectAsset, Part
from grasp_core.scene import Scene, place
from grasp_core.sensing.renderer import render

README = (Path(__file__).parents[2] / "README.md").read_text()


def blocks(language: str) -> list[str]:
    return [textwrap.dedent(block) for block in re.findall(rf"^ *```{language}\n(.*?)^ *```", README, re.M | re.S)]


def test_the_snippet_plans_on_a_depth_file(tmp_path, monkeypatch, capsys):
    (snippet,) = [block for block in blocks("python") if "make_planner" in block]
    (camera,) = [block for block in blocks("yaml") if "fx:" in block]
    mesh = trimesh.creation.box((0.15, 0.03, 0.05))
    part = Part(np.array(mesh.vertices), np.array(mesh.faces, np.int32))
    bar = ObjectAsset("bar", "bar", part.vertices, part.faces, (part,), float(mesh.volume), mesh.moment_inertia)
    pose = np.eye(4)
    pose[2, 3] = 0.025
    (tmp_path / "camera.yaml").write_text(camera)
    monkeypatch.chdir(tmp_path)
    view = load_camera("camera.yaml").at(look_down(0.7))
    np.save("depth.npy", render(Scene.single(bar, place(pose, 0.05, 0.03, 0.4), view)).depth)
    exec(compile(snippet, "README.md", "exec"), {})
    first, *rest = capsys.readouterr().out.splitlines()
    assert re.match(r"\d+ grasps in \d+ ms", first) and len(rest) == int(first.split()[0])
    scores = [float(line.split()[0]) for line in rest]
    assert scores == sorted(scores, reverse=True) and scores[0] > 0.6
