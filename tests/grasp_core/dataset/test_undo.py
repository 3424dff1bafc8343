from grasp_core.dataset.store import DatasetStore
from grasp_core.dataset.undo import redo, redoable, undo, undoable


def labels(store):
    return [store.grasp(grasp).label for grasp in (1, 2, 3)]


def test_steps_are_taken_back_newest_first_and_brought_back(store):
    store.add_label(1, "ann", 0.0)
    store.add_label(2, "ann", "exclude")
    store.add_label(1, "ann", 0.3)
    assert labels(store) == [0.3, None, 0.6]
    undo(store, "ann")
    assert labels(store) == [0.0, None, 0.6]
    undo(store, "ann")
    assert labels(store) == [0.0, 0.8, 0.6]
    redo(store, "ann")
    assert labels(store) == [0.0, None, 0.6]
    undo(store, "ann")
    undo(store, "ann")
    assert labels(store) == [1.0, 0.8, 0.6]
    assert undo(store, "ann") == [] and undoable(store, "ann") is None
    for _ in range(3):
        redo(store, "ann")
    assert labels(store) == [0.3, None, 0.6]
    assert redo(store, "ann") == [] and redoable(store, "ann") is None


def test_a_new_step_ends_redo(store):
    store.add_label(1, "ann", 0.0)
    undo(store, "ann")
    assert redoable(store, "ann").grasp == 1
    store.add_label(2, "ann", 0.0)
    assert redoable(store, "ann") is None
    undo(store, "ann")
    assert undoable(store, "ann") is None
    assert labels(store) == [1.0, 0.8, 0.6]


def test_each_person_undoes_their_own(store):
    store.add_label(1, "ann", 0.0)
    store.add_label(1, "bob", 0.5)
    undo(store, "ann")
    assert store.grasp(1).label == 0.5
    undo(store, "bob")
    assert store.grasp(1).label == 1.0
    assert undoable(store, "eve") is None


def test_a_step_that_somebody_else_reverted_is_undone_without_effect(store):
    event = store.add_label(1, "ann", 0.0)
    store.revert(event.id, "bob")
    undo(store, "ann")
    assert (store.grasp(1).label, undoable(store, "ann")) == (1.0, None)


def test_a_revert_is_a_step_too(store):
    event = store.add_label(1, "bob", 0.0)
    store.revert(event.id, "ann")
    assert undoable(store, "ann").kind == "revert"
    undo(store, "ann")
    assert store.grasp(1).label == 0.0


def test_undo_works_after_a_restart(store):
    store.add_label(1, "ann", 0.0)
    path = store.path
    store.close()
    with DatasetStore.open(path) as again:
        undo(again, "ann")
        assert again.grasp(1).label == 1.0
        assert again.differing_labels() == []
