import json

import cv2
import msgspec
import pytest

from grasp_core.cli import main
from grasp_core.errors import GraspError
from grasp_core.evaluation import crosscheck
from grasp_core.evaluation.crosscheck import Line, Plan, run_crosscheck
from grasp_core.evaluation.suites import object_plans
from grasp_core.gripper import load_gripper
from grasp_core.parallel import Executor
from grasp_core.simulation.physics import load_physics

SOURCES = [plan for plan in object_plans("trials", "keep", 0) if plan.name == "box_900"]
HERE = Executor(workers=0)


@pytest.fixture
def plan():
    pytest.importorskip("mujoco")
    return Plan(("box_900",), ("half", "mujoco"), 6, 2, 2, 2, 0, load_physics().digest, load_gripper().digest)


def run(plan, out, **rest):
    return run_crosscheck(SOURCES, plan, load_gripper(), load_physics(), out, HERE, **rest)


def test_report_covers_engines_objects_and_qualities(plan, tmp_path):
    seen = []
    result = run(plan, tmp_path, progress=lambda done, total: seen.append((done, total)))
    assert set(result.engines) == {"half", "mujoco"}
    for comparison in result.engines.values():
        assert comparison.all.count == 6
        assert comparison.objects["box_900"].count == 6
        assert 0 <= comparison.all.agreement <= 1
    assert result.qualities == 2
    assert -1 <= result.quality_correlation <= 1
    assert seen[0][0] == 0
    assert seen[-1][0] == seen[-1][1]


def test_a_killed_run_goes_on_where_it_was(plan, tmp_path, monkeypatch):
    whole = run(plan, tmp_path / "a")
    log = (tmp_path / "a" / "verdicts.jsonl").read_bytes().splitlines()
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "verdicts.jsonl").write_bytes(b"\n".join(log[:4]) + b"\n" + log[4][:20])
    calls = []
    real = crosscheck.judge
    monkeypatch.setattr(crosscheck, "judge", lambda work: calls.append(work.key) or real(work))
    again = run(plan, tmp_path / "b")
    assert len(calls) == len(log) - 4
    assert msgspec.json.encode(again) == msgspec.json.encode(whole).replace(b"/a/", b"/b/")
    calls.clear()
    assert msgspec.json.encode(run(plan, tmp_path / "b")) == msgspec.json.encode(again)
    assert calls == []


def test_another_plan_is_refused(plan, tmp_path):
    (tmp_path / "verdicts.jsonl").write_bytes(msgspec.json.encode(msgspec.structs.replace(plan, seed=1)) + b"\n")
    with pytest.raises(GraspError, match="belongs to another comparison"):
        run(plan, tmp_path)
    (tmp_path / "verdicts.jsonl").write_text("not a log\n")
    with pytest.raises(GraspError, match="belongs to another comparison"):
        run(plan, tmp_path)


def test_each_class_of_disagreement_has_a_picture(plan, tmp_path, monkeypatch):
    def judged(work):
        if work.noisy or work.pose:
            return Line(work.source.name, work.pose, work.engine, work.start)
        ends = ("SUCCESS", "SUCCESS", "SLIPPED") if work.engine == "dart" else ("SUCCESS", "SLIPPED", "SUCCESS")
        return Line(work.source.name, work.pose, work.engine, work.start, outcomes=ends)

    monkeypatch.setattr(crosscheck, "judge", judged)
    result = run(msgspec.structs.replace(plan, engines=("half",)), tmp_path)
    comparison = result.engines["half"]
    assert comparison.all.agreement == pytest.approx(1 / 3, abs=1e-4)
    assert comparison.all.confusion == {"SLIPPED→SUCCESS": 1, "SUCCESS→SLIPPED": 1, "SUCCESS→SUCCESS": 1}
    assert set(comparison.pictures) == {"SLIPPED→SUCCESS", "SUCCESS→SLIPPED"}
    for path in comparison.pictures.values():
        picture = cv2.imread(path)
        assert picture is not None
        assert picture.std() > 10
    assert result.quality_correlation is None


def test_unknown_engine_is_refused(plan, tmp_path):
    with pytest.raises(GraspError, match="'bullet' is no engine"):
        run(msgspec.structs.replace(plan, engines=("bullet",)), tmp_path)


def test_command_prints_tables_and_json(plan, tmp_path, capsys):
    suite = tmp_path / "one.yaml"
    suite.write_text("about: one box\nobjects:\n  names: [box_900]\n")
    words = ["crosscheck", "--objects", str(suite), "--engines", "half", "--grasps", "4", "--noisy", "0"]
    words += ["--out", str(tmp_path / "out"), "--workers", "0"]
    assert main(words) == 0
    assert "half the time step" in capsys.readouterr().out
    assert main([*words, "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["results"]["engines"]["half"]["all"]["count"] == 4
    assert main([*words, "--grasps", "0"]) == 2
    assert "--grasps" in capsys.readouterr().err
