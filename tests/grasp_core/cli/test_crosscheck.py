import json

import pytest

from grasp_core.cli import main


def test_report_of_one_object(tmp_path, capsys):
    pytest.importorskip("mujoco", reason="the extra crosscheck is not installed")
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
