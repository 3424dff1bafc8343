import pytest

from grasp_core.dataset.labels import LabelConflict
from grasp_core.dataset.queries import Query
from grasp_core.dataset.review import Rule, answer, next_item, review, reviews, skip, start_review
from grasp_core.dataset.rows import AttemptRow
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import StoreError


@pytest.fixture
def scored(store, make_box, make_record, at_rest):
    """18 samples with scores; the settled ones are 1 (good), 6 (good) and 13 (good) and two bad ones."""
    for index in (1, 2):
        asset = make_box(f"box_{index:03d}", (0.05 + 0.01 * index, 0.04, 0.05))
        store.add_object(asset, "train", [at_rest(asset)])
        store.add_scene(make_record(asset, f"{asset.name}-0", grasps=7, seed=index))
    store.add_predictions("w", "w", range(1, 19), [k / 20 for k in range(1, 19)])
    store.use_weights("w")
    return store


def walk(store, review_id, decide):
    seen = []
    while (item := next_item(store, review_id)) is not None:
        seen.append(item)
        decide(item)
    return seen


def test_most_disagreement_comes_first(scored):
    made = start_review(scored, "ann", Rule(size=3, hidden=0))
    expected = [row.id for row in scored.page(Query(sort="gap", descending=True), size=3).rows]
    seen = walk(scored, made.id, lambda item: answer(scored, item, 0.0))
    assert [item.grasp for item in seen] == expected
    assert all(scored.grasp(grasp).label == 0.0 for grasp in expected)
    assert review(scored, made.id).done == 3
    assert scored.events_of("ann")[0].details == {"review": made.id, "choice": "disagreement", "blind": False}


def test_worst_mistakes_and_other_measures(scored):
    scored.add_label(18, "bob", 0.0)
    made = start_review(scored, "ann", Rule(choice="mistakes", size=2, hidden=0))
    assert [row.grasp for row in walk(scored, made.id, lambda item: skip(scored, item))][:1] == [1]
    dissent = start_review(scored, "ann", Rule(measure="dissent", size=5, hidden=0))
    assert dissent.items == 1 and next_item(scored, dissent.id).grasp == 18


def test_an_audit_is_random_and_the_same_for_a_seed(scored):
    rules = [Rule(choice="audit", size=6, hidden=0, seed=seed) for seed in (1, 1, 2)]
    made = [start_review(scored, "ann", rule) for rule in rules]
    drawn = [[i.grasp for i in walk(scored, one.id, lambda item: skip(scored, item))] for one in made]
    assert drawn[0] == drawn[1] != drawn[2] and len(set(drawn[0])) == 6


def test_hidden_samples_are_settled_mixed_in_and_keep_their_label(scored):
    made = start_review(scored, "ann", Rule(choice="audit", query=Query(object="box_001"), size=6, hidden=0.2))
    truths = {
        row["grasp"]: row["truth"]
        for row in scored.rows("SELECT grasp, truth FROM review_items WHERE truth IS NOT NULL")
    }
    for grasp, truth in truths.items():
        row = scored.grasp(grasp)
        assert row.attempts >= 5 and row.quality == truth
    before = {grasp: scored.grasp(grasp).label for grasp in truths}
    seen = walk(scored, made.id, lambda item: answer(scored, item, 0.25))
    assert len(seen) == made.items and {i.grasp for i in seen if i.opinion} == set(truths)
    assert {grasp: scored.grasp(grasp).label for grasp in truths} == before
    assert all(scored.grasp(i.grasp).label == 0.25 for i in seen if not i.opinion)


def test_second_opinions_leave_labels_alone(scored):
    for grasp in (2, 3, 4):
        scored.add_label(grasp, "ann", 0.0)
    scored.add_label(4, "bob", 1.0)
    made = start_review(scored, "bob", Rule(choice="opinions", hidden=0, blind=True))
    seen = walk(scored, made.id, lambda item: answer(scored, item, "unsure" if item.grasp == 2 else 1.0))
    assert sorted(item.grasp for item in seen) == [2, 3]
    assert [scored.grasp(grasp).label for grasp in (2, 3)] == [0.0, 0.0]
    event = scored.history(2)[-1]
    assert (event.kind, event.value, event.details["opinion"], event.details["blind"]) == (
        "opinion",
        None,
        "unsure",
        True,
    )
    with pytest.raises(StoreError, match="second opinion"):
        start_review(scored, "bob", Rule(choice="opinions", hidden=0))


def test_a_review_goes_on_after_a_restart(scored):
    made = start_review(scored, "ann", Rule(size=3, hidden=0))
    answer(scored, next_item(scored, made.id), 1.0)
    path = scored.path
    scored.close()
    with DatasetStore.open(path) as again:
        (found,) = reviews(again, "ann")
        assert (found.id, found.items, found.done, found.rule) == (made.id, 3, 1, Rule(size=3, hidden=0))
        assert next_item(again, made.id).place == 1
        assert reviews(again, "bob") == []


def test_a_conflict_leaves_the_item_open(scored):
    made = start_review(scored, "ann", Rule(size=1, hidden=0))
    item = next_item(scored, made.id)
    scored.add_label(item.grasp, "bob", 0.5)
    with pytest.raises(LabelConflict, match="bob"):
        answer(scored, item, 1.0, seen_event=0)
    assert next_item(scored, made.id) == item and scored.grasp(item.grasp).label == 0.5


def test_refusals(scored):
    with pytest.raises(StoreError, match="choice is one of"):
        Rule(choice="nonsense")
    with pytest.raises(StoreError, match="at least 1"):
        Rule(size=0)
    with pytest.raises(StoreError, match="no sample"):
        start_review(scored, "ann", Rule(query=Query(category="cup")))
    with pytest.raises(StoreError, match="no review"):
        review(scored, 99)


def test_more_attempts_make_hidden_samples(scored):
    rows = [AttemptRow("MISSED", seed, (0.0, 0.0, 0.0, 0.0)) for seed in range(50, 60)]
    bad = next(row.id for row in scored.page(Query(quality=(0.0, 0.0))).rows)
    scored.add_attempts(bad, rows)
    start_review(scored, "ann", Rule(measure="quality", size=1, hidden=1.0, settled=15))
    found = scored.rows("SELECT grasp, truth FROM review_items WHERE truth IS NOT NULL")
    assert [tuple(row) for row in found] == [(bad, 0.0)]
