"""Everything that can happen in a workbench, as plain values.

Handlers and finished jobs only enqueue an `Action`; once a tick `reducers.reduce` turns state and action into the next
state and some `Effect`s, the work that somebody else then does.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from workbench.orders import Judgement, Layer, OpenedScene, SceneRequest, Try


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
class ShowObject(Action):
    """Show an object of this family."""

    family: str


@dataclass(frozen=True)
class AnotherObject(Action):
    """The next family's object, with a drawn shape."""

    draw: int


@dataclass(frozen=True)
class AnotherPose(Action):
    """The same object in its next stable pose."""


@dataclass(frozen=True)
class RandomScene(Action):
    """Any object, pose and place."""

    draw: int


@dataclass(frozen=True)
class UsePlanner(Action):
    """Plan the same scene with another planner."""

    name: str


@dataclass(frozen=True)
class Opened(Action):
    """A scene that was asked for is there, planned."""

    ticket: int
    scene: OpenedScene


@dataclass(frozen=True)
class OpenFailed(Action):
    """It could not be made."""

    ticket: int
    reason: str


@dataclass(frozen=True)
class Select(Action):
    """Select a candidate by its place in the list and try it in physics unless it was tried already."""

    index: int


@dataclass(frozen=True)
class SelectNext(Action):
    """Select a candidate so many places further down the list (negative: up) and try it."""

    by: int


@dataclass(frozen=True)
class ReplayAttempt(Action):
    """Show attempt `number` of the selected candidate's trial."""

    number: int


@dataclass(frozen=True)
class Replayed(Action):
    """One attempt was recorded."""

    ticket: int
    index: int
    attempt: Try


@dataclass(frozen=True)
class Tried(Action):
    """All attempts of a trial are known."""

    ticket: int
    index: int
    attempts: tuple[Try, ...]


@dataclass(frozen=True)
class TrialFailed(Action):
    """A trial could not be run."""

    ticket: int
    index: int
    reason: str


@dataclass(frozen=True)
class TogglePlay(Action):
    """Play or pause; at its end the replay starts over."""


@dataclass(frozen=True)
class Seek(Action):
    """Go to a time of the replay, seconds, and pause there."""

    time: float


@dataclass(frozen=True)
class Step(Action):
    """Go some frames forwards or backwards and pause."""

    frames: int


@dataclass(frozen=True)
class Speed(Action):
    """Play at this many times real time."""

    factor: float


@dataclass(frozen=True)
class Tick(Action):
    """Time has passed; `now` in seconds of a monotonic clock."""

    now: float


@dataclass(frozen=True)
class Judge(Action):
    """A person's verdict on the selected candidate."""

    judgement: Judgement


@dataclass(frozen=True)
class Judged(Action):
    """The verdict is in the dataset, under this event."""

    ticket: int
    index: int
    judgement: Judgement
    event: int


@dataclass(frozen=True)
class JudgeFailed(Action):
    """The verdict could not be stored."""

    ticket: int
    index: int
    reason: str


@dataclass(frozen=True)
class Toggle(Action):
    """Switch something in the scene on or off."""

    what: Layer


@dataclass(frozen=True)
class OpenScene(Effect):
    """Make and plan a scene."""

    ticket: int
    request: SceneRequest


@dataclass(frozen=True)
class RecordAttempt(Effect):
    """Run one attempt of a candidate and record it; `number` counts from 0."""

    ticket: int
    scene: OpenedScene
    index: int
    number: int


@dataclass(frozen=True)
class RunTrial(Effect):
    """Run all attempts of a candidate, unrecorded."""

    ticket: int
    scene: OpenedScene
    index: int


@dataclass(frozen=True)
class StoreVerdict(Effect):
    """Write a verdict to the dataset."""

    ticket: int
    scene: OpenedScene
    index: int
    judgement: Judgement
    attempts: tuple[Try, ...]
