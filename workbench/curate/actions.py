"""Everything that can happen in the curation, as plain values."""

from __future__ import annotations

from dataclasses import dataclass

from grasp_core.dataset.bulk import BulkPlan
from grasp_core.dataset.labels import LabelEvent
from grasp_core.dataset.queries import Query
from grasp_core.dataset.review import Item, Review, Rule
from grasp_core.dataset.rows import GraspRow
from workbench.actions import Action, Download
from workbench.curate.values import Decision, Facts, Played, Sample, Shelf


class CurateAction(Action):
    """Base of all actions of the curation."""


@dataclass(frozen=True)
class SayName(CurateAction):
    """Who sits at this browser."""

    name: str


@dataclass(frozen=True)
class Filter(CurateAction):
    """Set one field of the list's query; an empty text switches the filter off."""

    field: str
    text: str


@dataclass(frozen=True)
class UseQuery(CurateAction):
    """Show another list."""

    query: Query


@dataclass(frozen=True)
class Reload(CurateAction):
    """Read everything that is shown anew."""


@dataclass(frozen=True)
class OpenView(CurateAction):
    """Show a saved list."""

    name: str


@dataclass(frozen=True)
class TurnPage(CurateAction):
    """The next page of the list, or the one before."""

    by: int


@dataclass(frozen=True)
class Pick(CurateAction):
    """Show this sample."""

    grasp: int


@dataclass(frozen=True)
class Move(CurateAction):
    """The next sample of the list, or the one before; in a review the next one skips."""

    by: int


@dataclass(frozen=True)
class Decide(CurateAction):
    """A decision on the sample that is shown."""

    decision: float | str


@dataclass(frozen=True)
class Nudge(CurateAction):
    """Give the sample a value so much above (below) its label."""

    by: float


@dataclass(frozen=True)
class WriteNote(CurateAction):
    """The note that goes with the next decision."""

    text: str


@dataclass(frozen=True)
class AddNote(CurateAction):
    """Store the note by itself."""


@dataclass(frozen=True)
class TakeBack(CurateAction):
    """Undo the person's newest step, or redo the one that was undone."""

    redo: bool


@dataclass(frozen=True)
class RevertEvent(CurateAction):
    """Take any label event back."""

    event: int


@dataclass(frozen=True)
class Retry(CurateAction):
    """Try again to store what could not be stored."""


@dataclass(frozen=True)
class Resolve(CurateAction):
    """After a conflict: store the own decision over the colleague's, or leave theirs."""

    mine: bool


@dataclass(frozen=True)
class Verify(CurateAction):
    """Run more DART attempts on a sample, by default the one that is shown."""

    attempts: int
    grasp: int | None = None


@dataclass(frozen=True)
class ReplayAttempt(CurateAction):
    """Execute a stored attempt again and show it."""

    number: int


@dataclass(frozen=True)
class TogglePlay(CurateAction):
    """Play or pause."""


@dataclass(frozen=True)
class Seek(CurateAction):
    """Go to a time of the replay, seconds, and pause there."""

    time: float


@dataclass(frozen=True)
class Edit(CurateAction):
    """Change the sample's rectangle: pixels to the right and down, rad, factor of the width."""

    right: float = 0.0
    down: float = 0.0
    turn: float = 0.0
    widen: float = 1.0


@dataclass(frozen=True)
class DragEnd(CurateAction):
    """The end of the rectangle's closing axis was dragged to this pixel."""

    u: float
    v: float


@dataclass(frozen=True)
class EndEdit(CurateAction):
    """Store the edited rectangle as a new grasp (and verify it), or forget it."""

    store: bool
    verify: bool = False


@dataclass(frozen=True)
class CountBulk(CurateAction):
    """Count what a decision on the whole list would do."""

    decision: float | str


@dataclass(frozen=True)
class AnswerBulk(CurateAction):
    """Do what was counted, or leave it."""

    go: bool


@dataclass(frozen=True)
class StopBulk(CurateAction):
    """Stop the bulk decision that is under way."""


@dataclass(frozen=True)
class StartReview(CurateAction):
    """Make a queue and go through it."""

    rule: Rule


@dataclass(frozen=True)
class ResumeReview(CurateAction):
    """Go on with a review, or leave it (None)."""

    review: int | None


@dataclass(frozen=True)
class KeepView(CurateAction):
    """Save the list's query under a name, or forget that name."""

    name: str
    forget: bool = False


@dataclass(frozen=True)
class ScoreAll(CurateAction):
    """Score every grasp with the shipped weights, in the background; again: stop."""


@dataclass(frozen=True)
class ShowPerson(CurateAction):
    """The history of a person; "" hides it."""

    name: str


@dataclass(frozen=True)
class OlderEvents(CurateAction):
    """More of the history of the person that is shown."""


@dataclass(frozen=True)
class ExportEvents(CurateAction):
    """Hand out all label events as JSON Lines."""


@dataclass(frozen=True)
class ImportEvents(CurateAction):
    """Add the label events of a JSON Lines file."""

    content: bytes


# answers


@dataclass(frozen=True)
class ShelfShown(CurateAction):
    """A page that was asked for; `pick` is the place of the sample to show, None for none."""

    ticket: int
    shelf: Shelf
    pick: int | None


@dataclass(frozen=True)
class SampleShown(CurateAction):
    """A sample that was asked for; in a review with its item."""

    sample: Sample
    item: Item | None = None
    review: Review | None = None


@dataclass(frozen=True)
class ReviewEnded(CurateAction):
    """All samples of a review were answered or skipped."""

    review: Review


@dataclass(frozen=True)
class Saved(CurateAction):
    """A decision is on disk; `row` is the sample with it."""

    decision: Decision
    row: GraspRow


@dataclass(frozen=True)
class NotSaved(CurateAction):
    """A decision could not be stored; it is kept."""

    decision: Decision
    reason: str


@dataclass(frozen=True)
class Conflicted(CurateAction):
    """A colleague decided on the sample meanwhile: `events` were not seen."""

    decision: Decision
    events: tuple[LabelEvent, ...]


@dataclass(frozen=True)
class Changed(CurateAction):
    """Label events were added (undo, revert, bulk, import, verify): what is shown is read again.

    Attributes:
        words: for people.
        grasp: sample to show; None: the one that is shown.
        whole: the list may have changed, too.
    """

    words: str
    grasp: int | None = None
    whole: bool = False


@dataclass(frozen=True)
class BulkCounted(CurateAction):
    """What a bulk decision would do."""

    query: Query
    decision: float | str
    plan: BulkPlan


@dataclass(frozen=True)
class BulkMoved(CurateAction):
    """So many samples of a bulk decision have it; once all have, it is on disk."""

    done: int
    total: int


@dataclass(frozen=True)
class ReplayShown(CurateAction):
    """A stored attempt was executed again."""

    grasp: int
    played: Played


@dataclass(frozen=True)
class Scored(CurateAction):
    """So many scenes of the dataset have scores now; `words` is "" while it goes on."""

    done: int
    total: int
    words: str = ""


@dataclass(frozen=True)
class FactsShown(CurateAction):
    """What there is in the dataset."""

    facts: Facts


@dataclass(frozen=True)
class PersonShown(CurateAction):
    """A person's label events, newest first.

    Attributes:
        name: of the person.
        events: a page of them.
        gone: ids of those that were taken back.
        more: there are older ones.
        before: the event that the page begins behind, None for the newest.
    """

    name: str
    events: tuple[LabelEvent, ...]
    gone: frozenset[int] = frozenset()
    more: bool = False
    before: int | None = None


@dataclass(frozen=True)
class Exported(CurateAction):
    """The label events as a file."""

    file: Download


@dataclass(frozen=True)
class Failed(CurateAction):
    """Something that was asked for did not work."""

    title: str
    reason: str
