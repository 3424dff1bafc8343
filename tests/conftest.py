"""How the tests are shared out among processes (pytest-xdist)."""

import pytest


def pytest_collection_modifyitems(items):
    """A file's tests share what they set up; one browser at a time is all that two cores can draw for."""
    for item in items:
        group = "browser" if "browser" in item.path.parts else str(item.path)
        item.add_marker(pytest.mark.xdist_group(group))
