import json
import sys

import platformdirs

from grasp_core.cli import main


def test_report_of_one_object(tmp_path, capsys):
    suite = tmp_path / "one.yaml"
    suite.write_text("about: one box\nobjects: {first: 900, families: {box: 1}}\n")
    arguments = ["--objects", str(suite), "--engines", "half", "--grasps", "2", "--noisy", "0", "--workers", "0"]
    assert main(["crosscheck", *arguments, "--out", str(tmp_path / "out"), "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["benchmark"] == "crosscheck"
    assert report["results"]["engines"]["half"]["all"]["count"] == 2


def test_impossible_counts_are_refused(capsys):
    assert main(["crosscheck", "--grasps", "0"]) == 2
    assert "--grasps" in capsys.readouterr().err


def test_half_the_step_needs_no_mujoco_and_each_plan_has_its_folder(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    monkeypatch.setattr(platformdirs, "user_data_dir", lambda name: str(tmp_path / name))
    suite = tmp_path / "one.yaml"
    suite.write_text("about: one box\nobjects: {first: 900, families: {box: 1}}\n")
    arguments = ["--objects", str(suite), "--engines", "half", "--grasps", "2", "--noisy", "1", "--workers", "0"]
    assert main(["crosscheck", *arguments]) == 0
    assert main(["crosscheck", *arguments, "--seed", "1"]) == 0
    told = capsys.readouterr().out
    assert "outcomes, half in columns" in told
    assert len(list((tmp_path / "grasp-workbench" / "crosscheck").glob("*/verdicts.jsonl"))) == 2


def test_the_reference_is_no_engine_to_compare(capsys):
    assert main(["crosscheck", "--engines", "dart"]) == 2
    assert "'dart' is what the other engines are compared with" in capsys.readouterr().err
