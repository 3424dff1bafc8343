"""Which function applies which action; each module of rules registers its own here."""

from __future__ import annotations

from collections.abc import Callable
from functools import singledispatch
from typing import Any

from workbench.actions import Effect, Notice
from workbench.curate.state import State

Result = tuple[State, tuple[Effect, ...]]


@singledispatch
def apply(action: Any, state: State) -> Result:
    """The next state and what has to be done; answers that no longer fit change nothing."""
    raise TypeError(f"no rule for {type(action).__name__}")


def rule(kind: type) -> Callable[[Callable[[Any, State], Result]], Callable[[Any, State], Result]]:
    """Register a function for one kind of action."""
    return apply.register(kind)


def nameless(state: State) -> Result | None:
    """A reminder where nobody has said who they are; None otherwise."""
    if state.person:
        return None
    return state, (Notice("warning", "Who are you?", "Write your name on the left first: every decision carries one."),)
