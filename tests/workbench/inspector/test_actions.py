from dataclasses import FrozenInstanceError, fields, is_dataclass

import pytest

from workbench.inspector import actions as a

KINDS = [
    value
    for value in vars(a).values()
    if isinstance(value, type)
    and issubclass(value, a.Action | a.Effect)
    and value not in (a.Action, a.Effect, a.InspectorAction)
]


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_actions_and_effects_are_frozen_values(kind):
    assert is_dataclass(kind)
    value = kind(**{field.name: None for field in fields(kind)})
    assert value == kind(**{field.name: None for field in fields(kind)})
    for field in fields(kind):
        with pytest.raises(FrozenInstanceError):
            setattr(value, field.name, 1)
