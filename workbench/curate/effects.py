"""What the curation asks the desk and the worker for, as plain values."""

from __future__ import annotations

from dataclasses import dataclass

from grasp_core.dataset.bulk import BulkPlan
from grasp_core.dataset.lists import Key
from grasp_core.dataset.queries import Query
from grasp_core.dataset.review import Item, Rule
from grasp_core.grasp import Grasp
from workbench.actions import Effect
from workbench.curate.values import Decision


@dataclass(frozen=True)
class LoadFacts(Effect):
    """Read `Facts`; the first time this opens the dataset."""

    person: str


@dataclass(frozen=True)
class LoadShelf(Effect):
    """Read a page, and show the sample at `pick` (-1: the last one; None: none)."""

    ticket: int
    query: Query
    after: Key | None
    pick: int | None


@dataclass(frozen=True)
class LoadSample(Effect):
    """Read a sample."""

    grasp: int


@dataclass(frozen=True)
class LoadNext(Effect):
    """The next sample of a review, after skipping `skip`."""

    review: int
    skip: Item | None = None


@dataclass(frozen=True)
class Save(Effect):
    """Store a decision."""

    decision: Decision
    person: str


@dataclass(frozen=True)
class StepBack(Effect):
    """Undo or redo."""

    person: str
    redo: bool


@dataclass(frozen=True)
class Revert(Effect):
    """Revert an event."""

    event: int
    person: str


@dataclass(frozen=True)
class Count(Effect):
    """Count a bulk decision."""

    query: Query
    decision: float | str


@dataclass(frozen=True)
class Relabel(Effect):
    """Do a bulk decision."""

    query: Query
    decision: float | str
    plan: BulkPlan
    person: str


@dataclass(frozen=True)
class StopRelabel(Effect):
    """Stop a person's bulk decision that is under way; no label is changed then."""

    person: str


@dataclass(frozen=True)
class MakeReview(Effect):
    """Choose and store a queue."""

    rule: Rule
    person: str


@dataclass(frozen=True)
class StoreGrasp(Effect):
    """Store an edited rectangle; verify it with so many attempts."""

    parent: int
    grasp: Grasp
    person: str
    verify: int


@dataclass(frozen=True)
class TryMore(Effect):
    """Verify a sample."""

    grasp: int
    attempts: int
    person: str


@dataclass(frozen=True)
class PlayAttempt(Effect):
    """Replay a stored attempt."""

    grasp: int
    number: int


@dataclass(frozen=True)
class KeepQuery(Effect):
    """Save a view, or forget it (None)."""

    name: str
    query: Query | None
    person: str


@dataclass(frozen=True)
class ScoreMore(Effect):
    """Score further scenes."""


@dataclass(frozen=True)
class LoadPerson(Effect):
    """Read a person's events, newest first, those before the event `before` if given."""

    name: str
    before: int | None = None


@dataclass(frozen=True)
class Export(Effect):
    """Make the JSON Lines."""


@dataclass(frozen=True)
class Import(Effect):
    """Merge JSON Lines."""

    content: bytes
