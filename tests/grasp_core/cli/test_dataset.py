import json

import pytest

from grasp_core.cli import main
from grasp_core.dataset.generate import generate
from grasp_core.dataset.recipe import Objects, Recipe
from grasp_core.dataset.store import DatasetStore
from grasp_core.parallel import Executor


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    path = tmp_path_factory.mktemp("d") / "data"
    recipe = Recipe(name="tiny", train=Objects(families={"box": 1}), poses=1, grid=2, angles=1, attempts=2)
    generate(recipe, path, Executor(workers=0))
    return path


def test_info(dataset, capsys):
    assert main(["dataset", "info", str(dataset)]) == 0
    text = capsys.readouterr().out
    assert "1 train, 0 validation, 0 test" in text and "4, with 8 attempts" in text
    assert main(["dataset", "info", str(dataset), "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["grasps"] == 4 and result["attempts"] == 8 and result["categories"] == {"box": 1}


def test_verify_finds_and_mends(dataset, capsys):
    assert main(["dataset", "verify", str(dataset)]) == 0
    assert "nothing is wrong" in capsys.readouterr().out
    with DatasetStore.open(dataset) as store, store.transaction() as db:
        db.execute("UPDATE samples SET label = 0.123")
    assert main(["dataset", "verify", str(dataset), "--json"]) == 2
    result = json.loads(capsys.readouterr().out)
    assert result["content"] is None and "rule" in result["findings"][0]["problem"]
    assert main(["dataset", "verify", str(dataset), "--mend"]) == 0


def test_missing_dataset_is_a_clear_error(tmp_path, capsys):
    for command in ("info", "verify"):
        assert main(["dataset", command, str(tmp_path)]) == 2
        assert "holds no dataset" in capsys.readouterr().err


def test_archive_restore_and_merge(dataset, tmp_path, capsys):
    archive = tmp_path / "tiny.npz.xz"
    assert main(["dataset", "archive", str(dataset), str(archive)]) == 0
    assert archive.stat().st_size < 100_000
    for flags, folder in (([], "whole"), (["--sample"], "sample")):
        out = tmp_path / folder
        assert main(["dataset", "restore", str(archive), "--out", str(out), "--workers", "0", *flags]) == 0
        with DatasetStore.open(out, readonly=True) as a, DatasetStore.open(dataset, readonly=True) as b:
            assert a.labels_digest() == b.labels_digest()
    capsys.readouterr()
    assert main(["dataset", "merge", str(tmp_path / "whole"), str(tmp_path / "sample")]) == 0
    assert "0 objects, 0 scenes and 0 label events added, 1 scenes were there" in capsys.readouterr().out


def test_export_and_import(dataset, tmp_path, capsys):
    with DatasetStore.open(dataset) as store:
        store.add_label(1, "ann", 0.5)
    assert main(["dataset", "export", str(dataset), str(tmp_path / "e.jsonl")]) == 0
    assert main(["dataset", "import", str(dataset), str(tmp_path / "e.jsonl")]) == 0
    assert "0 label events added, 1 were there" in capsys.readouterr().out


def test_stats(dataset, tmp_path, capsys):
    assert main(["dataset", "stats", str(dataset), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["attempts"] == 8
    assert main(["dataset", "stats", str(dataset)]) == 0
    assert "outcomes" in capsys.readouterr().out
