import json
from collections.abc import Callable
from pathlib import Path

import pytest

from grasp_core.cli import main
from grasp_core.networks.weights import load_weights

Maker = Callable[..., Path]

REFINED = """
width: 4
crop: {size: 32, context: 1.4}
pool: 4
schedule: {epochs: 2, batch: 32, rate: 4.0e-3}
"""
REGRESSION = """
schedule: {epochs: 1, batch: 4, rate: 4.0e-3}
views: {count: 1, tilted: 0.5}
"""


@pytest.fixture
def settings(tmp_path: Path) -> tuple[str, str]:
    for name, text in (("refined", REFINED), ("regression", REGRESSION)):
        (tmp_path / f"{name}.yaml").write_text(text)
    return str(tmp_path / "regression.yaml"), str(tmp_path / "refined.yaml")


def test_trains_both_and_packs_weights(
    labelled_dataset: Maker, tmp_path: Path, settings: tuple[str, str], capsys: pytest.CaptureFixture[str]
) -> None:
    dataset, run = labelled_dataset(), tmp_path / "run"
    shared = ["--dataset", str(dataset), "--out", str(run), "--threads", "1", "--json"]
    assert main(["train", "all", *shared, "--regression", settings[0], "--refined", settings[1]]) == 0
    printed = json.loads(capsys.readouterr().out)
    meta = load_weights(run / "weights.safetensors").meta
    assert meta.width == 4
    assert meta.crop.size == 32
    assert {"refined_auc", "refined_test_auc", "regression_hit", "regression_test_hit"} <= set(meta.metrics)
    assert printed["refined_auc"] == meta.metrics["refined_auc"]
    assert meta.recipe["refined_objects"] == 4
    assert (run / "refined.csv").read_text().count("\n") == 3

    assert main(["train", "pack", "--out", str(tmp_path / "mine.safetensors"), "--regression", str(run)]) == 0
    assert "mine" in capsys.readouterr().out

    weights = str(tmp_path / "mine.safetensors")
    seen = ["--dataset", str(dataset), "--out", str(tmp_path / "seen"), "--weights", weights, "--views", "0"]
    assert main(["train", "assess", *seen, "--json"]) == 0
    assessed = json.loads(capsys.readouterr().out)
    assert set(assessed["objects"]) == {"bar_004"}
    assert assessed["totals"]["grasps"] == 60
    assert (tmp_path / "seen" / "refined.png").is_file()
    assert (tmp_path / "seen" / "regression.png").is_file()
    assert main(["train", "assess", *seen, "--split", "test"]) == 0
    assert "bar_005" in capsys.readouterr().out

    # The same command again does nothing new; another length is another run.
    assert main(["train", "refined", *shared, "--settings", settings[1]]) == 0
    assert json.loads(capsys.readouterr().out)["auc"] == meta.metrics["refined_auc"]
    assert main(["train", "refined", *shared, "--settings", settings[1], "--epochs", "1"]) == 2
    assert "other settings or data" in capsys.readouterr().err


def test_missing_dataset_and_settings_are_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    nowhere = ["--dataset", str(tmp_path / "none"), "--out", str(tmp_path / "run")]
    assert main(["train", "regression", *nowhere]) == 2
    assert "none" in capsys.readouterr().err
    assert main(["train", "refined", *nowhere, "--settings", "no_such"]) == 2
    assert "refined" in capsys.readouterr().err
