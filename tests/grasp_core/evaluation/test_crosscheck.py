import json

import cv2
import msgspec
import pytest

from grasp_core.cli import main
from grasp_core.errors import GraspError
from grasp_core.evaluation import crosscheck
from grasp_core.evaluation.crosscheck import run_crosscheck
from grasp_core.evaluation.suites import object_plans
from grasp_core.evaluation.verdicts import Line, make_plan
from grasp_core.gripper import load_gripper
from grasp_core.parallel import Executor
from grasp_core.simulation.physics import load_physics

SOURCES = [plan for plan in object_plans("trials", "keep", 0) if plan.name == "box_900"]
HERE = Executor(workers=0)


def planned(*engines):
    numbers = {"grasps": 6, "poses": 2, "noisy": 2, "attempts": 2, "seed": 0}
    return make_plan(SOURCES, engines, load_gripper(), load_physics(), **numbers)


@pytest.fixture
def plan():
    pytest.importorskip("mujoco")
    return planned("half", "mujoco")


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
    assert result.quality_correlation is None or -1 <= result.quality_correlation <= 1
    assert set(result.goals) == {"half", "mujoco", "correlation", "unstable"}
    assert result.unstable["dart"].executions == 6 + 2 * 2
    assert result.unstable["half"].executions == 6
    assert result.goals["unstable"].met
    assert result.goals["half"].low < result.goals["half"].figure <= result.goals["half"].high
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


def judged_as(monkeypatch, dart, other, qualities=None):
    """Verdicts by hand: on the first pose, of six grasps; qualities by engine."""

    def judged(work):
        line = Line(*work.key)
        if work.pose:
            return line
        if work.noisy:
            return msgspec.structs.replace(line, qualities=qualities[work.engine], diverged=1)
        return msgspec.structs.replace(line, outcomes=dart if work.engine == "dart" else other)

    monkeypatch.setattr(crosscheck, "judge", judged)


def test_each_class_of_disagreement_has_a_picture(tmp_path, monkeypatch):
    judged_as(monkeypatch, ("SUCCESS", "SUCCESS", "SLIPPED"), ("SUCCESS", "SLIPPED", "MISSED"))
    result = run(planned("half"), tmp_path)
    comparison = result.engines["half"]
    assert comparison.all.agreement == pytest.approx(2 / 3, abs=1e-4)
    assert comparison.all.confusion == {"SLIPPED→MISSED": 1, "SUCCESS→SLIPPED": 1, "SUCCESS→SUCCESS": 1}
    assert set(comparison.pictures) == set(comparison.disagreements) == {"SLIPPED→MISSED", "SUCCESS→SLIPPED"}
    for path in comparison.pictures.values():
        picture = cv2.imread(path)
        assert picture is not None
        assert picture.std() > 10
    assert result.quality_correlation is None
    assert set(result.goals) == {"half", "unstable"}
    assert result.goals["half"].met is False


def test_diverged_executions_are_no_verdicts(tmp_path, monkeypatch):
    judged_as(monkeypatch, ("SUCCESS", "UNSTABLE", "SUCCESS", "SLIPPED"), ("SUCCESS", "SUCCESS", "UNSTABLE", "SLIPPED"))
    result = run(planned("half"), tmp_path)
    comparison = result.engines["half"]
    assert comparison.all.count == comparison.objects["box_900"].count == 2
    assert comparison.all.agreement == 1.0
    assert comparison.left_out == 0.5
    assert comparison.pictures == {}
    assert (result.unstable["dart"].diverged, result.unstable["dart"].executions) == (1, 4)
    assert result.goals["unstable"].figure == 0.25
    assert result.goals["unstable"].met is False
    judged_as(monkeypatch, ("UNSTABLE",), ("SUCCESS",))
    with pytest.raises(GraspError, match="diverged on every grasp"):
        run(planned("half"), tmp_path / "other")


@pytest.mark.parametrize(
    ("dart", "mujoco", "figure", "difference"),
    [
        ((1.0, 0.5, 0.0, 0.5), (1.0, 0.5, 0.0, 0.5), 1.0, 0.0),
        ((1.0, 1.0, 1.0, 1.0), (1.0, 0.5, 0.0, 0.5), None, 0.5),
        ((1.0, 1.0, None, 1.0), (1.0, 1.0, 0.0, 1.0), None, 0.0),
        ((1.0, 0.5, 0.0, None), (0.0, 0.5, 1.0, 1.0), -1.0, 0.6667),
    ],
)
def test_a_correlation_of_equal_qualities_is_undefined(dart, mujoco, figure, difference, plan, tmp_path, monkeypatch):
    judged_as(monkeypatch, ("SUCCESS",), ("SUCCESS",), {"dart": dart, "mujoco": mujoco})
    result = run(plan, tmp_path)
    assert result.quality_correlation == figure
    assert result.quality_difference == difference
    assert result.goals["correlation"].met == (None if figure is None else figure >= 0.95)
    assert result.unstable["mujoco"].diverged == 1
    assert b"NaN" not in json.dumps(msgspec.to_builtins(result)).encode()


def test_the_interval_of_a_correlation_is_fishers():
    goal = crosscheck._correlation(0.97, 260)
    assert (goal.low, goal.high) == (pytest.approx(0.9618, abs=1e-3), pytest.approx(0.9765, abs=1e-3))
    assert goal.met


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
