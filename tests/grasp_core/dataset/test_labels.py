import pytest

from grasp_core.dataset.labels import LabelEvent, current_label, standing


def event(number, kind, value=None, reverts=None, person="ann"):
    return LabelEvent(
        id=number,
        uid=str(number),
        grasp=1,
        at=number,
        person=person,
        source="human",
        kind=kind,
        value=value,
        old_value=None,
        new_value=None,
        reason="",
        reverts=reverts,
    )


def test_attempts_pooled_without_decision():
    label = current_label([], 3, 5)
    assert (label.value, label.state, label.source) == (0.6, "labelled", "dart")
    assert label.reason == "3 of 5 DART attempts succeeded"


def test_nothing_known():
    label = current_label([], 0, 0)
    assert (label.value, label.state, label.source) == (None, "unlabelled", "none")


def test_newest_decision_wins_over_attempts_and_older_ones():
    label = current_label([event(1, "value", 1.0), event(2, "value", 0.0, person="bob")], 5, 5)
    assert (label.value, label.source, label.event) == (0.0, "human", 2)
    assert "bob" in label.reason


@pytest.mark.parametrize(("kind", "state"), [("unsure", "unsure"), ("exclude", "excluded")])
def test_unsure_and_exclude_leave_the_sample_out(kind, state):
    label = current_label([event(1, "value", 1.0), event(2, kind)], 5, 5)
    assert (label.value, label.state, label.source) == (None, state, "human")


def test_remarks_decide_nothing():
    events = [event(1, "note"), event(2, "opinion", 0.0), event(3, "flag"), event(4, "attempts")]
    label = current_label(events, 4, 5)
    assert (label.value, label.source, label.flagged) == (0.8, "dart", True)
    assert not current_label([*events, event(5, "unflag")], 4, 5).flagged


def test_revert_and_redo():
    decide, undo = event(1, "value", 0.0), event(2, "revert", reverts=1)
    assert current_label([decide, undo], 5, 5).value == 1.0
    redo = event(3, "revert", reverts=2)
    assert [e.id for e in standing([decide, undo, redo])] == [1, 3]
    assert current_label([decide, undo, redo], 5, 5).value == 0.0


def test_revert_brings_back_the_decision_before():
    events = [event(1, "value", 0.4), event(2, "exclude"), event(3, "revert", reverts=2)]
    label = current_label(events, 5, 5)
    assert (label.value, label.event) == (0.4, 1)


def test_value_zero_is_a_value():
    assert current_label([event(1, "value", 0.0)], 5, 5).value == 0.0
