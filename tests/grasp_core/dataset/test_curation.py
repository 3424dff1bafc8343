import pytest

from grasp_core.dataset.rows import AttemptRow
from grasp_core.errors import StoreError
from grasp_core.grasp import Grasp


def test_a_persons_grasp_has_provenance_and_no_label_until_verified(store):
    grasp = Grasp((0.01, 0.02, 0.03), 0.4, 0.1)
    new = store.add_grasp(1, grasp, person="ann", parent=2)
    row = store.grasp(new)
    assert (row.grasp, row.person, row.parent, row.origin) == (grasp, "ann", 2, "person")
    assert (row.label, row.state) == (None, "unlabelled")
    assert store.add_grasp(1, grasp, person="ann") == new
    store.add_attempts(new, [AttemptRow("SUCCESS", 1, (0.0, 0.0, 0.0, 0.0))], person="ann")
    assert store.grasp(new).label == 1.0
    digest = store.scene_digest(1)
    store.add_grasp(1, Grasp((0.0, 0.0, 0.03), 0.4, 0.1), person="ann")
    assert store.scene_digest(1) == digest
    with pytest.raises(StoreError, match="no scene"):
        store.add_grasp(9, grasp)


def test_views_are_replaced_by_name(store):
    store.save_view("worst", {"sort": "gap"}, "ann")
    store.save_view("worst", {"sort": "score"})
    assert store.views() == {"worst": {"sort": "score"}}
    store.delete_view("worst")
    assert store.views() == {}


def test_scores_never_set_labels_and_are_kept_per_weights(store):
    store.add_predictions("aaa", "first", [1, 2], [0.1, 0.9])
    assert store.grasp(1).score is None
    store.use_weights("aaa")
    assert store.grasp(1).score == 0.1
    assert store.row("SELECT gap FROM samples WHERE grasp = 1")[0] == pytest.approx(0.9)
    store.add_predictions("bbb", "second", [1], [0.7], [0.5])
    assert store.grasp(1).score == 0.1
    store.use_weights("bbb")
    assert (store.grasp(1).score, store.grasp(1).heat, store.grasp(2).score) == (0.7, 0.5, None)
    store.add_predictions("bbb", "second", [2], [0.4])
    assert store.grasp(2).score == 0.4
    assert [store.grasp(i).label for i in (1, 2)] == [1.0, 0.8]
    with pytest.raises(StoreError, match="aaa, bbb"):
        store.use_weights("ccc")
    assert store.meta.weights == "bbb"


def test_people_are_listed_once(store):
    store.add_label(1, "ann", 1.0)
    store.add_label(2, "bob", 1.0)
    store.add_label(3, " ann ", 1.0)
    assert store.people() == ["ann", "bob"]
