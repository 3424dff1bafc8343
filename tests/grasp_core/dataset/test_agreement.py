import pytest

from grasp_core.dataset.agreement import accuracies, agreements, cohens_kappa, verdict, verdicts
from grasp_core.dataset.review import Rule, answer, next_item, start_review
from grasp_core.rates import wilson


def test_kappa_of_a_textbook_table():
    # J. Cohen's formula by hand: 20 both good, 15 both bad, 5 and 10 apart; observed 0.7, chance 0.5
    first = {i: "good" if i < 25 else "bad" for i in range(50)}
    second = {i: "good" if i < 20 or 25 <= i < 35 else "bad" for i in range(50)}
    n, agreed, kappa = cohens_kappa(first, second)
    assert (n, agreed) == (50, 0.7) and kappa == pytest.approx(0.4)


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        ({}, {1: "good"}, (0, None, None)),
        ({1: "good", 2: "good"}, {1: "good", 2: "good", 3: "bad"}, (2, 1.0, None)),
        ({1: "good", 2: "bad"}, {1: "good", 2: "bad"}, (2, 1.0, 1.0)),
        ({1: "good", 2: "bad"}, {1: "bad", 2: "good"}, (2, 0.0, -1.0)),
        ({1: "unsure", 2: "bad"}, {1: "unsure", 2: "bad"}, (2, 1.0, 1.0)),
    ],
)
def test_corners_of_kappa(first, second, expected):
    assert cohens_kappa(first, second) == expected


@pytest.mark.parametrize(
    ("value", "word"), [(0.0, "bad"), (0.49, "bad"), (0.5, "good"), (1.0, "good"), (None, "unsure")]
)
def test_verdicts_in_words(value, word):
    assert verdict(value) == word


def test_the_newest_standing_verdict_counts(store):
    store.add_label(1, "ann", 1.0)
    store.add_label(1, "ann", 0.0)
    store.add_label(2, "ann", 1.0)
    store.add_label(2, "ann", "flag")
    taken_back = store.add_label(3, "ann", 1.0)
    store.revert(taken_back.id, "bob")
    redone = store.add_label(4, "ann", 0.0)
    store.revert(store.revert(redone.id, "ann").id, "ann")
    store.add_label(1, "bob", "opinion", value=0.0)
    store.add_label(2, "bob", "unsure")
    assert verdicts(store) == {"ann": {1: "bad", 2: "good", 4: "bad"}, "bob": {1: "bad", 2: "unsure"}}
    (pair,) = agreements(store)
    assert (pair.people, pair.samples, pair.agreed) == (("ann", "bob"), 2, 0.5)


def test_hidden_samples_measure_a_person(store):
    review = start_review(store, "ann", Rule(measure="spread", hidden=1.0, size=1))
    while (item := next_item(store, review.id)) is not None:
        answer(store, item, 1.0)
    # of the four grasps only number 1 is settled: five successes
    (found,) = accuracies(store)
    assert (found.person, found.samples, found.right, found.unsure) == ("ann", 1, 1, 0)
    assert (found.low, found.high) == wilson(1, 1)
    store.revert(store.history(1)[0].id, "ann")
    assert accuracies(store) == []


def test_wrong_and_unsure_answers(store):
    for decision in (0.0, "unsure"):
        review = start_review(store, "ann", Rule(measure="spread", hidden=1.0, size=1))
        while (item := next_item(store, review.id)) is not None:
            answer(store, item, decision)
    (found,) = accuracies(store)
    assert (found.samples, found.right, found.unsure) == (1, 0, 1)
