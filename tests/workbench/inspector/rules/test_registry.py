import pytest

from workbench.actions import Action
from workbench.inspector.rules.registry import has_rule, reduce, rule


class Ring(Action):
    pass


def test_rules_are_found_by_kind(shown):
    with pytest.raises(TypeError, match="Ring"):
        reduce(shown, Ring())
    rule(Ring)(lambda action, state: (state, ("rung",)))
    assert has_rule(Ring) and reduce(shown, Ring()) == (shown, ("rung",))
