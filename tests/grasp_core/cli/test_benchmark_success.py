import json

import pytest

from grasp_core.cli import main
from grasp_core.evaluation import cache, judge, success
from grasp_core.evaluation.oracle import ScoredGrasp, Verified
from grasp_core.grasp import Grasp
from grasp_core.simulation.evidence import Evidence, Outcome
from grasp_core.simulation.settling import StablePose
from grasp_core.simulation.trial import Attempt


class FailingTrial:
    """Stands for the simulation, which has tests of its own."""

    def __init__(self, *_: object) -> None:
        pass

    def attempt(self, grasp: Grasp, seed: int) -> Attempt:
        return Attempt(Outcome.MISSED, seed, grasp, False, Evidence(words=""))


@pytest.fixture(autouse=True)
def quick(tmp_path, monkeypatch):
    import numpy as np

    def rest(asset, physics):
        pose = np.eye(4)
        pose[2, 3] = -asset.vertices[:, 2].min()
        return [StablePose(pose, 1.0)]

    def know(asset, pose, *_):
        return Verified(pose.tolist(), (ScoredGrasp(Grasp((0, 0, 0.02), 0, 0.1), 1.0),), 1, False)

    monkeypatch.setattr(cache, "folder", lambda: tmp_path / "cache")
    monkeypatch.setattr(success, "poses_of", rest)
    monkeypatch.setattr(success, "verified_grasps", know)
    monkeypatch.setattr(judge, "GraspTrial", FailingTrial)


@pytest.fixture
def command(tmp_path):
    suite = tmp_path / "bars.yaml"
    suite.write_text("about: quick ones\nobjects: {names: [box_900]}\n")
    return ["benchmark", "success", "--objects", str(suite), "--workers", "0", "--attempts", "2"]


def test_json_is_one_object_with_the_keys_of_the_contract(command, capsys):
    assert main([*command, "--poses", "2", "--planner", "random", "oracle", "--json"]) == 0
    out = capsys.readouterr().out
    report = json.loads(out)
    assert out.count("\n") == 1
    assert {"benchmark", "machine", "versions", "seed", "results"} <= set(report)
    assert report["benchmark"] == "success" and report["seed"] == 0
    assert list(report["results"]) == ["random", "oracle"]
    for figures in report["results"].values():
        assert figures["top1"]["attempts"] == 2 and figures["top1"]["rate"] == 0.0
        assert figures["graspable"] == figures["scenes"] == 1
    assert report["settings"]["attempts"] == 2 and report["refused"] == {}


def test_words_for_people_and_the_folder_of_the_run(command, capsys, tmp_path):
    out = tmp_path / "run"
    assert main([*command, "--planner", "random", "--out", str(out)]) == 0
    shown = capsys.readouterr().out
    assert "top-1" in shown and "box_900" in shown and "MISSED 2" in shown
    assert (out / "outcomes.jsonl").is_file() and (out / "failures" / "random" / "sheet.png").is_file()

    assert main([*command, "--planner", "random", "--out", str(out)]) == 2
    assert "--resume" in capsys.readouterr().err
    assert main([*command, "--planner", "random", "oracle", "--out", str(out), "--resume"]) == 0
    assert len((out / "outcomes.jsonl").read_text().splitlines()) == 5  # run, scene, plan, the run with both, plan


def test_a_log_of_other_settings_is_not_gone_on_with(command, capsys, tmp_path):
    out = str(tmp_path / "run")
    assert main([*command, "--planner", "oracle", "--out", out]) == 0
    assert main([*command, "--planner", "oracle", "--out", out, "--resume", "--seed", "1"]) == 2
    assert "other seed" in capsys.readouterr().err


def test_a_planners_file_that_was_changed_is_not_gone_on_with(command, capsys, tmp_path):
    out, mine = str(tmp_path / "run"), tmp_path / "mine.yaml"
    mine.write_text("planner: random\n")
    assert main([*command, "--planner", str(mine), "--out", out]) == 0
    mine.write_text("planner: random\ndrawn: 17\n")
    judge.ready_planner.cache_clear()  # as in a new process
    assert main([*command, "--planner", str(mine), "--out", out, "--resume"]) == 2
    assert "mine.yaml" in capsys.readouterr().err


def test_an_old_log_is_reported_but_not_gone_on_with(command, capsys, tmp_path):
    out = tmp_path / "run"
    assert main([*command, "--planner", "random", "--out", str(out)]) == 0
    lines = [json.loads(line) for line in (out / "outcomes.jsonl").read_text().splitlines()]
    del lines[0]["planners"]
    (out / "outcomes.jsonl").write_text("".join(json.dumps(line) + "\n" for line in lines))
    assert main([*command, "--planner", "random", "--out", str(out), "--resume"]) == 0
    assert "MISSED 2" in capsys.readouterr().out
    assert main([*command, "--planner", "random", "oracle", "--out", str(out), "--resume"]) == 2
    assert "another folder" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--planner", "nothing"], "nothing"),
        (["--scale", "huge"], "--scale"),
        (["--attempts", "0"], "--attempts"),
        (["--resume"], "--out"),
        (["--objects", "no-such-suite"], "no-such-suite"),
        (["--physics", "no-such-physics"], "no-such-physics"),
    ],
)
def test_wrong_arguments_are_refused_in_one_line(command, words, message, capsys):
    assert main([*command, "--planner", "oracle", *words]) == 2
    captured = capsys.readouterr()
    assert captured.out == "" and message in captured.err and captured.err.count("\n") == 1
