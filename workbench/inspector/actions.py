"""Everything that can happen in the inspector, as plain values."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.actions import Action, Effect
from workbench.inspector.orders import Judgement, Layer, OpenedScene, SceneRequest, Try


class InspectorAction(Action):
    """Base of all actions of the inspector."""


@dataclass(frozen=True)
class ShowObject(InspectorAction):
    """Show an object of this family."""

    family: str


@dataclass(frozen=True)
class AnotherObject(InspectorAction):
    """The next family's object, with a drawn shape."""

    draw: int


@dataclass(frozen=True)
class AnotherPose(InspectorAction):
    """The same object in its next stable pose."""


@dataclass(frozen=True)
class RandomScene(InspectorAction):
    """Any object, pose and place."""

    draw: int


@dataclass(frozen=True)
class UsePlanner(InspectorAction):
    """Plan the same scene with another planner."""

    name: str


@dataclass(frozen=True)
class Opened(InspectorAction):
    """A scene that was asked for is there, planned."""

    ticket: int
    scene: OpenedScene


@dataclass(frozen=True)
class OpenFailed(InspectorAction):
    """It could not be made."""

    ticket: int
    reason: str


@dataclass(frozen=True)
class Select(InspectorAction):
    """Select a candidate by its place in the list and try it in physics unless it was tried already."""

    index: int


@dataclass(frozen=True)
class SelectNext(InspectorAction):
    """Select a candidate so many places further down the list (negative: up) and try it."""

    by: int


@dataclass(frozen=True)
class ReplayAttempt(InspectorAction):
    """Show attempt `number` of the selected candidate's trial."""

    number: int


@dataclass(frozen=True)
class Replayed(InspectorAction):
    """One attempt was recorded."""

    ticket: int
    index: int
    attempt: Try


@dataclass(frozen=True)
class Tried(InspectorAction):
    """All attempts of a trial are known."""

    ticket: int
    index: int
    attempts: tuple[Try, ...]


@dataclass(frozen=True)
class TrialFailed(InspectorAction):
    """A trial could not be run."""

    ticket: int
    index: int
    reason: str


@dataclass(frozen=True)
class TogglePlay(InspectorAction):
    """Play or pause; at its end the replay starts over."""


@dataclass(frozen=True)
class Seek(InspectorAction):
    """Go to a time of the replay, seconds, and pause there."""

    time: float


@dataclass(frozen=True)
class Step(InspectorAction):
    """Go some frames forwards or backwards and pause."""

    frames: int


@dataclass(frozen=True)
class Speed(InspectorAction):
    """Play at this many times real time."""

    factor: float


@dataclass(frozen=True)
class Judge(InspectorAction):
    """A person's verdict on the selected candidate."""

    judgement: Judgement


@dataclass(frozen=True)
class Judged(InspectorAction):
    """The verdict is in the dataset, under this event."""

    ticket: int
    index: int
    judgement: Judgement
    event: int


@dataclass(frozen=True)
class JudgeFailed(InspectorAction):
    """The verdict could not be stored."""

    ticket: int
    index: int
    reason: str


@dataclass(frozen=True)
class Toggle(InspectorAction):
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
