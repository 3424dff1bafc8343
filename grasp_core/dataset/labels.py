"""The label rule: which value training uses for a grasp, and why.

The label is the newest standing human decision, else the quality of all attempts pooled. "Unsure" and "exclude" are
decisions too: they leave the sample out. Scores of networks never set labels. An event stands unless a standing revert
event takes it back; reverting a revert brings the event back (redo).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import msgspec

from grasp_core.errors import StoreError

Kind = Literal["value", "unsure", "exclude", "flag", "unflag", "note", "attempts", "opinion", "revert"]
Source = Literal["human", "dart"]
State = Literal["labelled", "unlabelled", "unsure", "excluded"]
DECISIONS = ("value", "unsure", "exclude")
"""Kinds of events that decide a label; the others are remarks."""


class LabelConflict(StoreError):
    """Somebody decided on the same sample meanwhile; `events` are the decisions that were not seen."""

    def __init__(self, message: str, events: tuple[LabelEvent, ...]) -> None:
        super().__init__(message)
        self.events = events


class LabelEvent(msgspec.Struct, frozen=True, kw_only=True):
    """One entry of a sample's history; never changed, never removed.

    Attributes:
        id: in this copy of the dataset, growing with time.
        uid: the same in every copy.
        grasp: id of the grasp.
        at: Unix time, ms.
        person: self-declared name; None for physics alone.
        source: a person, or attempts in DART.
        kind: value, unsure, exclude (decisions); flag, unflag, note, attempts (more DART attempts), opinion (a second
            opinion that leaves the label alone), revert.
        value: of a decision "value" or an opinion, in [0, 1].
        old_value: the label before, None where the sample was left out.
        new_value: the label after.
        reason: why, in the words of whoever did it or of the program.
        note: free text, searched by the full-text index.
        reverts: id of the event that is taken back.
        batch: shared by the events of one bulk action.
        details: more, by kind: seed and physics of attempts, what a blind reviewer did not see.
    """

    id: int
    uid: str
    grasp: int
    at: int
    person: str | None
    source: Source
    kind: Kind
    value: float | None
    old_value: float | None
    new_value: float | None
    reason: str
    note: str = ""
    reverts: int | None = None
    batch: str | None = None
    details: dict = {}


class CurrentLabel(msgspec.Struct, frozen=True):
    """The label of a sample now.

    Attributes:
        value: in [0, 1], None where the sample is left out.
        state: labelled, unlabelled (nothing is known), unsure or excluded.
        source: none, dart or human.
        reason: the rule applied, in one sentence.
        event: id of the deciding event, None for pooled attempts.
        flagged: a standing flag is on it.
    """

    value: float | None
    state: State
    source: Literal["none", "dart", "human"]
    reason: str
    event: int | None = None
    flagged: bool = False


def standing(events: Sequence[LabelEvent]) -> list[LabelEvent]:
    """Those of one sample's events that no standing event reverts, oldest first.

    The order is that of their times, so that copies of a dataset that exchange their events agree on the newest.
    """
    reverted_by: dict[int, list[LabelEvent]] = {}
    for event in events:
        if event.reverts is not None:
            reverted_by.setdefault(event.reverts, []).append(event)

    def stands(event: LabelEvent) -> bool:  # ends: an event can only revert one that was there before it
        return not any(stands(later) for later in reverted_by.get(event.id, ()))

    return sorted((event for event in events if stands(event)), key=lambda event: (event.at, event.uid))


def current_label(events: Sequence[LabelEvent], successes: int, attempts: int) -> CurrentLabel:
    """Apply the rule.

    Args:
        events: all events of one sample.
        successes: of all its attempts with a verdict, those of generation and those of people's verifications.
        attempts: how many have a verdict.
    """
    stand = standing(events)
    flags = [event.kind for event in stand if event.kind in ("flag", "unflag")]
    flagged = bool(flags) and flags[-1] == "flag"
    decisions = [event for event in stand if event.kind in DECISIONS]
    if decisions:
        newest = decisions[-1]
        who = newest.person or "a person"
        if newest.kind == "value":
            return CurrentLabel(newest.value, "labelled", "human", f"{who} set {newest.value:g}", newest.id, flagged)
        state: State = "unsure" if newest.kind == "unsure" else "excluded"
        words = "is unsure" if state == "unsure" else "excluded it"
        return CurrentLabel(None, state, "human", f"{who} {words}: training leaves it out", newest.id, flagged)
    if attempts > 0:
        reason = f"{successes} of {attempts} DART attempts succeeded"
        return CurrentLabel(successes / attempts, "labelled", "dart", reason, None, flagged)
    return CurrentLabel(None, "unlabelled", "none", "no attempts and no decision yet", None, flagged)
