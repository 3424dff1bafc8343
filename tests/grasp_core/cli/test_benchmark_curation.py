import json

from grasp_core.cli import main


def test_json_follows_the_contract(tmp_path, capsys):
    out = tmp_path / "made"
    command = ["benchmark", "curation", "--samples", "1500", "--repeat", "1", "--out", str(out), "--json"]
    for _ in range(2):  # the second run uses the dataset of the first
        assert main(command) == 0
        report = json.loads(capsys.readouterr().out)
        assert report["benchmark"] == "curation" and set(report) >= {"machine", "versions", "seed", "results"}
        results = report["results"]
        assert results["samples"] == 3 * 726
        assert results["worst_filter_ms"] == max(times["most_ms"] for times in results["filter_ms"].values())


def test_nothing_is_kept_by_default(capsys):
    assert main(["benchmark", "curation", "--samples", "100", "--repeat", "1"]) == 0
    printed = capsys.readouterr()
    assert "filter split" in printed.out and "made 1 of 1 scenes" in printed.err


def test_impossible_numbers_are_one_line(capsys):
    assert main(["benchmark", "curation", "--samples", "0"]) == 2
    assert "--samples" in capsys.readouterr().err
