import msgspec
import pytest

from workbench.curate.values import Decision


@pytest.mark.parametrize("decision", [Decision(3, 0.5, "rim", 9), Decision(3, "exclude", review=2, place=1)])
def test_decisions_travel_as_json(decision):
    assert msgspec.json.decode(msgspec.json.encode(decision), type=Decision) == decision


def test_what_was_seen_is_the_newest_event(desk, store):
    assert desk.sample(1).seen == 0
    event = store.add_label(1, "ann", 0.5)
    assert desk.sample(1).seen == event.id
