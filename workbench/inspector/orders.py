"""What worker processes are asked for and what they answer: plain values that travel between processes."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

import msgspec
import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import DepthImage
from grasp_core.grasp import Grasp
from grasp_core.gripper import Gripper
from grasp_core.planning.places import PlaceScores
from grasp_core.planning.planner import Candidate, Plan
from grasp_core.scene import Scene
from grasp_core.simulation.recording import Recording
from workbench.inspector.poses import resting
from workbench.inspector.setup import Setup

Judgement = Literal["good", "bad"]
MOST_THINGS = 6
"""Objects in a scene."""


class Thing(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """An object of a scene.

    Attributes:
        name: of the catalogue ("mug_003"), or the key of an own mesh.
        pose: which of its stable poses, counted from the most probable; wraps around.
        at: where it was dragged, x y z qw qx qy qz (metres, world_from_object); None: drawn from the scene's `place`.
        loose: it was dragged off the table or tipped, and has not come to rest since.
    """

    name: str
    pose: int = 0
    at: tuple[float, float, float, float, float, float, float] | None = None
    loose: bool = False


class Photo(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """An own depth image.

    Attributes:
        key: of the file.
        camera: name of a shipped camera, key of an own camera file, or "" where it is typed.
        typed: fx fy cx cy, pixels, where it is typed.
        scale: metres per unit of the file; 0 where the file holds metres.
    """

    key: str
    camera: str = ""
    typed: tuple[float, float, float, float] | None = None
    scale: float = 0.0


class SceneRequest(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A scene that can be made again from these values (and own files) alone.

    Attributes:
        things: its objects; empty for an own image.
        place: seed of where they stand and how they are turned.
        photo: an own image in the place of a simulated scene.
    """

    things: tuple[Thing, ...] = (Thing("toy_plane_000"),)
    place: int = 1
    photo: Photo | None = None

    def moved(self, index: int, thing: Thing) -> SceneRequest:
        """The same scene with another object `index`."""
        things = list(self.things)
        things[index] = thing
        return msgspec.structs.replace(self, things=tuple(things))


@dataclass(frozen=True)
class Catalogue:
    """What there is.

    Attributes:
        families: of parametric objects.
        dataset: where verdicts go, for people.
        folders: whether folders of this machine may be named in the browser.
    """

    families: tuple[str, ...]
    dataset: str
    folders: bool = True


@dataclass(frozen=True)
class Choice:
    """A candidate: which plan (0, or 1 for the planner beside it) and its place in it."""

    side: int
    index: int


@dataclass(frozen=True)
class Rest:
    """How an object of a scene may rest.

    Attributes:
        poses: all stable poses, 4×4, with their probabilities.
        pose: which one it is in; None for another.
    """

    poses: tuple[tuple[NDArray[np.float64], float], ...]
    pose: int | None

    def at(self, world_from_object: NDArray[np.float64]) -> Rest:
        """The same where the object stands at a pose (4×4)."""
        return replace(self, pose=resting(world_from_object, [pose for pose, _ in self.poses]))


@dataclass(frozen=True, eq=False)
class Sight:
    """What a camera saw of a scene and what planners made of it.

    Attributes:
        image: noise included.
        plans: of each planner.
        failures: per planner, why there is no plan of it ("" where there is).
        crops: per planner (N, S, S), what the Refined Network sees of its candidates; None where weights do not fit.
        context: side of a crop, in openings.
        stages_ms: stage → milliseconds of everything before the plans.
    """

    image: DepthImage
    plans: tuple[Plan | None, ...]
    failures: tuple[str, ...]
    crops: tuple[NDArray[np.float32] | None, ...]
    context: float
    stages_ms: dict[str, float]


@dataclass(frozen=True, eq=False)
class OpenedScene:
    """A scene, planned.

    Attributes:
        request: that it was made from, with poses wrapped into range.
        setup: that it was made with.
        scene: objects under the camera; without objects for own images.
        rests: how each object may rest.
        gripper: that was planned for.
        sight: image and plans.
    """

    request: SceneRequest
    setup: Setup
    scene: Scene
    rests: tuple[Rest, ...]
    gripper: Gripper
    sight: Sight

    def candidates(self, side: int) -> tuple[Candidate, ...]:
        """Of one plan, best first."""
        plan = self.sight.plans[side] if side < len(self.sight.plans) else None
        return () if plan is None else plan.candidates

    def grasp(self, choice: Choice) -> Grasp:
        """Of a candidate."""
        return self.candidates(choice.side)[choice.index].grasp


@dataclass(frozen=True)
class Try:
    """One DART attempt, as the workbench shows it.

    Attributes:
        number: in its trial, from 0.
        outcome: name of the outcome.
        words: what happened and why, one sentence.
        seed: of the attempt's noise.
        executed: the pose that was really executed.
        moved: how far the object moved in the gripper, metres and rad, or None.
        dynamic: whether the physics engine was needed for the verdict.
        redraws: how many diverging runs were drawn again before this one.
        evidence: JSON of what was seen, for dynamic attempts.
        recording: of every body, where it was asked for.
    """

    number: int
    outcome: str
    words: str
    seed: int
    executed: Grasp
    moved: tuple[float, float] | None
    dynamic: bool
    redraws: int
    evidence: str | None
    recording: Recording | None


@dataclass(frozen=True, eq=False)
class Place:
    """What was asked about one pixel of the canvas.

    Attributes:
        u: column, canvas pixels.
        v: row.
        depth: measured there, metres from the canonical camera; None where nothing was.
        heat: of the quality map there.
        scores: over all angles, once they are known.
        failed: why they are not.
    """

    u: float
    v: float
    depth: float | None
    heat: float
    scores: PlaceScores | None = None
    failed: str = ""


@dataclass(frozen=True)
class Item:
    """An own file that may be opened.

    Attributes:
        key: that requests name it by.
        name: for people.
        kind: what it holds.
        path: where it is.
    """

    key: str
    name: str
    kind: Literal["mesh", "image", "camera"]
    path: str = field(repr=False)
