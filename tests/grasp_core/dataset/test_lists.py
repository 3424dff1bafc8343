import pytest

from grasp_core.dataset.queries import Query
from grasp_core.dataset.rows import AttemptRow
from grasp_core.errors import StoreError
from grasp_core.grasp import Grasp


@pytest.fixture
def lists(store, make_box, make_record, at_rest):
    for index, split in ((1, "validation"), (2, "test")):
        asset = make_box(f"box_{index:03d}", (0.05 + 0.01 * index, 0.04, 0.05))
        store.add_object(asset, split, [at_rest(asset)])
        store.add_scene(make_record(asset, f"{asset.name}-0", grasps=7, seed=index))
    return store


def everything(store, query, size):
    rows, after = [], None
    while True:
        page = store.page(query, size=size, after=after)
        rows += page.rows
        assert len(page.rows) <= size
        if page.after is None:
            return rows
        after = page.after


@pytest.mark.parametrize("sort", ["id", "quality", "label", "spread"])
@pytest.mark.parametrize("descending", [False, True])
@pytest.mark.parametrize("size", [1, 4, 18, 50])
def test_pages_show_every_sample_once_and_in_order(lists, sort, descending, size):
    rows = everything(lists, Query(sort=sort, descending=descending), size)
    assert sorted(row.id for row in rows) == list(range(1, 19))
    key = {"id": "id", "quality": "quality", "label": "label"}.get(sort)
    values = [getattr(row, key) if key else row.quality * (1 - row.quality) for row in rows]
    assert values == sorted(values, reverse=descending)


def test_filters(lists):
    def ids(**filters):
        query = Query(**filters)
        found = lists.ids(query)
        assert len(found) == lists.count(query)
        assert [row.id for row in everything(lists, query, 3)] == found
        return found

    assert ids(split="validation") == list(range(5, 12))
    assert ids(object="box_002") == ids(scene="box_002-0") == list(range(12, 19))
    assert ids(category="cup") == [] and len(ids(category="box")) == 18
    assert ids(outcome="SLIPPED", split="train") == [2]
    assert ids(quality=(0.8, 1.0), split="train") == [1, 2]
    assert ids(outcome="COLLISION", quality=(0.4, 0.4)) == [4, 8, 15]


def test_filters_on_what_people_did(lists):
    lists.add_label(3, "ann", "exclude", note="The rim is bent, look closely")
    lists.add_label(9, "bob", 1.0, note="handle")
    lists.add_label(5, "ann", "flag")
    new = lists.add_grasp(1, Grasp((0.0, 0.0, 0.05), 0.1, 0.1), person="ann")
    assert lists.ids(Query(state="excluded")) == [3]
    assert lists.ids(Query(source="human")) == [3, 9]
    assert lists.ids(Query(source="human", sort="quality")) == [3, 9]
    assert [row.id for row in lists.page(Query(source="human", sort="quality", descending=True)).rows] == [9, 3]
    assert lists.ids(Query(flagged=True)) == [5] and 5 not in lists.ids(Query(flagged=False))
    assert lists.ids(Query(person="ann")) == [3, 5]
    assert lists.ids(Query(origin="person")) == lists.ids(Query(state="unlabelled")) == [new]
    assert lists.ids(Query(text="rim ben")) == [3]
    assert lists.ids(Query(text='rim" OR "handle')) == []
    assert [row.id for row in lists.page(Query(sort="changed", descending=True)).rows] == [5, 9, 3]
    lists.add_attempts(new, [AttemptRow("MISSED", 1, (0.0, 0.0, 0.0, 0.0))])
    assert lists.ids(Query(state="unlabelled")) == []


def test_scores_and_gaps_sort(lists):
    lists.add_predictions("w", "w", [1, 2, 3], [0.0, 0.9, 0.61])
    lists.use_weights("w")
    rows = lists.page(Query(sort="gap", descending=True)).rows
    assert [row.id for row in rows] == [1, 2, 3]
    assert [row.id for row in lists.page(Query(sort="score", score=(0.5, 1.0))).rows] == [3, 2]


def test_a_page_has_rows(lists):
    with pytest.raises(StoreError, match="at least 1 row"):
        lists.page(Query(), size=0)


def test_disagreements_sort_and_filter(lists):
    lists.add_predictions("w", "w", [1, 2, 3, 4], [0.1, 0.9, 0.6, 0.4], [0.1, 0.2, 0.6, 0.5])
    lists.use_weights("w")
    lists.add_label(2, "ann", 0.0)

    def top(sort):
        return [row.id for row in lists.page(Query(sort=sort, descending=True), size=4).rows]

    assert top("mistake")[:2] == [2, 1]
    assert top("networks") == [2, 4, 3, 1]
    assert top("dissent") == [2]
    assert top("gap") == [1, 2, 4, 3]
    assert lists.ids(Query(mistake=(0.85, 1.0))) == [1, 2]
    assert lists.ids(Query(dissent=(0.5, 1.0))) == [2]
    assert lists.ids(Query(networks=(0.0, 0.2), gap=(0.0, 0.2))) == [3, 4]
    assert lists.ids(Query(spread=(0.2, 0.25), split="train")) == [3, 4]


@pytest.mark.parametrize("most", [1, 5, 18])
def test_counting_may_end_early(lists, most):
    assert lists.count(Query(), most=most) == most
    assert lists.count(Query(split="test"), most=most) == min(most, 7)


@pytest.mark.parametrize("sort", ["id", "quality", "spread"])
@pytest.mark.parametrize("descending", [False, True])
def test_all_ways_to_a_page_give_the_same(lists, sort, descending, monkeypatch):
    query = Query(category="box", quality=(0.2, 1.0), sort=sort, descending=descending)
    few = [row.id for row in everything(lists, query, 4)]
    assert lists.page(query).total == len(few) == 14
    monkeypatch.setattr("grasp_core.dataset.lists.FEW", 1)
    assert [row.id for row in everything(lists, query, 4)] == few
    assert lists.page(query).total is None
    for limit in ("_WALK", "_SURE_WALK"):
        monkeypatch.setattr(f"grasp_core.dataset.lists.{limit}", 2)
        assert [row.id for row in everything(lists, query, 4)] == few
    monkeypatch.setattr("grasp_core.dataset.filters.FEW", 1)
    assert [row.id for row in everything(lists, query, 4)] == few


def test_a_page_ends_with_the_last_sample_exactly(lists):
    page = lists.page(Query(split="test"), size=7)
    assert len(page.rows) == 7 and page.after is None
    assert lists.page(Query(category="cup")).rows == []
