import re

import pytest

from workbench.curate.panels.words import change, decision_words, event_words, moment


@pytest.mark.parametrize(
    ("decision", "value", "words"),
    [
        (0.25, None, "ann set 0.25"),
        ("unsure", None, "ann is unsure"),
        ("exclude", None, "ann excluded it"),
        ("flag", None, "ann flagged it"),
        ("note", None, "ann wrote a note"),
        ("opinion", 1.0, "ann gave the opinion 1"),
        ("opinion", None, "ann gave the opinion unsure"),
    ],
)
def test_events_in_words(store, decision, value, words):
    assert event_words(store.add_label(1, "ann", decision, value=value)) == words


def test_decisions_in_a_word():
    words = [decision_words(decision) for decision in (1.0, 0.0, 0.3, "exclude", "unsure")]
    assert words == ["good", "bad", "0.3", "excluded", "unsure"]


def test_changes_and_moments(store):
    event = store.add_label(1, "ann", "exclude")
    assert change(event) == "1 → left out"
    assert change(store.add_label(1, "ann", "flag")) == ""
    assert re.fullmatch(r"\d{4}-\d\d-\d\d \d\d:\d\d", moment(event))
