"""Which rule belongs to which action."""

from __future__ import annotations

from collections.abc import Callable
from functools import singledispatch
from typing import Any

from workbench.actions import Action, Effect
from workbench.inspector.state import State

Result = tuple[State, tuple[Effect, ...]]
Rule = Callable[[Any, State], Result]


@singledispatch
def _apply(action: Any, state: State) -> Result:
    raise TypeError(f"no rule for {type(action).__name__}")


def reduce(state: State, action: Action) -> Result:
    """The next state and what has to be done; actions that no longer fit (late answers) change nothing."""
    return _apply(action, state)


def rule(kind: type) -> Callable[[Rule], Rule]:
    """The decorated function is the rule of actions of this kind."""
    return _apply.register(kind)


def has_rule(kind: type) -> bool:
    """Whether actions of this kind have a rule."""
    return _apply.dispatch(kind) is not _apply.dispatch(object)
