"""The plain state of one browser's curation."""

from __future__ import annotations

from dataclasses import dataclass

from grasp_core.dataset.bulk import BulkPlan
from grasp_core.dataset.labels import LabelEvent
from grasp_core.dataset.lists import Key
from grasp_core.dataset.queries import Query
from grasp_core.dataset.review import Item, Review
from grasp_core.grasp import Grasp
from grasp_core.simulation.recording import Recording
from workbench.curate.values import Decision, Facts, Played, Sample, Shelf
from workbench.playback import Replay

START = Query(sort="id")
"""The list that a new browser opens on."""


@dataclass(frozen=True)
class Conflict:
    """An own decision, and what a colleague decided meanwhile."""

    decision: Decision
    events: tuple[LabelEvent, ...]


@dataclass(frozen=True)
class BulkAsk:
    """A bulk decision that waits for a yes."""

    query: Query
    decision: float | str
    plan: BulkPlan


@dataclass(frozen=True)
class Playing(Replay):
    """A replay.

    Attributes:
        grasp: id of the sample.
        played: what is shown.
    """

    grasp: int
    played: Played

    @property
    def recording(self) -> Recording:
        """What is played."""
        return self.played.recording


@dataclass(frozen=True)
class State:
    """Everything that one browser shows of the curation.

    Attributes:
        person: who sits here, self-declared; "" until asked.
        query: of the list.
        keys: where each page up to the one shown begins.
        ticket: of the newest wanted page.
        loading: it is not there yet.
        shelf: the page that is shown.
        sample: the sample that is shown.
        wanted: id of the sample that is wanted.
        note: goes with the next decision.
        pending: decisions on their way, oldest first.
        unsaved: decisions that could not be stored.
        trouble: why.
        saved: decisions of this visit that are on disk.
        conflicts: wait for an answer, the oldest first.
        bulk: likewise.
        busy: what the worker does for this browser.
        relabelling: samples done and to do of the bulk decision under way.
        scoring: scenes scored and to score, while that runs.
        review: that is gone through.
        item: the sample of it that is shown.
        edited: the changed rectangle.
        playing: the replay.
        facts: of the dataset, None before it is open.
        failure: why it cannot be opened.
        about: whose history is shown.
        events: of that person, newest first.
        gone: ids of those of them that were taken back.
        older: there are more.
    """

    person: str = ""
    query: Query = START
    keys: tuple[Key | None, ...] = (None,)
    ticket: int = 0
    loading: bool = False
    shelf: Shelf | None = None
    sample: Sample | None = None
    wanted: int | None = None
    note: str = ""
    pending: tuple[Decision, ...] = ()
    unsaved: tuple[Decision, ...] = ()
    trouble: str = ""
    saved: int = 0
    conflicts: tuple[Conflict, ...] = ()
    bulk: BulkAsk | None = None
    busy: str = ""
    relabelling: tuple[int, int] | None = None
    scoring: tuple[int, int] | None = None
    review: Review | None = None
    item: Item | None = None
    edited: Grasp | None = None
    playing: Playing | None = None
    facts: Facts | None = None
    failure: str = ""
    about: str = ""
    events: tuple[LabelEvent, ...] = ()
    gone: frozenset[int] = frozenset()
    older: bool = False

    @property
    def blind(self) -> bool:
        """Score, quality, attempts and labels are hidden."""
        return self.review is not None and self.review.rule.blind

    @property
    def place(self) -> int | None:
        """Where the sample that is shown stands on the page."""
        if self.shelf is None or self.sample is None:
            return None
        ids = [thumb.row.id for thumb in self.shelf.thumbs]
        return ids.index(self.sample.row.id) if self.sample.row.id in ids else None
