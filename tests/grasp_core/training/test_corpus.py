from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from grasp_core.dataset.rows import GraspTable
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import StoreError
from grasp_core.gripper import load_gripper
from grasp_core.training.corpus import digest_of, grasp_labels, load_corpus
from grasp_core.training.scenes import Views

Maker = Callable[..., Path]


def test_reads_the_three_splits_and_what_weights_must_remember(labelled_dataset: Maker) -> None:
    folder = labelled_dataset(train=3)
    corpus = load_corpus(folder, Views(), progress=False)
    assert [len(split) for split in (corpus.train, corpus.validation, corpus.test)] == [3, 1, 1]
    assert {scene.object for scene in corpus.train}.isdisjoint({scene.object for scene in corpus.validation})
    assert corpus.gripper.digest == load_gripper().digest
    with DatasetStore.open(folder, readonly=True) as store:
        assert corpus.physics == store.meta.physics_digest
    assert corpus.recipe["objects"] == corpus.recipe["scenes"] == corpus.recipe["images"] == 3
    assert corpus.recipe["grasps"] == 180
    scene = corpus.train[0]
    assert 0 < np.mean(scene.labels) < 0.7
    assert scene.colliding.any()
    good = np.rint(scene.perfect).astype(int)
    assert np.mean(scene.depth[good[:, 1], good[:, 0]] < 0.67) > 0.8  # most lie on the bar


def test_further_views_are_in_every_split_and_repeat_with_the_seed(labelled_dataset: Maker) -> None:
    folder = labelled_dataset(train=2)
    views = Views(count=2, tilted=0.5)
    first, second, third = (load_corpus(folder, views, seed=seed, progress=False) for seed in (0, 0, 1))
    assert len(first.train) == 6
    assert len(first.validation) == 3
    assert first.digest == second.digest != third.digest


def test_digest_follows_labels(labelled_dataset: Maker) -> None:
    corpus = load_corpus(labelled_dataset(train=1), Views(), progress=False)
    scene = corpus.train[0]
    before = digest_of([scene])
    scene.labels[0] = 0.5
    assert digest_of([scene]) != before


def test_only_attempts_that_all_collided_count_as_colliding() -> None:
    whole = np.array([5, 5, 5, 0])
    zeros = np.zeros(4)
    table = GraspTable(
        id=whole,
        number=whole,
        position=np.zeros((4, 3)),
        angle=zeros,
        width=zeros,
        attempts=whole,
        successes=whole,
        collisions=np.array([5, 4, 5, 0]),
        missed=whole,
        slipped=whole,
        quality=zeros,
        label=np.array([0.0, 0.2, 1.0, np.nan]),
        human=np.array([False, False, True, False]),
        score=zeros,
        heat=zeros,
    )
    np.testing.assert_array_equal(grasp_labels(table).colliding, [True, False, False, False])


def test_empty_splits_are_refused(labelled_dataset: Maker) -> None:
    with pytest.raises(StoreError, match="validation split"):
        load_corpus(labelled_dataset(train=1, validation=0), Views(), progress=False)


def test_labels_are_curated_or_attempts_alone(labelled_dataset: Maker) -> None:
    folder = labelled_dataset(train=1)
    with DatasetStore.open(folder) as store:
        before = store.grasp(1).label
        assert before in (0.0, 1.0)
        store.add_label(1, "ann", 1 - before)
        store.add_label(2, "ann", "exclude")
    curated = load_corpus(folder, Views(), progress=False)
    dart = load_corpus(folder, Views(), labels="dart", progress=False)
    assert len(dart.train[0].labels) == len(curated.train[0].labels) + 1 == 60
    assert (curated.train[0].labels[0], dart.train[0].labels[0]) == (1 - before, before)
    assert (curated.recipe["labels"], dart.recipe["labels"]) == ("curated", "dart")
