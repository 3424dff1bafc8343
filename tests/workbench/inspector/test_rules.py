from workbench.inspector import actions as a
from workbench.inspector.rules import reduce


def test_importing_the_package_registers_all_rules(shown):
    state, effects = reduce(shown, a.Toggle("grid"))
    assert "grid" not in state.shown and effects == ()
