"""What a view of the workbench is: a whole screenful (the inspector, the curation) that plugs into the shell.

The shell keeps browsers, sessions, theme and links; a view brings its state, the rules that change it, the widgets that
show it, and what does its effects. Adding a view is adding an object of this shape to `app.Workbench`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Protocol

from workbench.actions import Action, Effect
from workbench.bridge import Bridge, Reader

Post = Callable[[Action], None]


class Part(Protocol):
    """Something on the screen."""

    def update(self, old: Any | None, new: Any) -> None:
        """Bring what is shown from a state of the view (None: nothing yet) to another."""
        ...


class View(Protocol):
    """One view.

    Attributes:
        name: in links, `?view=name`; also the key of its state and of what browsers keep for it.
        label: for people.
        actions: base class of its actions.
        readers: what its HTML may send, by verb; verbs are the view's own.
    """

    name: str
    label: str
    actions: type[Action]
    readers: Mapping[str, Reader]

    def first(self, kept: Mapping[str, Any]) -> Any:
        """The state that a new browser starts with.

        Args:
            kept: what `keep` gave when this browser was last here; empty, or whatever a browser claims.
        """
        ...

    def arrive(self, state: Any, query: Mapping[str, str], shown: bool) -> tuple[Any, tuple[Effect, ...]]:
        """A page was loaded with this query; `shown`: it shows this view. Bad values become notices, never errors."""
        ...

    def reduce(self, state: Any, action: Action) -> tuple[Any, tuple[Effect, ...]]:
        """The next state and what has to be done."""
        ...

    def ticking(self, state: Any) -> bool:
        """Whether `Tick`s are wanted, 30 a second."""
        ...

    def moving(self, state: Any) -> bool:
        """Whether a person is moving something right now: what need not follow at once waits for the end of it."""
        ...

    def link(self, state: Any) -> Mapping[str, str]:
        """The query that restores this state, besides `view`."""
        ...

    def keep(self, state: Any) -> Mapping[str, Any]:
        """What this browser keeps for its next visit; JSON."""
        ...

    def show(self, bridge: Bridge, state: Any) -> Part:
        """Make the view's widgets in one browser; called once per connection, inside a section that the shell hides."""
        ...

    def perform(self, post: Post, effect: Effect) -> bool:
        """Start doing an effect; False when it belongs to others."""
        ...
