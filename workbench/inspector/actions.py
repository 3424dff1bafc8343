"""What people do in the inspector, as plain values; what comes back from workers is in `answers`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from workbench.actions import Action
from workbench.inspector.orders import Choice, Judgement
from workbench.inspector.poses import Vector
from workbench.inspector.shelf import Kind
from workbench.inspector.state import Layer, Mark, Mode


class InspectorAction(Action):
    """Base of all actions of the inspector."""


@dataclass(frozen=True)
class ShowObject(InspectorAction):
    """Show one object: of the catalogue, or an own mesh."""

    name: str


@dataclass(frozen=True)
class AnotherObject(InspectorAction):
    """The next family's object, with a drawn shape."""

    draw: int


@dataclass(frozen=True)
class AnotherPose(InspectorAction):
    """The grabbed object in its next stable pose."""


@dataclass(frozen=True)
class RandomScene(InspectorAction):
    """So many objects, any of them, in any pose and place."""

    draw: int
    count: int = 1


@dataclass(frozen=True)
class AddObject(InspectorAction):
    """One more object on the table."""

    draw: int


@dataclass(frozen=True)
class Change(InspectorAction):
    """Give a setting another value."""

    name: str
    value: Any


@dataclass(frozen=True)
class ResetSetup(InspectorAction):
    """All settings as shipped."""


@dataclass(frozen=True)
class Grab(InspectorAction):
    """Hold another object with the gizmo."""

    index: int


@dataclass(frozen=True)
class DragMode(InspectorAction):
    """Slide objects on the table, or move and turn them freely; None: the other one of both."""

    mode: Mode | None = None


@dataclass(frozen=True)
class Drag(InspectorAction):
    """The gizmo moved the grabbed object here."""

    at: Vector
    ended: bool
    now: float


@dataclass(frozen=True)
class Settle(InspectorAction):
    """Let all objects go in DART."""


@dataclass(frozen=True)
class Select(InspectorAction):
    """Select a candidate and, unless it was tried already, try it in physics."""

    choice: Choice


@dataclass(frozen=True)
class SelectNext(InspectorAction):
    """Select a candidate so many places further down the list (negative: up) and try it."""

    by: int


@dataclass(frozen=True)
class LookAt(InspectorAction):
    """Look at the plan of one of the planners."""

    side: int


@dataclass(frozen=True)
class Filter(InspectorAction):
    """Hide candidates with lower scores."""

    least: float


@dataclass(frozen=True)
class AskPlace(InspectorAction):
    """Ask why not here: a pixel of the canvas."""

    u: float
    v: float


@dataclass(frozen=True)
class ReplayAttempt(InspectorAction):
    """Show attempt `number` of the selected candidate's trial."""

    number: int


@dataclass(frozen=True)
class TryAll(InspectorAction):
    """Try every candidate of the plan that is looked at."""


@dataclass(frozen=True)
class StopTrying(InspectorAction):
    """Cancel that job."""


@dataclass(frozen=True)
class Pin(InspectorAction):
    """Keep the attempt that is shown to compare others with; again: let it go."""


@dataclass(frozen=True)
class SaveReplay(InspectorAction):
    """Write the replay that is shown to one HTML file."""


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
class ToggleLoop(InspectorAction):
    """Let replays start over at their end, or not."""


@dataclass(frozen=True)
class Judge(InspectorAction):
    """A person's verdict on the selected candidate."""

    judgement: Judgement


@dataclass(frozen=True)
class Toggle(InspectorAction):
    """Switch something in the scene on or off."""

    what: Layer


@dataclass(frozen=True)
class ToggleMark(InspectorAction):
    """Switch something on the image on or off."""

    what: Mark


@dataclass(frozen=True)
class ColourBy(InspectorAction):
    """Colour candidates by score or by what physics said."""

    what: Literal["score", "physics"]


@dataclass(frozen=True)
class Overlay(InspectorAction):
    """Lay the quality map over the depth with this opacity."""

    opacity: float


@dataclass(frozen=True)
class DepthColours(InspectorAction):
    """Show depth in this colour map."""

    name: str


@dataclass(frozen=True)
class DepthRange(InspectorAction):
    """Let the depth colours run over this share of the image's depths, 0 to 1."""

    near: float
    far: float


@dataclass(frozen=True)
class OpenFile(InspectorAction):
    """A browser uploads a file."""

    kind: Kind
    name: str
    content: bytes


@dataclass(frozen=True)
class OpenFolder(InspectorAction):
    """Open all files of a kind in a folder of the workbench's machine."""

    kind: Kind
    folder: str


@dataclass(frozen=True)
class MeshUnit(InspectorAction):
    """What a number in meshes that are opened next means: m, mm, cm, or paper for 10-20 cm."""

    unit: str


@dataclass(frozen=True)
class UseFile(InspectorAction):
    """Show an own mesh or image, or use an own camera."""

    key: str


@dataclass(frozen=True)
class NextPhoto(InspectorAction):
    """Step so many images further through those that are open."""

    by: int


@dataclass(frozen=True)
class ReadPhotosWith(InspectorAction):
    """Read own images with this camera or these typed intrinsics, and in this unit."""

    camera: str
    typed: tuple[float, float, float, float] | None
    scale: float
