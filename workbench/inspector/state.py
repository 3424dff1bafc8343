"""The plain state of the inspector in one browser; `rules` make the next one from it, panels show it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from grasp_core.planning.planner import Candidate, Plan
from grasp_core.simulation.recording import Recording
from workbench.inspector.orders import Catalogue, Choice, Item, Judgement, OpenedScene, Photo, Place, SceneRequest, Try
from workbench.inspector.poses import Vector, matrix
from workbench.inspector.setup import DEFAULT, Setup
from workbench.playback import Replay

Layer = Literal["candidates", "camera", "contacts", "frames", "grid", "points"]
LAYERS: tuple[Layer, ...] = ("candidates", "camera", "contacts", "frames", "grid", "points")
"""What can be switched on and off in the scene."""
Mark = Literal["rectangles", "region", "samples"]
MARKS: tuple[Mark, ...] = ("rectangles", "region", "samples")
"""What can be switched on and off on the image."""
Mode = Literal["slide", "free"]


@dataclass(frozen=True)
class Playback(Replay):
    """Where the replay stands.

    Attributes:
        choice: whose attempt it is.
        attempt: the attempt that is shown, with its recording.
    """

    choice: Choice
    attempt: Try

    @property
    def recording(self) -> Recording | None:
        """What is played."""
        return self.attempt.recording


@dataclass(frozen=True)
class Pinned:
    """An attempt that others are compared with.

    Attributes:
        choice: whose it is.
        score: that the planner gave its candidate.
        attempt: with its recording.
    """

    choice: Choice
    score: float
    attempt: Try


@dataclass(frozen=True)
class TrialState:
    """What is known of one candidate's trial.

    Attributes:
        attempts: number → attempt; recordings stay with the one in `Playback` only.
        running: attempts are still being made.
        complete: all attempts are known.
        failed: why they could not be made.
    """

    attempts: dict[int, Try] = field(default_factory=dict)
    running: bool = False
    complete: bool = False
    failed: str | None = None

    @property
    def successes(self) -> int:
        """How many succeeded."""
        return sum(attempt.outcome == "SUCCESS" for attempt in self.attempts.values())

    @property
    def quality(self) -> float | None:
        """Successes over attempts, once all are known."""
        return self.successes / len(self.attempts) if self.complete and self.attempts else None


@dataclass(frozen=True)
class Sweep:
    """The job that tries all candidates of a plan.

    Attributes:
        side: of the plan.
        left: places that are still to be tried.
        total: candidates in all.
    """

    side: int
    left: tuple[int, ...]
    total: int


@dataclass(frozen=True)
class Picture:
    """How the image is shown.

    Attributes:
        opacity: of the quality map over the depth, 0 to 1.
        colours: name of the depth's colour map.
        near: where the colours begin, as a share of the image's depths, 0 to 1.
        far: where they end; from 0 to 1 they leave the few most distant depths out.
        marks: what is drawn on it.
    """

    opacity: float = 0.35
    colours: str = "bone"
    near: float = 0.0
    far: float = 1.0
    marks: frozenset[Mark] = frozenset({"rectangles", "region"})


@dataclass(frozen=True)
class Live:
    """How fast the plan follows a drag.

    Attributes:
        latency_ms: from the movement to its plan, of the last one.
        times: when the last plans came, by the monotonic clock, seconds.
    """

    latency_ms: float
    times: tuple[float, ...]

    @property
    def rate(self) -> float | None:
        """Plans a second."""
        if len(self.times) < 2 or self.times[-1] <= self.times[0]:
            return None
        return (len(self.times) - 1) / (self.times[-1] - self.times[0])


@dataclass(frozen=True)
class State:
    """Everything that the inspector shows in one browser.

    Attributes:
        catalogue: what there is.
        request: the scene that is wanted.
        setup: that is wanted.
        ticket: of the newest wanted scene; other scenes are not shown.
        making: ticket of the scene that is being made, one at a time; None when none is.
        scene: the scene that is shown.
        scene_ticket: its ticket; answers about candidates of other scenes are dropped.
        failure: why the wanted scene could not be made.
        wanted: candidate to select once the scene is there.
        choice: the selected candidate.
        least: candidates with lower scores are hidden.
        trials: candidate → what is known of its trial.
        waiting: number of the selected candidate's attempt to show once the running trial has ended, or once the scene
            that is being seen anew is there.
        sweep: the job that tries all candidates.
        playback: the replay, while one is shown.
        pinned: the attempt that it is compared with.
        verdicts: candidate → a person's verdict that is stored.
        judging: a verdict is being stored.
        saving: a replay is being written.
        speed: of replays, times real time.
        loop: whether replays start over at their end.
        shown: what is switched on in the scene.
        by_physics: candidates are coloured by what physics said, else by score.
        picture: how the image is shown.
        place: the pixel that was asked about.
        mode: how the gizmo moves objects.
        grabbed: which object it holds.
        dragging: a drag is under way.
        dragged_from: where the dragged object was when the drag began.
        moved_at: when it last moved something, by the monotonic clock.
        settling: objects are being let go.
        live: how fast plans follow it.
        items: own files that this browser opened.
        photo: how own images are read.
        mesh_unit: what a number in own meshes means.
    """

    catalogue: Catalogue
    request: SceneRequest = SceneRequest()  # noqa: RUF009 (frozen)
    setup: Setup = DEFAULT
    ticket: int = 0
    making: int | None = None
    scene: OpenedScene | None = None
    scene_ticket: int = -1
    failure: str | None = None
    wanted: Choice | None = None
    choice: Choice | None = None
    least: float = 0.0
    trials: dict[Choice, TrialState] = field(default_factory=dict)
    waiting: int | None = None
    sweep: Sweep | None = None
    playback: Playback | None = None
    pinned: Pinned | None = None
    verdicts: dict[Choice, Judgement] = field(default_factory=dict)
    judging: bool = False
    saving: bool = False
    speed: float = 1.0
    loop: bool = False
    shown: frozenset[Layer] = frozenset({"candidates", "camera", "contacts", "grid"})
    by_physics: bool = False
    picture: Picture = Picture()
    place: Place | None = None
    mode: Mode = "slide"
    grabbed: int = 0
    dragging: bool = False
    dragged_from: Vector | None = None
    moved_at: float | None = None
    settling: bool = False
    live: Live | None = None
    items: tuple[Item, ...] = ()
    photo: Photo = Photo("", "primesense")  # noqa: RUF009 (frozen)
    mesh_unit: str = "m"

    @property
    def opening(self) -> bool:
        """The wanted scene is not there yet."""
        return self.making is not None

    @property
    def known(self) -> bool:
        """Whether the wanted scene is the one that is shown, but for objects that were dragged, view and planners."""
        shown, wanted = self.scene, self.request
        if shown is None or shown.setup.gripper != self.setup.gripper or shown.request.photo != wanted.photo:
            return False
        if wanted.photo is not None:
            return True
        before, after = shown.request.things, wanted.things
        return (
            len(before) == len(after)
            and shown.request.place == wanted.place
            and all(
                old.name == new.name and (new.at is not None or (old.pose, old.at) == (new.pose, None))
                for old, new in zip(before, after, strict=True)
            )
        )

    @property
    def trying(self) -> bool:
        """The trial of some candidate is running."""
        return any(trial.running for trial in self.trials.values())

    @property
    def side(self) -> int:
        """Which plan is looked at."""
        return 0 if self.choice is None else self.choice.side

    @property
    def plan(self) -> Plan | None:
        """The plan that is looked at."""
        if self.scene is None or self.side >= len(self.scene.sight.plans):
            return None
        return self.scene.sight.plans[self.side]

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """Of the plan that is looked at, best first."""
        return () if self.scene is None else self.scene.candidates(self.side)

    @property
    def candidate(self) -> Candidate | None:
        """The selected one."""
        return None if self.choice is None else self.candidates[self.choice.index]

    @property
    def visible(self) -> tuple[int, ...]:
        """Places of the candidates that the filter lets through."""
        return tuple(i for i, candidate in enumerate(self.candidates) if candidate.score >= self.least)

    @property
    def trial(self) -> TrialState:
        """Of the selected candidate."""
        return TrialState() if self.choice is None else self.trials.get(self.choice, TrialState())

    @property
    def loose(self) -> bool:
        """Some object is not at rest."""
        return any(thing.loose for thing in self.request.things)

    def pose(self, index: int) -> NDArray[np.float64] | None:
        """Where object `index` is wanted, 4×4; None while its scene is not there."""
        if index >= len(self.request.things):
            return None
        at = self.request.things[index].at
        if at is not None:
            return matrix(at)
        if self.scene is None or index >= len(self.scene.scene.objects):
            return None
        return self.scene.scene.objects[index].world_from_object

    def with_trial(self, choice: Choice, trial: TrialState) -> State:
        """The same state with another trial of one candidate."""
        return replace(self, trials={**self.trials, choice: trial})
