import cv2
import numpy as np
import pytest
import trimesh

from grasp_core.camera import load_camera
from grasp_core.errors import ConfigError
from grasp_core.evaluation import judge
from grasp_core.evaluation.benchmark import Benchmark
from grasp_core.evaluation.judge import SceneItem, judge_scene, ready_planner
from grasp_core.evaluation.oracle import ScoredGrasp, Verified
from grasp_core.evaluation.scenes import SceneSpec
from grasp_core.grasp import Grasp, to_image
from grasp_core.gripper import load_gripper
from grasp_core.objects.asset import ObjectAsset, Part
from grasp_core.planning.planner import Candidate, Plan
from grasp_core.simulation.physics import load_physics

PHYSICS = load_physics()


def bar() -> ObjectAsset:
    mesh = trimesh.creation.box((0.15, 0.03, 0.04))
    part = Part(np.array(mesh.vertices), np.array(mesh.faces, np.int32))
    return ObjectAsset("tray/bar", "bar", part.vertices, part.faces, (part,), float(mesh.volume), mesh.moment_inertia)


def item(planners: tuple[str, ...], pictures=None, graspable: bool = True, attempts: int = 2) -> SceneItem:
    asset = bar()
    pose = np.eye(4)
    pose[2, 3] = 0.02
    benchmark = Benchmark("f", planners, load_camera("primesense"), load_gripper(), PHYSICS, attempts=attempts)
    across = ScoredGrasp(Grasp((0.0, 0.0, 0.012), np.pi / 2, 0.1), 1.0)
    verified = Verified(pose.tolist(), (across,) if graspable else (), 1, not graspable)
    spec = SceneSpec(asset.name, asset.digest, 0, 0)
    return SceneItem(benchmark, spec, asset, pose, 0.7, planners, pictures, verified)


@pytest.fixture
def stubs(monkeypatch):
    """Planners of known quality: "good" reads the depth image, "bad" grasps lengthwise, "none" finds nothing."""
    calls: list[str] = []

    def make(name, gripper, weights):
        def plan(image, *, mask=None, budget_ms=None, rng):
            calls.append(name)
            points = image.points()
            raised = points[(points[..., 2] > 0.03) & image.valid]
            centre = raised.mean(0)
            spread = np.linalg.svd((raised - centre)[:, :2], full_matrices=False)[2][0]
            along = float(np.arctan2(spread[1], spread[0]))
            angle = {"good": along + np.pi / 2, "bad": along}.get(name)
            candidates = ()
            if angle is not None:
                grasp = Grasp((float(centre[0]), float(centre[1]), 0.012), angle, gripper.opening)
                candidates = (Candidate(grasp, to_image(grasp, image.camera), 0.8),)
            empty = np.zeros((0, 2))
            heat = np.zeros((300, 300), np.float32)
            reason = None if candidates else "nothing found"
            return Plan(candidates, reason, image, heat, None, empty, (), {}, image.camera, "stub 1", 0.0)

        return plan

    monkeypatch.setattr(judge, "ready_planner", make)
    monkeypatch.setattr(judge, "_WARM", set())
    return calls


def test_planners_are_executed_in_dart_and_judged_for_themselves(stubs, tmp_path):
    judged = judge_scene(item(("good", "bad", "none", "oracle"), tmp_path))
    assert not isinstance(judged, str)
    good, bad, none, oracle = judged.plans
    assert good.candidates[0].outcomes == ("SUCCESS", "SUCCESS") and good.weights == "stub 1"
    assert bad.candidates[0].outcomes == ("COLLISION", "COLLISION")
    assert none.candidates == () and none.reason == "nothing found"
    assert oracle.candidates[0].outcomes == ("SUCCESS", "SUCCESS")
    assert judged.scene.graspable and judged.scene.quality == 1.0 and judged.scene.probability == 0.7
    assert good.candidates[0].shift[0] is not None and bad.candidates[0].shift == (None, None)


def test_failures_leave_pictures_and_successes_do_not(stubs, tmp_path):
    judge_scene(item(("good", "bad", "none"), tmp_path))
    found = {path.relative_to(tmp_path).parts[0] for path in tmp_path.rglob("*.png")}
    assert found == {"bad", "none"}
    assert all(cv2.imread(str(path)) is not None for path in tmp_path.rglob("*.png"))


def test_on_an_ungraspable_scene_only_an_empty_plan_is_right(stubs, tmp_path):
    judged = judge_scene(item(("bad", "none"), tmp_path, graspable=False))
    assert not isinstance(judged, str) and not judged.scene.graspable and judged.scene.quality == 0
    assert [path.parent.name for path in tmp_path.rglob("*.png")] == ["bad"]


def test_the_same_scene_gives_the_same_outcomes_whatever_else_is_planned(stubs):
    alone = judge_scene(item(("good",)))
    among = judge_scene(item(("bad", "good", "oracle")))
    assert not isinstance(alone, str) and not isinstance(among, str)
    assert alone.plans[0].candidates == among.plans[1].candidates
    assert alone.scene == among.scene


def test_planners_of_one_rank_meet_the_same_noise(stubs):
    judged = judge_scene(item(("good", "bad")))
    assert not isinstance(judged, str)
    assert judged.plans[0].candidates[0].seeds == judged.plans[1].candidates[0].seeds


def test_the_first_plan_of_a_process_is_not_timed(stubs):
    judge_scene(item(("good",)))
    assert stubs == ["good", "good"]
    judge_scene(item(("good",)))
    assert stubs == ["good"] * 3


def test_planners_are_made_once_a_process():
    assert ready_planner("random", load_gripper(), "default") is ready_planner("random", load_gripper(), "default")
    with pytest.raises(ConfigError, match="random"):
        ready_planner("nothing", load_gripper(), "default")
