import dataclasses

import numpy as np
import pytest

from grasp_core.camera import load_camera
from grasp_core.errors import ConfigError
from grasp_core.evaluation import judge, success
from grasp_core.evaluation.benchmark import Benchmark
from grasp_core.evaluation.oracle import ScoredGrasp, Verified
from grasp_core.evaluation.success import run_benchmark
from grasp_core.evaluation.summary import summarise
from grasp_core.grasp import Grasp
from grasp_core.gripper import load_gripper
from grasp_core.parallel import Executor
from grasp_core.simulation.evidence import Comfort, Evidence, Outcome
from grasp_core.simulation.physics import load_physics
from grasp_core.simulation.settling import StablePose
from grasp_core.simulation.trial import Attempt

HERE = Executor(workers=0)


class QuickTrial:
    """Stands for the simulation, which has tests of its own: an outcome that follows from grasp and seed alone."""

    def __init__(self, *_: object) -> None:
        pass

    def attempt(self, grasp: Grasp, seed: int) -> Attempt:
        outcome = Outcome.SUCCESS if (seed + int(1e6 * abs(grasp.position[0]))) % 3 else Outcome.SLIPPED
        return Attempt(outcome, seed, grasp, True, Evidence(words=""), Comfort(0.001, 0.0))


@pytest.fixture(autouse=True)
def quick(tmp_path, monkeypatch):
    """No physics: objects rest as they are made, the oracle knows one grasp, executions are drawn."""

    def rest(asset, physics):
        poses = []
        for turn in (np.eye(4), np.diag([1.0, -1.0, -1.0, 1.0])):
            turn[2, 3] = -(asset.vertices @ turn[2, :3]).min()
            poses.append(StablePose(turn, 0.5))
        return poses

    def know(asset, pose, *_):
        return Verified(pose.tolist(), (ScoredGrasp(Grasp((0, 0, 0.02), 0, 0.1), 1.0),), 1, False)

    monkeypatch.setattr(success, "poses_of", rest)
    monkeypatch.setattr(success, "verified_grasps", know)
    monkeypatch.setattr(judge, "GraspTrial", QuickTrial)


@pytest.fixture
def bars(tmp_path):
    path = tmp_path / "bars.yaml"
    path.write_text("about: quick ones\nobjects: {names: [box_900, glue_stick_900]}\n")
    return str(path)


def benchmark(objects: str, **changes) -> Benchmark:
    values = {"planners": ("random", "oracle"), "poses": 1, "attempts": 1}
    return Benchmark(
        objects, camera=load_camera("primesense"), gripper=load_gripper(), physics=load_physics(), **(values | changes)
    )


def test_every_planner_is_judged_on_every_scene_and_nothing_is_done_twice(bars, tmp_path, monkeypatch):
    out = tmp_path / "out"
    told = []
    log, refused = run_benchmark(benchmark(bars), out, HERE, lambda *words: told.append(words))
    assert not refused
    assert len(log.scenes) == 2 and len(log.plans) == 4
    assert told[-1] == ("scenes", 2, 2) and {stage for stage, *_ in told} == {"objects", "oracle", "scenes"}
    for (_, planner), plan in log.plans.items():
        assert plan.candidates or plan.reason
        for candidate in plan.candidates:
            assert len(candidate.outcomes) == 1 and candidate.seeds[0] >= 2**62
        if planner == "oracle":
            assert len(plan.candidates) <= 5
    before = (out / "outcomes.jsonl").read_bytes()

    monkeypatch.setattr(success, "judge_scene", None)  # a second judgement would fail
    again, _ = run_benchmark(benchmark(bars), out, HERE)
    assert (out / "outcomes.jsonl").read_bytes() == before
    assert summarise(again, 1) == summarise(log, 1)


def test_a_run_cut_short_ends_as_one_that_was_not(bars, tmp_path):
    whole, _ = run_benchmark(benchmark(bars), tmp_path / "whole", HERE)
    lines = (tmp_path / "whole" / "outcomes.jsonl").read_bytes().splitlines(keepends=True)
    cut = tmp_path / "cut" / "outcomes.jsonl"
    cut.parent.mkdir()
    cut.write_bytes(b"".join(lines[:3]) + lines[3][:40])
    resumed, _ = run_benchmark(benchmark(bars), cut.parent, HERE)
    assert resumed.scenes == whole.scenes
    for key, plan in whole.plans.items():
        assert resumed.plans[key].candidates == plan.candidates


def test_the_oracle_can_be_added_to_a_run_later(bars, tmp_path):
    run_benchmark(benchmark(bars, planners=("random",), limit=1), tmp_path / "out", HERE)
    log, _ = run_benchmark(benchmark(bars, limit=1), tmp_path / "out", HERE)
    assert [planner for _, planner in log.plans] == ["random", "oracle"]


def test_limit_and_poses_choose_scenes(bars):
    log, _ = run_benchmark(benchmark(bars, planners=("oracle",), limit=1), None, HERE)
    assert [scene.spec.object for scene in log.scenes.values()] == ["box_900"]
    log, _ = run_benchmark(benchmark(bars, planners=("oracle",), poses=2, draws=2, limit=3), None, HERE)
    names = [(scene.spec.object, scene.spec.draw) for scene in log.scenes.values()]
    assert names == [("box_900", 0), ("glue_stick_900", 0), ("box_900", 1)]


def test_an_object_that_cannot_be_used_is_named_and_the_others_go_on(tmp_path):
    import trimesh

    folder = tmp_path / "meshes"
    folder.mkdir()
    trimesh.creation.box((0.12, 0.04, 0.03)).export(folder / "good.stl")
    (folder / "bad.obj").write_text("v 0 0 0\n")
    log, refused = run_benchmark(benchmark(str(folder), planners=("oracle",)), None, HERE)
    assert [scene.spec.object for scene in log.scenes.values()] == ["good"]
    assert list(refused) == ["bad"] and refused["bad"]


def test_an_object_too_big_for_the_camera_is_left_out_by_scene(bars):
    tiny = load_camera("canonical")
    small_view = dataclasses.replace(tiny, intrinsics=type(tiny.intrinsics)(9000.0, 9000.0, 149.5, 149.5, 300, 300))
    log, refused = run_benchmark(
        dataclasses.replace(benchmark(bars, planners=("oracle",)), camera=small_view), None, HERE
    )
    assert not log.scenes and len(refused) == 2
    assert all("wider or higher camera" in why for why in refused.values())


def test_an_unknown_planner_is_refused_before_any_work(bars, monkeypatch):
    monkeypatch.setattr(success, "object_plans", None)
    with pytest.raises(ConfigError, match="cascde"):
        run_benchmark(benchmark(bars, planners=("cascde",)), None, HERE)


def test_other_seeds_place_objects_elsewhere(bars):
    poses = []
    for seed in (0, 1):
        log, _ = run_benchmark(benchmark(bars, planners=("oracle",), limit=1, seed=seed), None, HERE)
        poses.append(np.array(next(iter(log.scenes.values())).world_from_object))
    assert not np.allclose(poses[0], poses[1])
