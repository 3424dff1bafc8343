import pytest

from grasp_core.dataset.labels import LabelConflict
from grasp_core.dataset.rows import AttemptRow
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import StoreError


def attempt(outcome, seed):
    return AttemptRow(outcome, seed, (0.0, 0.0, 0.02, 0.0))


def test_decision_is_recorded_and_applied(store):
    event = store.add_label(2, "ann", 0.0, reason="the rim bends", note="look at the rim")
    assert (event.old_value, event.new_value, event.person) == (0.8, 0.0, "ann")
    assert store.history(2) == [event]
    assert store.grasp(2).label == 0.0
    assert store.current(2).reason == "ann set 0"
    assert store.events_of("ann") == [event]


def test_label_survives_closing_without_a_word(store):
    path = store.path
    store.add_label(1, "ann", 0.25)
    other = DatasetStore.open(path)  # as after a kill: the first connection was never closed
    assert other.current(1).value == 0.25
    other.close()


def test_undo_redo_and_batches(store):
    for grasp in (1, 2, 3):
        store.add_label(grasp, "ann", "exclude", batch="b1")
    for event in store.batch("b1"):
        store.revert(event.id, "ann", batch="b2")
    assert [store.current(grasp).value for grasp in (1, 2, 3)] == [1.0, 0.8, 0.6]
    assert store.grasp(1).state == "labelled"
    redo = store.revert(store.batch("b2")[0].id, "ann")
    assert redo.new_value is None and store.grasp(1).state == "excluded"


@pytest.mark.parametrize("value", [-0.1, 1.5, float("nan")])
def test_values_out_of_range_are_refused(store, value):
    with pytest.raises(StoreError, match="between 0 and 1"):
        store.add_label(1, "ann", value)


def test_refusals(store):
    with pytest.raises(StoreError, match="no grasp"):
        store.add_label(77, "ann", 1.0)
    with pytest.raises(StoreError, match="who you are"):
        store.add_label(1, "  ", 1.0)
    with pytest.raises(StoreError, match="no decision"):
        store.add_label(1, "ann", "revert")
    with pytest.raises(StoreError, match="no label event"):
        store.revert(5, "ann")
    assert store.events() == []


def test_conflict_shows_what_was_not_seen(store):
    seen = store.add_label(1, "ann", 1.0).id
    store.add_label(1, "bob", 0.0)
    with pytest.raises(LabelConflict, match="bob") as conflict:
        store.add_label(1, "ann", 0.5, seen_event=seen)
    assert [event.person for event in conflict.value.events] == ["bob"]
    assert store.current(1).value == 0.0
    store.add_label(1, "ann", 0.5, seen_event=store.history(1)[-1].id)
    assert store.current(1).value == 0.5


def test_more_attempts_pool_and_can_be_taken_back(store):
    event = store.add_attempts(2, [attempt("MISSED", 1), attempt("SUCCESS", 2), attempt("UNSTABLE", 3)], person="ann")
    row = store.grasp(2)
    assert (row.attempts, row.successes) == (7, 5)
    assert row.label == pytest.approx(5 / 7) and event.new_value == pytest.approx(5 / 7)
    assert event.source == "dart" and event.details["seeds"] == [1, 2, 3]
    assert [a.event for a in store.attempts(2)] == [None] * 5 + [event.id] * 3
    store.revert(event.id, "ann")
    assert (store.grasp(2).attempts, store.grasp(2).label) == (5, 0.8)


def test_the_same_seed_never_counts_twice(store):
    used = store.attempts(1)[0].seed
    for rows in ([attempt("SUCCESS", used)], [attempt("SUCCESS", 9), attempt("SUCCESS", 9)]):
        with pytest.raises(StoreError, match="fresh seeds"):
            store.add_attempts(1, rows)
    with pytest.raises(StoreError, match="no attempts"):
        store.add_attempts(1, [])


def test_seed_zero_is_a_seed(store):
    store.add_attempts(1, [attempt("SUCCESS", 0)])
    with pytest.raises(StoreError, match="seed 0"):
        store.add_attempts(1, [attempt("SUCCESS", 0)])


def test_rebuilt_labels_equal_the_kept_ones(store):
    store.add_label(1, "ann", 0.3)
    store.add_label(2, "ann", "exclude")
    store.add_label(3, "bob", "flag")
    store.revert(store.add_attempts(4, [attempt("SUCCESS", 5)]).id, "ann")
    before = [tuple(row) for row in store.rows("SELECT * FROM samples ORDER BY grasp")]
    store.rebuild_labels()
    assert [tuple(row) for row in store.rows("SELECT * FROM samples ORDER BY grasp")] == before
