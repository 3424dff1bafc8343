from dataclasses import replace

import msgspec
import pytest

from grasp_core.dataset.review import Item, Review, Rule
from grasp_core.errors import GraspError
from grasp_core.gripper import load_gripper
from workbench.bridge import read_message
from workbench.curate import actions as a
from workbench.curate.panels.sample_panel import EDITS, READERS, SamplePanel
from workbench.curate.state import Conflict, Playing
from workbench.curate.values import Decision


@pytest.fixture
def panel(curation_bridge):
    return SamplePanel(curation_bridge, load_gripper())


def test_all_that_is_known_is_shown(panel, client, state):
    panel.update(None, state)
    page = client.page()
    assert "2 of 2 DART attempts succeeded" in page and 'data-quality="2/2"' in page and "0.34 to 1.00" in page
    assert page.count("data-attempt=") == 2 and 'data-shown="2"' in page


def test_a_blind_review_shows_no_measure(panel, client, state):
    row = msgspec.structs.replace(state.sample.row, score=0.123, heat=0.456, source="human", label=0.77)
    sample = replace(state.sample, row=row)
    blind = replace(state, sample=sample, review=Review(1, "ann", Rule(blind=True), 3, 0), item=Item(1, 0, 2, False))
    panel.update(None, blind)
    page = client.page()
    for secret in ("0.123", "0.46", "0.77", "data-attempt", "data-quality", "succeeded", "gw-on"):
        assert secret not in page, secret
    assert "✓ Good" in page


def test_conflicts_and_unsaved_decisions_come_first(panel, client, state, store):
    event = store.add_label(2, "bob", 0.5)
    decision = Decision(2, 0.0)
    panel.update(
        None, replace(state, conflicts=(Conflict(decision, (event,)),), unsaved=(decision,), trouble="disk full")
    )
    page = client.page()
    assert "bob set 0.5" in page and "Leave it to bob" in page and "1 not saved" in page and "disk full" in page


def test_what_is_saved_is_said(panel, client, state):
    panel.update(None, replace(state, pending=(Decision(1, 0.0),)))
    assert "1 on their way" in client.page() and "data-saved" not in client.page()
    panel.update(None, replace(state, saved=7))
    assert 'data-saved="7"' in client.page()


def test_a_replay_that_differs_is_marked(panel, client, state, played):
    panel.update(None, replace(state, playing=Playing(2, replace(played, same=False, words="ends otherwise now"))))
    assert 'class="gw-error" data-played="1"' in client.page() and "Ends otherwise now." in client.page()
    assert client.only("slider", "Replay s").max == 2.0


def test_notes_cannot_smuggle_html(panel, client, state, store):
    event = store.add_label(2, "<script>", 0.5)
    panel.update(
        None, replace(state, conflicts=2 * (Conflict(Decision(2, 0.0), (event,)),), trouble="<b>x", unsaved=())
    )
    assert "<script>" not in client.page() and "1 more after this one" in client.page()


def test_keys_of_the_number_pad_edit(panel, client, state, posted):
    assert set(EDITS) == set("12346789")
    panel.update(None, replace(state, edited=state.sample.row.grasp))
    assert "data-editing" in client.page() and "Store and verify" in client.page()
    assert "data-attempt" not in client.page() and not client.only("slider", "Replay s").visible  # there is room for it
    panel.update(None, state)
    assert "2 success" in client.page()


@pytest.mark.parametrize(
    ("message", "action"),
    [
        ("cdecide:good", a.Decide(1.0)),
        ("cdecide:exclude", a.Decide("exclude")),
        ("cmove:-1", a.Move(-1)),
        ("cnudge:-1", a.Nudge(-0.1)),
        ("cdrag:3.5,-2.0", a.Edit(right=3.5, down=-2.0)),
        ("cend:10.0,20.0", a.DragEnd(10.0, 20.0)),
        ("cstore:verify", a.EndEdit(True, True)),
        ("cstore:no", a.EndEdit(False)),
        ("cmine:yes", a.Resolve(True)),
    ],
)
def test_messages(message, action):
    assert read_message(f"{message}:1", READERS) == action


def test_other_decisions_are_refused():
    with pytest.raises(GraspError):
        read_message("cdecide:revert:1", READERS)
