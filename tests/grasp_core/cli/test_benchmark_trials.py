import json

import pytest

from grasp_core.cli import main

KEYS = {
    "attempts_per_second_per_core",
    "dynamic_attempts_per_second_per_core",
    "mujoco_dynamic_attempts_per_second_per_core",
    "outcomes",
    "two_process_speedup",
}


@pytest.fixture
def suite(tmp_path):
    pytest.importorskip("mujoco")
    path = tmp_path / "one.yaml"
    path.write_text("about: one box\nobjects:\n  names: [box_900]\n")
    return path


def test_json_follows_the_contract(suite, capsys):
    assert main(["benchmark", "trials", "--objects", str(suite), "--share", "0.01", "--no-two", "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert set(report) >= {"benchmark", "machine", "versions", "seed", "results"}
    assert report["benchmark"] == "trials"
    assert set(report["results"]) >= KEYS
    assert sum(report["results"]["outcomes"].values()) == 35


def test_words_name_every_object(suite, capsys):
    rest = ["--objects", str(suite), "--share", "0.01", "--attempts", "1", "--no-two"]
    assert main(["benchmark", "trials", *rest]) == 0
    out = capsys.readouterr().out
    assert "box_900" in out
    assert "MuJoCo is" in out


def test_unknown_suite_is_one_line(capsys):
    assert main(["benchmark", "trials", "--objects", "nothing"]) == 2
    printed = capsys.readouterr()
    assert "nothing" in printed.err
    assert printed.out == ""
