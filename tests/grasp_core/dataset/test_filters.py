import pytest

from grasp_core.dataset import filters
from grasp_core.dataset.queries import Query
from grasp_core.grasp import Grasp

QUERIES = (
    Query(quality=(0.2, 0.7)),
    Query(quality=(0.2, 1.0), score=(0.3, 1.0)),
    Query(gap=(0.1, 1.0), outcome="SUCCESS"),
    Query(gap=(0.0, 0.5), spread=(0.1, 0.3), split="train"),
    Query(label=(0.0, 0.5), object="box_000"),
)


@pytest.fixture
def scored(store, make_box, make_record, at_rest):
    asset = make_box("box_001", (0.06, 0.04, 0.05))
    store.add_object(asset, "validation", [at_rest(asset)])
    store.add_scene(make_record(asset, "box_001-0", grasps=7, seed=1))
    ids = [row["grasp"] for row in store.rows("SELECT grasp FROM samples ORDER BY grasp")]
    store.add_predictions("w", "w", ids, [index / len(ids) for index in range(len(ids))])
    store.use_weights("w")
    return store


@pytest.mark.parametrize("query", QUERIES)
@pytest.mark.parametrize(("few", "limit"), [(10_000, 50_000), (1, 50_000), (1, 2)])
def test_every_form_of_a_condition_selects_the_same(scored, query, few, limit, monkeypatch):
    by_hand = [
        row["grasp"]
        for row in scored.rows(
            "SELECT samples.*, objects.name FROM samples JOIN objects ON objects.id = object ORDER BY grasp"
        )
        if all(
            bounds is None or (row[field] is not None and bounds[0] <= row[field] <= bounds[1])
            for field in ("quality", "score", "gap", "spread", "label")
            for bounds in [getattr(query, field)]
        )
        and (query.outcome is None or row["successes"] > 0)
        and (query.split is None or row["split"] == query.split)
        and (query.object is None or row["name"] == query.object)
    ]
    assert 0 < len(by_hand) < scored.count(Query())
    monkeypatch.setattr(filters, "FEW", few)
    monkeypatch.setattr(filters, "_LIMIT", limit)
    monkeypatch.setattr(filters, "_LIMITS", dict.fromkeys(filters._LIMITS, 3 * limit))
    for part in (False, True):
        where, values = scored.conditions(query, part=part)
        found = scored.rows(f"SELECT grasp FROM samples WHERE {' AND '.join(where)} ORDER BY grasp", values)
        assert [row["grasp"] for row in found] == by_hand


def test_a_filter_of_many_samples_keeps_sqlite_from_its_index(scored, monkeypatch):
    query = Query(score=(0.0, 1.0))
    assert scored.conditions(query)[0] == ["samples.score BETWEEN ? AND ?"]
    monkeypatch.setattr(filters, "FEW", 1)
    assert scored.conditions(query, part=True)[0] == ["+samples.score BETWEEN ? AND ?"]
    assert "IN (SELECT grasp" in scored.conditions(query)[0][0]
    monkeypatch.setattr(filters, "_LIMIT", 1)
    assert scored.conditions(query)[0] == ["+samples.score BETWEEN ? AND ?"]


def test_origins_are_told_apart(scored):
    new = scored.add_grasp(1, Grasp((0.0, 0.0, 0.05), 0.1, 0.1), person="ann")
    assert scored.ids(Query(origin="person")) == [new]
    assert new not in scored.ids(Query(origin="grid")) and len(scored.ids(Query(origin="grid"))) == new - 1
    assert scored.ids(Query(category="nothing")) == []
