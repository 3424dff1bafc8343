import msgspec
import pytest

from grasp_core.dataset.queries import Query
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import GraspError
from grasp_core.evaluation import mending
from grasp_core.evaluation.mending import (
    Experiment,
    copy_dataset,
    most_mistaken,
    retry,
    run_mending,
    spoil,
    training_labels,
)
from grasp_core.parallel import Executor
from grasp_core.simulation.physics import load_physics
from grasp_core.training.loop import Schedule
from grasp_core.training.refined import RefinedSettings

SETTINGS = RefinedSettings(Schedule(epochs=1, batch=32, rate=1e-3), width=4, pool=4)


def test_a_share_of_the_training_labels_is_flipped_once(labelled_dataset, tmp_path):
    source = labelled_dataset(train=2)
    before = training_labels(source)
    copy = copy_dataset(source, tmp_path / "copy")
    with DatasetStore.open(copy) as store:
        flipped = spoil(store, 0.1)
        assert spoil(store, 0.1) == flipped and len(flipped) == 12
    after = training_labels(copy)
    assert {grasp for grasp in before if after[grasp] != before[grasp]} == flipped
    assert all(after[grasp] == 1 - before[grasp] for grasp in flipped)
    assert training_labels(source) == before
    assert copy_dataset(source, copy) == copy and training_labels(copy) == after


def test_most_mistaken_are_those_whose_score_contradicts_the_label(labelled_dataset):
    with DatasetStore.open(labelled_dataset(train=1)) as store:
        labels = [row[0] for row in store.rows("SELECT label FROM samples WHERE split = 'train' ORDER BY grasp")]
        scores = [1 - label if index in (3, 7) else label for index, label in enumerate(labels)]
        store.add_predictions("w", "w", range(1, 61), scores)
        store.use_weights("w")
        assert sorted(most_mistaken(store, 2 / 60)) == [4, 8]


def test_the_whole_experiment_and_its_resumption(labelled_dataset, tmp_path, monkeypatch):
    source = labelled_dataset(train=2, test=0)
    truth = training_labels(source)
    tried = []

    def told_by_truth(store, chosen, attempts, executor, tell):
        """Stands for DART, which would need the toy scenes' physics: fresh attempts that agree with the truth."""
        tried.append((chosen, attempts))
        done = {event.grasp for event in store.events_of(mending.MENDER)}
        for grasp in chosen:
            if grasp not in done:
                store.add_label(grasp, mending.MENDER, truth[grasp])

    monkeypatch.setattr(mending, "retry", told_by_truth)
    experiment = Experiment(source, tmp_path / "out", SETTINGS, review=0.5, attempts=3)
    told = []
    found = run_mending(experiment, Executor(0), tell=told.append)
    assert (found.labels, found.spoiled, found.reviewed, found.chance) == (120, 12, 60, 6.0)
    assert found.mended == found.found and found.harmed == 0
    assert set(found.clean) == set(found.mended_measures) == set(mending.MEASURES)
    assert tried[0] == (tried[0][0], 3) and len(tried[0][0]) == 60
    again = run_mending(experiment, Executor(0))
    assert msgspec.to_builtins(again) == msgspec.to_builtins(found)


def test_fresh_attempts_become_the_label(labelled_dataset):
    physics = load_physics()
    with DatasetStore.open(labelled_dataset(train=1)) as store:
        with store.transaction() as db:
            for key, value in (("physics", physics), ("physics_digest", physics.digest)):
                db.execute("UPDATE meta SET value = ? WHERE key = ?", (msgspec.json.encode(value).decode(), key))
        good = store.page(Query(split="train", quality=(1.0, 1.0)), size=1).rows[0].id
        bad = store.page(Query(split="train", outcome="COLLISION"), size=1).rows[0].id
        told = []
        retry(store, [good, bad], 2, Executor(0), told.append)
        assert (store.grasp(good).label, store.grasp(bad).label) == (1.0, 0.0)
        assert store.grasp(good).attempts == store.grasp(bad).attempts == 7
        assert told == ["tried anew 1 of 1 scenes"]
        retry(store, [good, bad], 2, Executor(0), told.append)
        assert store.grasp(good).attempts == 7  # done before


def test_impossible_experiments_are_refused(tmp_path):
    for change in ({"spoil": 0.0}, {"review": 1.5}, {"attempts": 0}, {"seeds": ()}):
        with pytest.raises(GraspError):
            Experiment(tmp_path, tmp_path, SETTINGS, **change)
