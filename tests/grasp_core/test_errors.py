import inspect

import pytest

from grasp_core import errors

CHILDREN = [kind for _, kind in inspect.getmembers(errors, inspect.isclass) if kind is not errors.GraspError]


@pytest.mark.parametrize("kind", CHILDREN)
def test_every_error_is_a_grasp_error_and_keeps_its_message(kind):
    with pytest.raises(errors.GraspError, match="what was wrong; the way out"):
        raise kind("what was wrong; the way out")


@pytest.mark.parametrize("kind", [errors.GraspError, *CHILDREN])
def test_every_error_says_when_it_is_raised(kind):
    assert kind.__doc__ and len(kind.__doc__) > 20


def test_a_programming_error_is_not_a_users_error():
    assert not issubclass(ValueError, errors.GraspError)
    assert not any(issubclass(kind, ValueError | OSError | KeyError) for kind in CHILDREN)
