import math

import msgspec
import numpy as np
import pytest
import trimesh

from grasp_core.evaluation import cache
from grasp_core.evaluation.oracle import (
    Oracle,
    OracleSettings,
    ScoredGrasp,
    Verified,
    search,
    successes,
    verified_grasps,
)
from grasp_core.grasp import Grasp, angle_distance
from grasp_core.gripper import load_gripper
from grasp_core.objects.asset import ObjectAsset, Part
from grasp_core.scene import Scene, place
from grasp_core.simulation.evidence import Evidence, Outcome
from grasp_core.simulation.physics import load_physics
from grasp_core.simulation.trial import Attempt, GraspNoise, GraspTrial, Trial

GRIPPER, PHYSICS, NOISE = load_gripper(), load_physics(), GraspNoise()
SMALL = OracleSettings(grid=5, angles=2, enough=2, attempts=2, retest=3)


def block(x: float, y: float, z: float) -> ObjectAsset:
    mesh = trimesh.creation.box((x, y, z))
    part = Part(np.array(mesh.vertices), np.array(mesh.faces, np.int32))
    return ObjectAsset("block", "block", part.vertices, part.faces, (part,), float(mesh.volume), mesh.moment_inertia)


def lying(z: float) -> np.ndarray:
    pose = np.eye(4)
    pose[2, 3] = z / 2
    return pose


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setattr(cache, "folder", lambda: tmp_path)


def test_a_bar_is_graspable_and_its_grasps_hold_elsewhere_on_the_table():
    asset = block(0.14, 0.04, 0.04)
    verified = search(asset, lying(0.04), GRIPPER, PHYSICS, NOISE, SMALL)
    assert verified.graspable and len(verified.grasps) >= SMALL.enough and not verified.whole
    best = verified.grasps[0]
    assert best.score >= SMALL.least
    assert angle_distance(best.grasp.angle, math.pi / 2) < 0.1  # across the bar, which is too long for the gripper
    moved = place(lying(0.04), 0.13, -0.07, 1.1)
    found = Oracle(verified, 1)(Scene.single(asset, moved), rng=np.random.default_rng(0))
    trial = GraspTrial(Scene.single(asset, moved), GRIPPER, PHYSICS, NOISE).trial(found[0].grasp, 3, 5)
    assert trial.outcomes == (Outcome.SUCCESS,) * 3


def test_a_slab_wider_than_the_gripper_is_not_graspable_and_the_whole_grid_says_so():
    verified = search(block(0.16, 0.16, 0.04), lying(0.04), GRIPPER, PHYSICS, NOISE, SMALL)
    assert not verified.graspable and verified.whole and verified.tried == 5 * 5 * 2 + 9 * 9 * 4


def test_a_wall_between_the_grids_positions_is_found_by_the_finer_one():
    asset, off = block(0.15, 0.03, 0.05), OracleSettings(grid=2, angles=1, finer=1, enough=1, attempts=1, retest=2)
    # Two positions along each side: only the corners, and only the axis that the gripper cannot close on.
    assert not search(asset, lying(0.05), GRIPPER, PHYSICS, NOISE, off).graspable
    fine = search(asset, lying(0.05), GRIPPER, PHYSICS, NOISE, msgspec.structs.replace(off, finer=2))
    assert fine.graspable and fine.tried > 4


def test_placed_grasps_turn_and_move_with_the_object():
    grasp = Grasp((0.03, 0.0, 0.01), 0.2, 0.1)
    verified = Verified(lying(0.04).tolist(), (ScoredGrasp(grasp, 1.0),), 1, False)
    (found,) = verified.placed(place(lying(0.04), 0.1, 0.2, math.pi / 2))
    assert found.grasp.position == pytest.approx((0.1, 0.23, 0.01))
    assert angle_distance(found.grasp.angle, 0.2 + math.pi / 2) < 1e-9
    assert verified.placed(lying(0.04))[0].grasp.position == pytest.approx(grasp.position)


def test_what_is_known_is_remembered_by_content(monkeypatch):
    calls = []

    def fake(*_: object) -> Verified:
        calls.append(1)
        return Verified(lying(0.04).tolist(), (), 1, True)

    monkeypatch.setattr("grasp_core.evaluation.oracle.search", fake)
    asset = block(0.14, 0.04, 0.04)
    for pose in (lying(0.04), lying(0.04) + 1e-9, lying(0.05)):
        verified_grasps(asset, pose, GRIPPER, PHYSICS, NOISE, SMALL)
    assert len(calls) == 2
    verified_grasps(asset, lying(0.04), GRIPPER, PHYSICS, GraspNoise(sigma_p=0.005), SMALL)
    verified_grasps(block(0.14, 0.04, 0.041), lying(0.04), GRIPPER, PHYSICS, NOISE, SMALL)
    assert len(calls) == 4


def test_an_attempt_whose_solver_diverged_is_no_success():
    grasp = Grasp((0, 0, 0.02), 0, 0.1)
    done = [
        Attempt(o, 0, grasp, True, Evidence(words=""), redraws=r)
        for o, r in [("SUCCESS", 0), ("SUCCESS", 1), ("SLIPPED", 0)]
    ]
    assert successes(Trial(grasp, tuple(done))) == 1  # type: ignore[arg-type]
