"""What verdicts must not hang on: seams between parts, which finger was made first, and the process that runs them.

Seams and the order of fingers change the order in which the solver meets its contacts, and with it the last bits. A
grip in balance may tip either way, as in the real world. Measured over 120 grasps on a box that need dynamics: cut in
two along its length, in two across its height, in three, and in eight parts it agrees with the uncut one on 118, 119,
118 and 118; with the other finger made first on 118. So 1 in 20 may differ at most. With the other finger made first
all of 60 each agree on a mug and a bowl, and 56 on a can of twelve sides, on which edges and facets meet the pads; half
the time step agrees on 56 of the same, too.
"""

import os
import subprocess
import sys

import numpy as np
import pytest
import trimesh

from grasp_core.grasp import Grasp
from grasp_core.gripper import load_gripper
from grasp_core.objects.decomposition import build_asset
from grasp_core.objects.library import catalogue
from grasp_core.scene import Scene
from grasp_core.simulation import gripper_model
from grasp_core.simulation.crosscheck import Judge, agree, open_grasps
from grasp_core.simulation.physics import load_physics
from grasp_core.simulation.trial import GraspTrial

SIDES = np.array([0.04, 0.10, 0.06])
LEAST = 0.95
QUICK, MANY = 20, 120


def cut_box(counts):
    """A box of so many equal parts along its sides."""
    cell = SIDES / counts
    parts = []
    for index in np.ndindex(*counts):
        part = trimesh.creation.box(cell)
        part.apply_translation((np.array(index) + 0.5) * cell - SIDES / 2)
        parts.append(part)
    mesh = trimesh.util.concatenate(parts)
    asset = build_asset("box", "box", mesh, parts=[np.asarray(part.vertices) for part in parts])
    pose = np.eye(4)
    pose[2, 3] = SIDES[2] / 2
    return Scene.single(asset, pose)


@pytest.fixture(scope="module")
def grasps(physics, gripper):
    return open_grasps(cut_box((1, 1, 1)), gripper, physics, MANY, seed=0)


@pytest.fixture(scope="module")
def verdicts(physics, gripper):
    """Of grasps on a scene, the fingers made in the usual order or the other."""

    def run(scene, grasps, other_first=False):
        with pytest.MonkeyPatch.context() as patch:
            if other_first:
                patch.setattr(gripper_model, "FINGERS", gripper_model.FINGERS[::-1])
            judge = Judge("dart", scene, gripper, physics)
        return [judge.verdict(grasp) for grasp in grasps]

    return run


@pytest.fixture(scope="module")
def uncut(verdicts, grasps):
    """Verdicts on the first grasps on the box of one part; judged once."""
    return verdicts(cut_box((1, 1, 1)), grasps[:QUICK])


def test_cut_boxes_weigh_and_turn_alike(physics):
    whole = cut_box((1, 1, 1)).objects[0].asset
    parts = cut_box((2, 2, 2)).objects[0].asset
    assert len(parts.parts) == 8
    assert physics.mass(parts) == pytest.approx(physics.mass(whole))
    assert parts.unit_inertia == pytest.approx(whole.unit_inertia, rel=1e-6, abs=1e-12)


def test_seams_do_not_decide(uncut, verdicts, grasps):
    found = agree(uncut, verdicts(cut_box((2, 2, 2)), grasps[:QUICK]))
    assert found.count == QUICK
    assert found.agreement >= LEAST


@pytest.mark.slow
@pytest.mark.parametrize("counts", [(1, 2, 1), (1, 1, 2), (1, 3, 1), (2, 2, 2)])
def test_seams_do_not_decide_on_many(counts, verdicts, grasps):
    found = agree(verdicts(cut_box((1, 1, 1)), grasps), verdicts(cut_box(counts), grasps))
    assert found.count == MANY
    assert found.agreement >= LEAST


def test_it_does_not_matter_which_finger_was_made_first(uncut, verdicts, grasps):
    assert agree(uncut, verdicts(cut_box((1, 1, 1)), grasps[:QUICK], other_first=True)).agreement >= LEAST


@pytest.mark.slow
@pytest.mark.parametrize(("shape", "least"), [("box", LEAST), ("mug", LEAST), ("bowl", LEAST), ("can", 0.9)])
def test_it_does_not_matter_which_finger_was_made_first_on_many(
    shape, least, shapes, verdicts, grasps, physics, gripper
):
    scene = cut_box((1, 1, 1)) if shape == "box" else shapes.alone(getattr(shapes, shape)())
    mine = grasps if shape == "box" else open_grasps(scene, gripper, physics, MANY // 2, seed=0)
    assert agree(verdicts(scene, mine), verdicts(scene, mine, other_first=True)).agreement >= least


def test_the_other_finger_is_made_first(physics, gripper, monkeypatch):
    """The patch of these tests does what it says."""

    def sides():
        model = gripper_model.GripperModel(gripper, physics)
        return [pad.getTransform().translation()[0] > 0 for pad in model.pads]

    usual = sides()
    monkeypatch.setattr(gripper_model, "FINGERS", gripper_model.FINGERS[::-1])
    assert sides() == usual[::-1]
    assert len(set(usual)) == 2


def told() -> str:
    """Attempts with seeds on an inverted cup, and where they left it, to the last bit."""
    cup = catalogue("cup_000")
    pose = np.diag([1.0, -1.0, -1.0, 1.0])
    pose[2, 3] = cup.vertices[:, 2].max()
    trial = GraspTrial(Scene.single(cup, pose), load_gripper(), load_physics())
    lines = []
    for seed, (y, angle) in enumerate(((-0.012, 0.0), (-0.012, 2.0), (-0.008, 1.0), (-0.004, 1.5))):
        attempt = trial.attempt(Grasp((0.0, y, 0.06), angle, 0.1), seed)
        lines.append(f"{attempt!r} {trial._execution.engine.objects[0].pose.tobytes().hex()}")
    return "\n".join(lines)


def test_the_same_seed_gives_the_same_bits_in_another_process():
    here = told()
    assert here.count("dynamic=True") >= 3
    environment = {
        **os.environ,
        "PYTHONHASHSEED": "7",
        "PYTHONPATH": os.pathsep.join(path for path in sys.path if path),
    }
    there = subprocess.run([sys.executable, __file__], capture_output=True, text=True, env=environment, check=True)
    assert there.stdout.rstrip("\n") == here


if __name__ == "__main__":
    print(told())
