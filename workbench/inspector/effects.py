"""The work that rules ask for and that `desk` does."""

from __future__ import annotations

from dataclasses import dataclass

from grasp_core.camera import Camera
from workbench.actions import Effect
from workbench.inspector.orders import Choice, Judgement, OpenedScene, SceneRequest, Try
from workbench.inspector.setup import Setup
from workbench.inspector.shelf import Kind


class InspectorEffect(Effect):
    """Base of all effects of the inspector."""


@dataclass(frozen=True)
class OpenScene(InspectorEffect):
    """Make and plan a scene."""

    ticket: int
    request: SceneRequest
    setup: Setup


@dataclass(frozen=True)
class SeeScene(InspectorEffect):
    """See and plan on a scene whose objects are known; `asked` is when the movement behind it happened."""

    ticket: int
    request: SceneRequest
    setup: Setup
    asked: float | None


@dataclass(frozen=True)
class ExpectTrial(InspectorEffect):
    """A candidate may be clicked next: record its first attempt ahead of that."""

    ticket: int
    scene: OpenedScene
    choice: Choice


@dataclass(frozen=True)
class SettleScene(InspectorEffect):
    """Let all objects go."""

    ticket: int
    request: SceneRequest
    setup: Setup


@dataclass(frozen=True)
class ScorePlace(InspectorEffect):
    """Score a pixel of a plan's canvas, of which the camera is given, over all angles."""

    ticket: int
    scene: OpenedScene
    canvas: Camera
    u: float
    v: float


@dataclass(frozen=True)
class RecordAttempt(InspectorEffect):
    """Run one attempt of a candidate and record it; `number` counts from 0."""

    ticket: int
    scene: OpenedScene
    choice: Choice
    number: int


@dataclass(frozen=True)
class RunTrial(InspectorEffect):
    """Run all attempts of a candidate, unrecorded."""

    ticket: int
    scene: OpenedScene
    choice: Choice


@dataclass(frozen=True)
class WritePage(InspectorEffect):
    """Write a recorded attempt to one HTML file."""

    scene: OpenedScene
    choice: Choice
    attempt: Try


@dataclass(frozen=True)
class StoreVerdict(InspectorEffect):
    """Write a verdict to the dataset."""

    ticket: int
    scene: OpenedScene
    choice: Choice
    judgement: Judgement
    attempts: tuple[Try, ...]


@dataclass(frozen=True)
class KeepFile(InspectorEffect):
    """Keep an upload."""

    kind: Kind
    name: str
    content: bytes
    unit: str


@dataclass(frozen=True)
class CheckCamera(InspectorEffect):
    """Read an own camera file that no image needs yet, to tell whether it is of use."""

    key: str


@dataclass(frozen=True)
class ReadFolder(InspectorEffect):
    """Look into a folder of this machine."""

    kind: Kind
    folder: str
    unit: str
