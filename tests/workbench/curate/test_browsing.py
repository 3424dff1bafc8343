from dataclasses import replace

import pytest

from grasp_core.dataset.queries import Query
from workbench.actions import Notice
from workbench.curate import actions as a
from workbench.curate import effects as e


def test_filters_make_the_query_and_the_first_page(rules, state):
    for field, text, value in (
        ("split", "train", "train"),
        ("quality", "0.2..0.8", (0.2, 0.8)),
        ("flagged", "yes", True),
        ("flagged", "no", False),
        ("descending", "yes", True),
        ("sort", "gap", "gap"),
        ("text", "the rim", "the rim"),
        ("split", "", None),
    ):
        new, (load,) = rules.reduce(replace(state, keys=(None, (1.0, 1))), a.Filter(field, text))
        assert getattr(new.query, field) == value
        assert load == e.LoadShelf(new.ticket, new.query, None, 0) and new.keys == (None,) and new.loading


@pytest.mark.parametrize(("field", "text"), [("split", "nowhere"), ("quality", "high"), ("sort", "colour")])
def test_impossible_filters_are_told(rules, state, field, text):
    new, (told,) = rules.reduce(state, a.Filter(field, text))
    assert new is state and isinstance(told, Notice)


def test_unknown_fields_change_nothing(rules, state):
    assert rules.reduce(state, a.Filter("nonsense", "x")) == (state, ())


def test_pages_turn_by_key_and_end(rules, state):
    second, (load,) = rules.reduce(state, a.TurnPage(1))
    assert load.after == (3.0, 3) and second.keys == (None, (3.0, 3))
    assert rules.reduce(second, a.TurnPage(1)) == (second, ())  # still on its way
    there = replace(second, loading=False, shelf=replace(state.shelf, after=None))
    assert isinstance(rules.reduce(there, a.TurnPage(1))[1][0], Notice)
    back, (load,) = rules.reduce(there, a.TurnPage(-1))
    assert load.after is None and back.keys == (None,)
    assert isinstance(rules.reduce(state, a.TurnPage(-1))[1][0], Notice)


def test_a_page_shows_its_first_sample_and_late_pages_are_dropped(rules, state):
    waiting = replace(state, ticket=4, loading=True)
    assert rules.reduce(waiting, a.ShelfShown(3, state.shelf, 0)) == (waiting, ())
    new, (load,) = rules.reduce(waiting, a.ShelfShown(4, state.shelf, 0))
    assert load == e.LoadSample(1) and new.wanted == 1 and not new.loading
    assert rules.reduce(waiting, a.ShelfShown(4, state.shelf, 10_000))[1] == (e.LoadSample(3),)
    assert rules.reduce(waiting, a.ShelfShown(4, state.shelf, None))[1] == ()


def test_walking_goes_over_the_page_s_ends(rules, state):
    assert rules.reduce(state, a.Move(1))[1] == (e.LoadSample(3),)
    assert rules.reduce(state, a.Move(-1))[1] == (e.LoadSample(1),)
    last, _ = rules.reduce(replace(state, sample=replace(state.sample, row=state.shelf.thumbs[2].row)), a.Move(1))
    assert last.keys == (None, (3.0, 3))


def test_only_the_wanted_sample_is_shown(rules, state):
    asked, _ = rules.reduce(replace(state, note="half a note"), a.Pick(3))
    assert rules.reduce(asked, a.SampleShown(state.sample)) == (asked, ())
    other = replace(state.sample, row=state.shelf.thumbs[2].row)
    new, _ = rules.reduce(asked, a.SampleShown(other))
    assert new.sample is other and new.note == "" and new.edited is None


def test_saved_lists_open_by_name(rules, state, facts):
    known = replace(state, facts=replace(facts, views={"mine": Query(split="test")}))
    assert rules.reduce(known, a.OpenView("mine"))[0].query == Query(split="test")
    assert isinstance(rules.reduce(known, a.OpenView("other"))[1][0], Notice)


def test_a_name_is_tidied(rules, state):
    new, (load,) = rules.reduce(state, a.SayName("  Ann   Lee "))
    assert new.person == "Ann Lee" and load == e.LoadFacts("Ann Lee")
