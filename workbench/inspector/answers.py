"""What comes back from workers and from the dataset, as actions; `ticket` tells which wish it answers."""

from __future__ import annotations

from dataclasses import dataclass

from grasp_core.planning.places import PlaceScores
from workbench.inspector.actions import InspectorAction
from workbench.inspector.orders import Choice, Item, Judgement, OpenedScene, SceneRequest, Sight, Try
from workbench.inspector.setup import Setup


@dataclass(frozen=True)
class Opened(InspectorAction):
    """A scene that was asked for is there, planned."""

    ticket: int
    scene: OpenedScene


@dataclass(frozen=True)
class Seen(InspectorAction):
    """A known scene was seen and planned on anew.

    Attributes:
        ticket: of the wish.
        request: that was seen.
        setup: that it was seen with.
        sight: image and plans.
        asked: when the movement behind it happened, by the monotonic clock; None where there was none.
        now: when the sight was there.
    """

    ticket: int
    request: SceneRequest
    setup: Setup
    sight: Sight
    asked: float | None
    now: float


@dataclass(frozen=True)
class OpenFailed(InspectorAction):
    """The scene could not be made."""

    ticket: int
    reason: str


@dataclass(frozen=True)
class Expected(InspectorAction):
    """The candidate's first attempt is recorded, ahead of a click."""

    ticket: int
    choice: Choice


@dataclass(frozen=True)
class Settled(InspectorAction):
    """They came to rest so."""

    ticket: int
    request: SceneRequest


@dataclass(frozen=True)
class SettleFailed(InspectorAction):
    """They did not come to rest."""

    ticket: int
    reason: str


@dataclass(frozen=True)
class PlaceScored(InspectorAction):
    """The pixel's scores over all angles."""

    ticket: int
    u: float
    v: float
    scores: PlaceScores


@dataclass(frozen=True)
class PlaceFailed(InspectorAction):
    """It could not be scored."""

    ticket: int
    reason: str


@dataclass(frozen=True)
class Replayed(InspectorAction):
    """One attempt was recorded."""

    ticket: int
    choice: Choice
    attempt: Try


@dataclass(frozen=True)
class Tried(InspectorAction):
    """All attempts of a trial are known."""

    ticket: int
    choice: Choice
    attempts: tuple[Try, ...]


@dataclass(frozen=True)
class TrialFailed(InspectorAction):
    """A trial could not be run."""

    ticket: int
    choice: Choice
    reason: str


@dataclass(frozen=True)
class ReplaySaved(InspectorAction):
    """It is written."""

    name: str
    content: bytes


@dataclass(frozen=True)
class SaveFailed(InspectorAction):
    """It could not be written."""

    reason: str


@dataclass(frozen=True)
class Judged(InspectorAction):
    """The verdict is in the dataset, under this event."""

    ticket: int
    choice: Choice
    judgement: Judgement
    event: int


@dataclass(frozen=True)
class JudgeFailed(InspectorAction):
    """The verdict could not be stored."""

    ticket: int
    reason: str


@dataclass(frozen=True)
class FilesKept(InspectorAction):
    """Files are there."""

    items: tuple[Item, ...]
