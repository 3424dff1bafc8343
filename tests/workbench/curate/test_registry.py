import inspect
from dataclasses import replace

import pytest

from workbench.curate import actions
from workbench.curate.registry import apply, nameless


def test_every_action_has_its_rule():
    own = {actions.Edit, actions.DragEnd}  # these need the gripper: see `trying.Rules`
    kinds = [
        kind
        for _, kind in inspect.getmembers(actions, inspect.isclass)
        if issubclass(kind, actions.CurateAction) and kind is not actions.CurateAction and kind not in own
    ]
    assert len(kinds) > 30
    plain = apply.dispatch(object)
    assert [kind for kind in kinds if apply.dispatch(kind) is plain] == []


def test_foreign_actions_are_an_error(state):
    with pytest.raises(TypeError, match="no rule"):
        apply(object(), state)


def test_names_are_asked_for(state):
    assert nameless(state) is None
    assert nameless(replace(state, person=""))[1][0].title == "Who are you?"
