import pytest

from grasp_core.dataset.bulk import BulkPlan, label_all, plan_bulk
from grasp_core.dataset.queries import Query
from grasp_core.dataset.undo import redo, undo
from grasp_core.errors import Cancelled, StoreError

LOW = Query(quality=(0.0, 0.65))


def labels(store):
    return [store.grasp(grasp).label for grasp in (1, 2, 3, 4)]


def test_counted_first_then_done_and_undone_in_one_step(store):
    store.add_label(4, "bob", 1.0)
    before = labels(store)
    plan = plan_bulk(store, LOW, 0.0)
    assert plan == BulkPlan(samples=2, changing=2, human=1)
    assert labels(store) == before and len(store.events()) == 1
    calls = []
    bulk = label_all(store, LOW, "ann", 0.0, plan, reason="all slip", progress=lambda *c: calls.append(c))
    assert bulk.events == 2 and labels(store) == [1.0, 0.8, 0.0, 0.0]
    assert {event.reason for event in store.batch(bulk.batch)} == {"all slip"}
    assert len(undo(store, "ann")) == 2
    assert labels(store) == before
    assert len(redo(store, "ann")) == 2
    assert labels(store) == [1.0, 0.8, 0.0, 0.0]


@pytest.mark.parametrize(
    ("decision", "changing"), [("exclude", 3), ("unsure", 4), ("flag", 4), ("unflag", 0), (1.0, 3)]
)
def test_what_would_change(store, decision, changing):
    store.add_label(2, "bob", "exclude")
    assert plan_bulk(store, Query(), decision).changing == changing


def test_a_list_that_changed_meanwhile_is_left_alone(store):
    plan = plan_bulk(store, LOW, 0.0)
    store.add_label(3, "bob", 0.0)
    with pytest.raises(StoreError, match="list changed meanwhile"):
        label_all(store, LOW, "ann", 0.0, plan)
    assert len(store.events()) == 1


def test_cancelled_changes_nothing(store):
    asked = iter([False, False, True])
    with pytest.raises(Cancelled):
        label_all(store, Query(), "ann", 0.0, plan_bulk(store, Query(), 0.0), cancelled=lambda: next(asked))
    assert store.events() == []


@pytest.mark.parametrize("decision", ["revert", "attempts", "note"])
def test_what_is_no_bulk_decision(store, decision):
    with pytest.raises(StoreError, match="bulk decision"):
        plan_bulk(store, Query(), decision)
