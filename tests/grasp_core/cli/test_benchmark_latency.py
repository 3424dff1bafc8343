import json

import pytest

from grasp_core.cli import main
from grasp_core.evaluation import latency
from grasp_core.evaluation.latency import Latency, Timing


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    """The measuring has tests of its own."""

    def run(images, gripper, gripper_name, weights, repeats, seed):
        timing = Timing(12.0, 15.0, 64.0, {"rectify": 3.0, "scores": 8.0})
        backends = {"openvino": timing, "torch": Timing(20.0, 25.0, 64.0, {})}
        return Latency(
            12.0,
            15.0,
            64.0,
            "openvino",
            timing.stages_ms,
            600.0,
            3000.0,
            50.0,
            300.0,
            1500.0,
            25.0,
            timing,
            2500.0,
            backends,
            len(images),
            repeats,
            weights,
        )

    monkeypatch.setattr(latency, "make_images", lambda objects, camera, physics, noise, count, seed: [None] * count)
    monkeypatch.setattr(latency, "run_latency", run)


def test_json_is_one_object_with_the_keys_of_the_contract(capsys):
    assert main(["benchmark", "latency", "--json", "--images", "3", "--repeats", "2", "--weights", "mine"]) == 0
    out = capsys.readouterr().out
    report = json.loads(out)
    assert out.count("\n") == 1 and report["benchmark"] == "latency"
    results = report["results"]
    assert {"median_ms", "p95_ms", "candidates", "backend", "stages_ms", "exhaustive_median_ms"} <= set(results)
    assert (results["images"], results["repeats"], results["weights"]) == (3, 2, "mine")
    assert results["backends"]["torch"]["median_ms"] == 20.0


def test_words_for_people(capsys):
    assert main(["benchmark", "latency"]) == 0
    shown = capsys.readouterr().out
    assert "cascade, openvino" in shown and "rectify" in shown and "50 times" in shown and "2.5 s" in shown


@pytest.mark.parametrize("words", [["--images", "0"], ["--repeats", "0"]])
def test_nothing_to_measure_is_refused(words, capsys):
    assert main(["benchmark", "latency", *words]) == 2
    assert words[0] in capsys.readouterr().err
