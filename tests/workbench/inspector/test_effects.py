from dataclasses import FrozenInstanceError, fields, is_dataclass

import pytest

from workbench.inspector import effects as e

KINDS = [
    value
    for value in vars(e).values()
    if isinstance(value, type) and issubclass(value, e.InspectorEffect) and value is not e.InspectorEffect
]


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_effects_are_frozen_values(kind):
    assert is_dataclass(kind)
    value = kind(**{field.name: None for field in fields(kind)})
    for field in fields(kind):
        with pytest.raises(FrozenInstanceError):
            setattr(value, field.name, 1)
