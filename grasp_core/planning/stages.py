"""The clock of a plan: how long each stage took, and whether there is time left."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

_OUTPUT_MS = 1.0
"""Milliseconds kept back for the last stage, which makes candidates of some hundred scored grasps."""


class Stages:
    """Measures stages of work from its making on.

    Attributes:
        ms: stage → milliseconds so far; a stage that runs twice adds up.
        step_ms: the longest step so far of those that are cut to fit into a budget, foreseen for the next one.
    """

    def __init__(self, budget_ms: float | None = None) -> None:
        self.ms: dict[str, float] = {}
        self.step_ms = 0.0
        self._start = time.perf_counter()
        self._budget = budget_ms

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Count the time of the block for the stage `name`."""
        start = time.perf_counter()
        try:
            yield
        finally:
            self.ms[name] = self.ms.get(name, 0.0) + (time.perf_counter() - start) * 1000

    @property
    def elapsed_ms(self) -> float:
        """Milliseconds since the start."""
        return (time.perf_counter() - self._start) * 1000

    @property
    def limited(self) -> bool:
        """Whether there is a budget."""
        return self._budget is not None

    def allows(self, more_ms: float) -> bool:
        """Whether work of about `more_ms` still fits into the budget, and the output after it."""
        return self._budget is None or self.elapsed_ms + more_ms + _OUTPUT_MS <= self._budget
