import inspect

from workbench.inspector.view import Inspector
from workbench.view import View

METHODS = [name for name, value in vars(View).items() if inspect.isfunction(value) and not name.startswith("_")]


def test_the_inspector_has_the_shape_of_a_view():
    for name in METHODS:
        ours, wanted = (list(inspect.signature(getattr(kind, name)).parameters) for kind in (Inspector, View))
        assert ours == wanted, name


def test_the_smallest_view_has_it_too(counter):
    assert all(callable(getattr(counter, name)) for name in METHODS)
