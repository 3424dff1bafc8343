"""One browser's workbench: a queue of actions, the state, and the screen that shows it while it is connected."""

from __future__ import annotations

import queue
import re
import secrets
import threading
import time
from collections.abc import Callable, Mapping
from typing import Any, Protocol

from workbench.actions import Action, Effect, Tick
from workbench.state import Shell, State

FRAME = 1 / 30
"""Seconds between two ticks."""
KEEP = 600.0
"""Seconds that the state of a browser that left is kept for its return."""
MOST = 32
"""At most so many browsers that left are remembered."""
_TOKEN = re.compile(r"[0-9a-f]{32}")


class Screen(Protocol):
    """What shows a state in one browser."""

    def update(self, old: State | None, new: State) -> None:
        """Bring what is shown from `old` (None: nothing yet) to `new`."""

    def perform(self, effect: Effect) -> bool:
        """Do an effect that belongs to the browser (a notification); False when it belongs to others."""


class Session:
    """State and queue of one browser.

    Attributes:
        token: that the browser keeps.
        state: touched by `step` and `show` only, on one thread.
        left: when the browser left, by the monotonic clock; None while it is there.
    """

    def __init__(self, token: str, shell: Shell, state: State, wake: Callable[[], None]) -> None:
        self.token = token
        self.state = state
        self.left: float | None = time.monotonic()
        self._shell = shell
        self._queue: queue.SimpleQueue[Action] = queue.SimpleQueue()
        self._wake = wake
        self._screen: Screen | None = None
        self._new_screen: queue.SimpleQueue[Screen | None] = queue.SimpleQueue()
        self._next_frame: float | None = None
        self._shown: State | None = None

    def post(self, action: Action) -> None:
        """Enqueue an action; from any thread."""
        self._queue.put(action)
        self._wake()

    def attach(self, screen: Screen | None) -> None:
        """Show the state on another screen from the next step on; None when the browser left."""
        self.left = time.monotonic() if screen is None else None
        self._new_screen.put(screen)
        self._wake()

    def step(self, now: float) -> tuple[tuple[Effect, ...], float | None]:
        """Drain the queue and reduce; `show` then brings it to the screen, so that work starts before it is drawn.

        Args:
            now: monotonic clock, seconds.

        Returns:
            effects for others to do, and when to step again at the latest (None: when woken).
        """
        while not self._new_screen.empty():
            self._screen = self._new_screen.get()
            self._shown = None
        effects: list[Effect] = []
        while not self._queue.empty():
            self.state, more = self._shell.reduce(self.state, self._queue.get())
            effects.extend(more)
        ticking = self._shell.ticking(self.state)
        if ticking and (self._next_frame is None or now >= self._next_frame):
            # Deadlines are absolute, so that a late frame does not delay those after it.
            late = self._next_frame is None or now - self._next_frame > FRAME
            self._next_frame = now + FRAME if late else (self._next_frame or now) + FRAME
            self.state, more = self._shell.reduce(self.state, Tick(now))
            effects.extend(more)
        elif not ticking:
            self._next_frame = None
        rest = tuple(effect for effect in effects if self._screen is None or not self._screen.perform(effect))
        return rest, self._next_frame

    def show(self) -> None:
        """Bring the screen from what it shows to the state."""
        if self._screen is not None and self._shown is not self.state:
            before, self._shown = self._shown, self.state
            self._screen.update(before, self.state)


class Sessions:
    """All browsers, by token.

    Args:
        shell: the views.
        wake: called when a session has something to do.
    """

    def __init__(self, shell: Shell, wake: Callable[[], None]) -> None:
        self._shell = shell
        self._wake = wake
        self._lock = threading.Lock()
        self._all: dict[str, Session] = {}

    def claim(self, token: str | None, kept: Mapping[str, Any]) -> tuple[Session, bool]:
        """The session of a browser that shows `token`, and whether it is new.

        A token that is malformed, unknown, or in use by another page (two tabs of a browser) gets a new session, which
        starts with what the browser `kept`.
        """
        with self._lock:
            self._forget()
            found = self._all.get(token) if token is not None and _TOKEN.fullmatch(token) else None
            if found is not None and found.left is not None:
                found.left = None
                return found, False
            session = Session(secrets.token_hex(16), self._shell, self._shell.first(kept), self._wake)
            session.left = None
            self._all[session.token] = session
            return session, True

    def _forget(self) -> None:
        now = time.monotonic()
        gone = sorted((s for s in self._all.values() if s.left is not None), key=lambda s: s.left or 0.0)
        for number, session in enumerate(reversed(gone)):
            if number >= MOST or now - (session.left or now) > KEEP:
                del self._all[session.token]

    def all(self) -> list[Session]:
        """Those that are remembered."""
        with self._lock:
            return list(self._all.values())
