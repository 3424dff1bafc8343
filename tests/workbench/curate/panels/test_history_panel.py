from dataclasses import replace

import pytest

from grasp_core.dataset.review import Review, Rule
from workbench.curate.panels.history_panel import READERS, HistoryPanel


@pytest.fixture
def panel(curation_bridge):
    return HistoryPanel(curation_bridge)


def test_the_newest_comes_first_and_what_was_taken_back_is_struck(panel, client, state, desk, store):
    first = store.add_label(2, "bob", 0.0, reason="it slips", note="<b>rim</b>")
    store.revert(first.id, "ann")
    panel.update(None, replace(state, sample=desk.sample(2)))
    page = client.page()
    assert page.index("ann took an event back") < page.index("bob set 0")
    assert f'class="gw-gone" data-event="{first.id}"' in page and "it slips" in page
    assert "1 → 0" in page and "<b>rim</b>" not in page
    assert page.count("crevert:") == 1  # what is taken back already has no button


def test_a_person_s_events_lead_to_their_samples(panel, client, state, store):
    event = store.add_label(5, "bob", 1.0)
    panel.update(None, replace(state, about="bob", events=(event,)))
    page = client.page()
    assert 'data-about="bob"' in page and "cpick:5" in page and 'class="gw-on" data-person="bob"' in page
    assert "colder:" not in page and 'class="gw-gone"' not in page
    panel.update(None, replace(state, about="bob", events=(event,), gone=frozenset({event.id}), older=True))
    page = client.page()
    assert "Older events" in page and f'class="gw-gone" data-event="{event.id}"' in page
    assert READERS["cperson"]("Ann%20Lee").name == "Ann Lee"


def test_nobody_has_decided_yet(panel, client, state):
    panel.update(None, replace(state, facts=replace(state.facts, people=())))
    assert "Nobody has decided anything yet" in client.page()


def test_a_blind_review_tells_nothing(panel, client, state, desk, store):
    store.add_label(2, "bob", 0.0)
    shown = replace(state, sample=desk.sample(2), review=Review(1, "ann", Rule(blind=True), 3, 0))
    panel.update(None, shown)
    assert "bob" not in client.page()
