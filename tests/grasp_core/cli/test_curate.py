import json

import pytest

from grasp_core.cli import main
from grasp_core.dataset.store import DatasetStore


@pytest.fixture
def folder(labelled_dataset):
    return labelled_dataset(train=1)


def labels(folder):
    with DatasetStore.open(folder, readonly=True) as store:
        return [row[0] for row in store.rows("SELECT label FROM samples ORDER BY grasp")]


def test_relabelling_is_counted_done_and_undone(folder, capsys):
    before = labels(folder)
    command = ["dataset", "relabel", str(folder), "exclude", "--person", "ann", "--where.split", "test"]
    assert main([*command, "--dry-run"]) == 0
    assert "60 samples match, 60 change, 0 of them" in capsys.readouterr().out
    assert labels(folder) == before
    assert main([*command, "--reason", "a broken mesh"]) == 0
    assert labels(folder).count(None) == 60
    assert "60 label events added" in capsys.readouterr().out
    assert main(["dataset", "relabel", str(folder), "undo", "--person", "ann"]) == 0
    assert "60 label events were taken back" in capsys.readouterr().out
    assert labels(folder) == before


def test_wrong_decisions_are_one_line(folder, capsys):
    assert main(["dataset", "relabel", str(folder), "perhaps", "--person", "ann"]) == 2
    assert "bulk decision" in capsys.readouterr().err
    assert main(["dataset", "relabel", str(folder), "1.5", "--person", "ann"]) == 2
    assert "between 0 and 1" in capsys.readouterr().err


def test_people_and_their_agreement(folder, capsys):
    with DatasetStore.open(folder) as store:
        for grasp, ann, bob in ((1, 1.0, 1.0), (2, 0.0, 0.0), (3, 1.0, 0.0)):
            store.add_label(grasp, "ann", ann)
            store.add_label(grasp, "bob", "opinion", value=bob)
    assert main(["dataset", "people", str(folder)]) == 0
    assert "ann and bob: kappa 0.400 on 3 common samples" in capsys.readouterr().out
    assert main(["dataset", "people", str(folder), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["judged"] == {"ann": 3, "bob": 3} and told["accuracies"] == []


def test_scoring_keeps_scores_of_the_shipped_weights(folder, capsys):
    assert main(["dataset", "score", str(folder)]) == 0
    assert "3 scenes scored, 0 were before" in capsys.readouterr().out
    with DatasetStore.open(folder, readonly=True) as store:
        assert store.row("SELECT count(*) FROM samples WHERE score IS NULL OR heat IS NULL")[0] == 0
    assert main(["dataset", "score", str(folder)]) == 0
    assert "0 scenes scored, 3 were before" in capsys.readouterr().out
