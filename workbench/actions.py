"""What can happen in any view of the workbench, as plain values.

Handlers and finished jobs only enqueue an `Action`; once a tick `state.reduce` turns state and action into the next
state and some `Effect`s, the work that somebody else then does. Each view derives its own actions and effects.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


class Action:
    """Base of all actions."""


class Effect:
    """Base of all effects."""


@dataclass(frozen=True)
class Notice(Action, Effect):
    """Tell the user something: as an action it passes straight through."""

    tone: Literal["info", "warning", "error"]
    title: str
    body: str


@dataclass(frozen=True)
class Download(Effect):
    """Hand the browser a file to save."""

    name: str
    content: bytes


@dataclass(frozen=True)
class Tick(Action):
    """Time has passed; `now` in seconds of a monotonic clock."""

    now: float


@dataclass(frozen=True)
class Arrive(Action):
    """A page was loaded under an address with this query (`view=…&…`)."""

    query: str


@dataclass(frozen=True)
class ShowView(Action):
    """Change to the view of this name."""

    name: str


@dataclass(frozen=True)
class ShowKeys(Action, Effect):
    """List every hotkey: as an action it passes straight through."""


@dataclass(frozen=True)
class ToggleTheme(Action):
    """From dark to light and back."""
