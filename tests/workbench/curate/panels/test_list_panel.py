from dataclasses import replace

import msgspec
import pytest

from grasp_core.dataset.bulk import BulkPlan
from grasp_core.dataset.queries import Query
from grasp_core.dataset.review import Review, Rule
from workbench.bridge import read_message
from workbench.curate import actions as a
from workbench.curate.panels.list_panel import FILTERS, READERS, SORTS, ListPanel, badge
from workbench.curate.state import BulkAsk
from workbench.curate.values import Thumb


@pytest.fixture
def panel(curation_bridge, state):
    return ListPanel(curation_bridge, state)


def test_every_filter_and_sorting_is_a_field_of_the_query(state):
    assert set(FILTERS) <= set(Query.__struct_fields__)
    for field, (_, _, choices) in FILTERS.items():
        for value, _ in choices:
            action = read_message(f"cfilter:{field}={value}:1", READERS)
            assert action == a.Filter(field, value)
    for sort in SORTS:
        assert Query(sort=sort).sort == sort


def test_the_list_shows_samples_with_their_labels(panel, client, state):
    panel.update(None, state)
    page = client.page()
    assert page.count("data-sample=") == 3 and "30 samples" in page and 'value="box"' in page
    assert ".gw-t2{" in page  # the one that is shown is marked


def test_labels_of_all_kinds_are_told_apart(state):
    row = state.sample.row
    shown = [
        badge(Thumb(msgspec.structs.replace(row, **change), "x", ""))
        for change in (
            {"label": 0.25, "source": "human"},
            {"state": "unsure", "label": None},
            {"state": "excluded", "label": None},
            {"label": None, "state": "unlabelled"},
            {"flagged": True},
        )
    ]
    assert "0.25 ✎" in shown[0] and "?" in shown[1] and "⊘" in shown[2] and "–" in shown[3] and "⚑" in shown[4]


def test_names_cannot_smuggle_html(panel, client, state, facts):
    evil = "<img src=x onerror=alert(1)>"
    thumbs = (replace(state.shelf.thumbs[0], object=evil),)
    known = replace(facts, categories=(evil,), people=(evil,), views={evil: Query()})
    panel.update(None, replace(state, shelf=replace(state.shelf, thumbs=thumbs), facts=known))
    assert "<img src=x" not in client.page()


def test_failures_empty_lists_and_waiting_are_told(panel, client, state):
    panel.update(None, replace(state, failure="it is damaged; restore a backup"))
    assert "it is damaged" in client.page() and "Try again" in client.page()
    panel.update(None, replace(state, shelf=replace(state.shelf, thumbs=())))
    assert "No sample matches" in client.page()
    panel.update(None, replace(state, shelf=None))
    assert "Reading the dataset" in client.page()


def test_bulk_says_what_it_would_do(panel, client, state):
    panel.update(None, replace(state, bulk=BulkAsk(state.query, 0.0, BulkPlan(1200, 900, 3))))
    page = client.page()
    assert "1,200" in page and "900 of them change" in page and "<b>3</b>" in page


def test_a_review_hides_the_list(panel, client, state):
    panel.update(None, state)
    panel.update(state, replace(state, review=Review(1, "ann", Rule(), 3, 0)))
    assert "data-sample=" not in client.page()


def test_lists_too_long_to_count_say_so(panel, client, state):
    long = replace(state, shelf=replace(state.shelf, total=None), query=Query(split="train"))
    panel.update(None, long)
    assert "10,000 samples or more" in client.page()
    panel.update(None, replace(long, query=Query()))
    assert "30 samples" in client.page()


def test_a_bulk_decision_under_way_can_be_stopped(panel, client, state):
    panel.update(None, replace(state, relabelling=(1_000, 4_000)))
    page = client.page()
    assert "relabelled 1,000 of 4,000" in page and "width:25.0%" in page and "cstop:" in page
    assert read_message("cstop::1", READERS) == a.StopBulk() and "cbulk:" not in page


@pytest.mark.parametrize("message", ["cbulk:all", "cpick:x", "cfilter:split"])
def test_bad_messages_are_refused(message):
    from grasp_core.errors import GraspError

    with pytest.raises(GraspError, match="bad value"):
        read_message(f"{message}:1", READERS)
