from dataclasses import replace

from grasp_core.dataset.review import Review, Rule
from workbench.curate.state import Playing, State


def test_the_place_of_the_sample_on_the_page(state):
    assert state.place == 1
    assert replace(state, sample=None).place is None
    assert replace(state, shelf=replace(state.shelf, thumbs=state.shelf.thumbs[:1])).place is None


def test_blind_is_a_matter_of_the_review(state):
    assert not state.blind
    assert replace(state, review=Review(1, "ann", Rule(blind=True), 3, 0)).blind
    assert not replace(state, review=Review(1, "ann", Rule(), 3, 0)).blind


def test_a_new_browser_has_no_name(played):
    assert State().person == "" and State().saved == 0
    assert Playing(1, played).duration == 2.0
