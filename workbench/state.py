"""The plain state of one browser's workbench, and how actions change it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any
from urllib.parse import parse_qsl, urlencode

from workbench.actions import Action, Arrive, Effect, Notice, ShowKeys, ShowView, Tick, ToggleTheme
from workbench.view import View

Result = tuple["State", tuple[Effect, ...]]


@dataclass(frozen=True)
class State:
    """Everything that one browser shows.

    Attributes:
        view: name of the view that is shown.
        dark: the theme.
        of: view → its state.
        arrivals: how often a page was loaded.
    """

    view: str
    dark: bool
    of: Mapping[str, Any]
    arrivals: int = 0

    def having(self, name: str, state: Any) -> State:
        """The same with another state of one view."""
        return replace(self, of={**self.of, name: state})


class Shell:
    """All views, and the rules that they share.

    Args:
        views: the first one is shown unless a link says otherwise.
    """

    def __init__(self, views: Sequence[View]) -> None:
        self.views = {view.name: view for view in views}

    def first(self, kept: Mapping[str, Any]) -> State:
        """The state of a new browser; `kept` is what it claims to have kept."""
        own = {name: _mapping(kept.get(name)) for name in self.views}
        dark = kept.get("dark", True)
        states = {name: view.first(own[name]) for name, view in self.views.items()}
        return State(next(iter(self.views)), dark if isinstance(dark, bool) else True, states)

    def reduce(self, state: State, action: Action) -> Result:
        """The next state and what has to be done; actions that no longer fit (late answers) change nothing."""
        match action:
            case Notice() | ShowKeys():
                return state, (action,)
            case ShowView(name):
                return (replace(state, view=name) if name in self.views else state), ()
            case ToggleTheme():
                return replace(state, dark=not state.dark), ()
            case Arrive(query):
                return self._arrive(state, query)
            case Tick():
                view = self.views[state.view]
                changed, effects = view.reduce(state.of[view.name], action)
                return state.having(view.name, changed), effects
        for view in self.views.values():
            if isinstance(action, view.actions):
                changed, effects = view.reduce(state.of[view.name], action)
                return (state if changed is state.of[view.name] else state.having(view.name, changed)), effects
        raise TypeError(f"no view knows the action {type(action).__name__}")

    def _arrive(self, state: State, query: str) -> Result:
        """Follow the link that a page was loaded under; a reload of what is shown changes nothing."""
        before, state = state.arrivals, replace(state, arrivals=state.arrivals + 1)
        if before and _ours(query, self.link(state)):
            return state, ()
        values = dict(parse_qsl(query, max_num_fields=64)) if len(query) < 8000 else {}
        wanted = values.get("view", "")
        effects: tuple[Effect, ...] = ()
        if wanted and wanted not in self.views:
            told = f"There is no view '{wanted[:40]}'; the views are: {', '.join(self.views)}."
            effects = (Notice("warning", "This link names an unknown view", told),)
        state = replace(state, view=wanted if wanted in self.views else state.view)
        for name, view in self.views.items():
            changed, more = view.arrive(state.of[name], values, name == state.view)
            state, effects = state.having(name, changed), effects + tuple(more)
        return state, effects

    def ticking(self, state: State) -> bool:
        """Whether the view that is shown wants ticks."""
        return self.views[state.view].ticking(state.of[state.view])

    def moving(self, state: State) -> bool:
        """Whether something is being moved by hand in the view that is shown."""
        return self.views[state.view].moving(state.of[state.view])

    def link(self, state: State) -> str:
        """The query of a link to what is shown."""
        return urlencode({"view": state.view, **self.views[state.view].link(state.of[state.view])}, safe=",:.")

    def keep(self, state: State) -> dict[str, Any]:
        """What the browser keeps for its next visit; JSON."""
        return {"dark": state.dark, **{name: dict(view.keep(state.of[name])) for name, view in self.views.items()}}


def _mapping(value: Any) -> Mapping[str, Any]:
    return value if isinstance(value, dict) else {}


def _ours(query: str, link: str) -> bool:
    """Whether all of a link stands in a query; others may have added to it."""
    return set(parse_qsl(link)) <= set(parse_qsl(query))
