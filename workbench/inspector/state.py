"""The plain state of one browser's workbench; `reducers` makes the next one from it, `views` and `panels` show it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from grasp_core.planning.planner import Candidate
from workbench.inspector.orders import LAYERS, Catalogue, Judgement, Layer, OpenedScene, SceneRequest, Try


@dataclass(frozen=True)
class Playback:
    """Where the replay stands.

    Attributes:
        attempt: the attempt that is shown, with its recording.
        position: seconds into it.
        playing: whether time moves it.
        at: clock of the last tick while playing, seconds.
    """

    attempt: Try
    position: float = 0.0
    playing: bool = True
    at: float | None = None

    @property
    def duration(self) -> float:
        """Seconds of the recording."""
        recording = self.attempt.recording
        return (
            0.0 if recording is None or len(recording.times) == 0 else float(recording.times[-1] - recording.times[0])
        )


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


@dataclass(frozen=True)
class State:
    """Everything that one browser shows.

    Attributes:
        catalogue: what there is.
        request: the scene that is wanted.
        ticket: of the newest wanted scene; other scenes are not shown.
        making: ticket of the scene that is being made, one at a time; None when none is.
        scene: the scene that is shown.
        scene_ticket: its ticket; answers about candidates of other scenes are dropped.
        failure: why the wanted scene could not be made.
        selected: place of the selected candidate in the list.
        trials: place → what is known of its trial.
        waiting: number of the selected candidate's attempt to show once the running trial has ended.
        playback: the replay, while one is shown.
        verdicts: place → a person's verdict that is stored.
        judging: a verdict is being stored.
        speed: of replays, times real time.
        shown: what is switched on in the scene.
    """

    catalogue: Catalogue
    request: SceneRequest
    ticket: int = 0
    making: int | None = 0
    scene: OpenedScene | None = None
    scene_ticket: int = 0
    failure: str | None = None
    selected: int | None = None
    trials: dict[int, TrialState] = field(default_factory=dict)
    waiting: int | None = None
    playback: Playback | None = None
    verdicts: dict[int, Judgement] = field(default_factory=dict)
    judging: bool = False
    speed: float = 1.0
    shown: frozenset[Layer] = frozenset(LAYERS)

    @property
    def opening(self) -> bool:
        """The wanted scene is not there yet."""
        return self.making is not None

    @property
    def trying(self) -> bool:
        """The trial of some candidate is running."""
        return any(trial.running for trial in self.trials.values())

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """Of the scene that is shown, best first."""
        return () if self.scene is None else self.scene.plan.candidates

    @property
    def trial(self) -> TrialState:
        """Of the selected candidate."""
        return TrialState() if self.selected is None else self.trials.get(self.selected, TrialState())

    def with_trial(self, index: int, trial: TrialState) -> State:
        """The same state with another trial at one place."""
        return replace(self, trials={**self.trials, index: trial})
