from dataclasses import FrozenInstanceError, fields, is_dataclass

import pytest

from workbench.inspector import actions as a
from workbench.inspector.rules import reduce as _reduce
from workbench.inspector.rules.registry import has_rule

KINDS = [
    value
    for value in vars(a).values()
    if isinstance(value, type) and issubclass(value, a.InspectorAction) and value is not a.InspectorAction
]


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_actions_are_frozen_values_with_a_rule(kind):
    assert is_dataclass(kind) and has_rule(kind)
    value = kind(**{field.name: None for field in fields(kind)})
    assert value == kind(**{field.name: None for field in fields(kind)})
    for field in fields(kind):
        with pytest.raises(FrozenInstanceError):
            setattr(value, field.name, 1)


def test_there_are_many_and_rules_are_loaded():
    assert len(KINDS) > 25 and callable(_reduce)
