import dataclasses
import inspect

from workbench.actions import Action, Effect
from workbench.curate import actions, effects


def test_actions_are_frozen_and_the_view_s_own():
    kinds = [kind for _, kind in inspect.getmembers(actions, inspect.isclass) if kind.__module__ == actions.__name__]
    for kind in kinds:
        assert issubclass(kind, actions.CurateAction) and issubclass(kind, Action) and not issubclass(kind, Effect)
        if kind is not actions.CurateAction:
            assert dataclasses.is_dataclass(kind) and kind.__dataclass_params__.frozen
    assert not any(issubclass(kind, tuple(kinds)) for _, kind in inspect.getmembers(effects, inspect.isclass))
