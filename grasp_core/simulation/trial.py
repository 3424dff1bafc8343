"""GraspTrial: noisy executions of a grasp in DART, and what they say about it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grasp_core import config
from grasp_core.errors import GraspError
from grasp_core.grasp import Grasp
from grasp_core.gripper import Gripper
from grasp_core.scene import Scene
from grasp_core.simulation.evidence import Comfort, Evidence, FingerContact, Outcome, millimetres, triple
from grasp_core.simulation.execution import Execution
from grasp_core.simulation.physics import Physics
from grasp_core.simulation.precheck import BODIES, Precheck, Prechecked, Verdict
from grasp_core.simulation.recorder import Recorder
from grasp_core.simulation.recording import Recording
from grasp_core.simulation.shaking import Shake
from grasp_core.simulation.world import World

__all__ = [
    "Attempt",
    "Comfort",
    "Evidence",
    "FingerContact",
    "GraspNoise",
    "GraspTrial",
    "Outcome",
    "Shake",
    "Trial",
    "child_seed",
]

_REDRAWS = 20
"""Diverged executions of one attempt after which something is wrong with the scene itself."""


class GraspNoise(config.Settings):
    """How far an executed grasp strays from the commanded one (Eq. 4).

    Attributes:
        sigma_p: of each coordinate of p, metres.
        sigma_phi: of φ, rad.
    """

    sigma_p: float = 0.0025
    sigma_phi: float = math.radians(2.5)

    def __post_init__(self) -> None:
        if self.sigma_p < 0 or self.sigma_phi < 0:
            raise ValueError(f"sigma_p and sigma_phi must not be negative, not {self.sigma_p} and {self.sigma_phi}")

    def draw(self, grasp: Grasp, rng: np.random.Generator) -> Grasp:
        """The grasp as executed; w stays."""
        x, y, z, turn = rng.normal(size=4) * [self.sigma_p, self.sigma_p, self.sigma_p, self.sigma_phi]
        px, py, pz = grasp.position
        return Grasp((px + x, py + y, pz + z), grasp.angle + turn, grasp.width)


@dataclass(frozen=True)
class Attempt:
    """One execution.

    Attributes:
        outcome: how it ended; never UNSTABLE.
        seed: with the same scene, gripper, physics, noise and grasp it gives the same attempt, bit for bit.
        executed: the grasp with its noise.
        dynamic: whether it took dynamics; the height map settled it otherwise.
        evidence: why it ended so.
        comfort: how far the object moved in the gripper, for successes.
        redraws: how often the solver diverged and the noise was drawn anew.
        recording: everything that moved, if asked for.
    """

    outcome: Outcome
    seed: int
    executed: Grasp
    dynamic: bool
    evidence: Evidence
    comfort: Comfort | None = None
    redraws: int = 0
    recording: Recording | None = None


@dataclass(frozen=True)
class Trial:
    """All attempts on one grasp."""

    grasp: Grasp
    attempts: tuple[Attempt, ...]

    @property
    def quality(self) -> float:
        """Successes over attempts."""
        return sum(attempt.outcome is Outcome.SUCCESS for attempt in self.attempts) / len(self.attempts)

    @property
    def outcomes(self) -> tuple[Outcome, ...]:
        """The outcome of each attempt."""
        return tuple(attempt.outcome for attempt in self.attempts)


def child_seed(seed: int, index: int) -> int:
    """The seed of attempt (or grasp) `index` under a seed: 32 bits, well mixed."""
    return int(np.random.SeedSequence([seed, index]).generate_state(1)[0])


class GraspTrial:
    """Executes grasps on one scene.

    Every attempt starts from the same state and depends on nothing but its own seed: not on the process, the order or
    the other grasps of a batch.

    Attributes:
        scene: objects at rest.
        gripper: executes.
        physics: of the world.
        noise: of the execution, or None.
        precheck: the scene's height map and what follows from it.
    """

    def __init__(
        self,
        scene: Scene,
        gripper: Gripper,
        physics: Physics,
        noise: GraspNoise | None = GraspNoise(),  # noqa: B008 (frozen)
        *,
        whole: bool = False,
        shake: Shake | None = None,
    ) -> None:
        """Load the scene.

        Args:
            scene: objects at rest.
            gripper: executes the grasps.
            physics: of the world.
            noise: of the execution, None for none.
            whole: always lift the full height; else a lift may end as soon as the verdict is certain. Recorded attempts
                are always whole.
            shake: how objects that were lifted are shaken, None for not at all; their lifts are then whole.

        Raises:
            GraspError: the scene is empty.
        """
        if not scene.objects:
            raise GraspError("a trial needs at least one object in its scene; place one")
        self.scene = scene
        self.gripper = gripper
        self.physics = physics
        self.noise = noise
        self._whole = whole
        self._shake = shake
        self._poses = [np.asarray(placed.world_from_object, float) for placed in scene.objects]
        self.precheck = Precheck(
            [
                [part.vertices @ pose[:3, :3].T + pose[:3, 3] for part in placed.asset.parts]
                for placed, pose in zip(scene.objects, self._poses, strict=True)
            ],
            gripper,
            physics,
        )
        self._execution: Execution | None = None

    def attempt(self, grasp: Grasp, seed: int, record: bool = False) -> Attempt:
        """Execute a grasp once.

        Args:
            grasp: as commanded.
            seed: of the noise.
            record: keep everything that moved, and lift the full height.

        Raises:
            GraspError: the grasp is wider than the gripper opens, or the solver diverges again and again.
        """
        self._refuse(grasp)
        executed = self._draw(grasp, seed, 0)
        return self._judge(grasp, seed, executed, self.precheck.check(_rows([executed])), 0, record)

    def trial(self, grasp: Grasp, attempts: int = 5, seed: int = 0) -> Trial:
        """Execute a grasp several times with seeds derived from `seed`.

        Raises:
            GraspError: as `attempt`, or no attempts asked for.
        """
        return self._trials([grasp], [seed], attempts)[0]

    def batch(self, grasps: Sequence[Grasp], attempts: int = 5, seed: int = 0) -> list[Trial]:
        """Execute many grasps: trial i equals `trial(grasps[i], attempts, child_seed(seed, i))`.

        Raises:
            GraspError: as `trial`.
        """
        return self._trials(grasps, [child_seed(seed, index) for index in range(len(grasps))], attempts)

    def _trials(self, grasps: Sequence[Grasp], seeds: Sequence[int], attempts: int) -> list[Trial]:
        if attempts < 1:
            raise GraspError(f"a trial takes at least one attempt, not {attempts}")
        for grasp in grasps:
            self._refuse(grasp)
        if not grasps:
            return []
        distinct = attempts if self.noise else 1
        each = [[child_seed(seed, number) for number in range(attempts)] for seed in seeds]
        executed = [
            self._draw(grasp, own[number], 0)
            for grasp, own in zip(grasps, each, strict=True)
            for number in range(distinct)
        ]
        checked = self.precheck.check(_rows(executed))
        trials = []
        for index, grasp in enumerate(grasps):
            rows = range(index * distinct, (index + 1) * distinct)
            done = [
                self._judge(grasp, each[index][number], executed[row], checked, row, False)
                for number, row in enumerate(rows)
            ]
            trials.append(Trial(grasp, tuple(done[number % distinct] for number in range(attempts))))
        return trials

    def check(self, executed: Grasp) -> Verdict:
        """What the height map says about a grasp, as executed."""
        return Verdict(int(self.precheck.check(_rows([executed])).verdict[0]))

    def free_way(self, executed: Grasp) -> float:
        """How far both fingers of a grasp, as executed, may close before dynamics need to start, metres."""
        return self._advance(self.precheck.check(_rows([executed])), 0)

    def _advance(self, checked: Prechecked, row: int) -> float:
        gap = float(checked.gaps[row].min())
        return max(0.0, gap - self.physics.start_gap) if math.isfinite(gap) else 0.0

    def _refuse(self, grasp: Grasp) -> None:
        if grasp.width > self.gripper.opening + 1e-9:
            raise GraspError(
                f"the grasp is {grasp.width:.4f} m wide but the gripper '{self.gripper.name}' opens to"
                f" {self.gripper.opening:.4f} m; give a smaller width"
            )

    def _draw(self, grasp: Grasp, seed: int, redraw: int) -> Grasp:
        if self.noise is None:
            return grasp
        return self.noise.draw(grasp, np.random.default_rng(np.random.SeedSequence([seed, redraw])))

    def _judge(self, grasp: Grasp, seed: int, executed: Grasp, checked: Prechecked, row: int, record: bool) -> Attempt:
        """Finish one attempt from its precheck; redraw its noise while the solver diverges."""
        for redraw in range(_REDRAWS):
            if redraw:
                executed = self._draw(grasp, seed, redraw)
                checked, row = self.precheck.check(_rows([executed])), 0
            attempt = self._finish(seed, executed, checked, row, redraw, record)
            if attempt.outcome is not Outcome.UNSTABLE:
                return attempt
            if self.noise is None:
                break
        raise GraspError(
            f"the simulation of a grasp at {grasp.position} diverges again and again; check the objects' meshes, masses"
        )

    def _finish(self, seed: int, executed: Grasp, checked: Prechecked, row: int, redraws: int, record: bool) -> Attempt:
        recorder = Recorder(self.gripper, executed, self._poses) if record else None
        comfort = None
        dynamic = checked.verdict[row] == Verdict.OPEN
        if checked.verdict[row] == Verdict.COLLISION:
            outcome, evidence, stop = Outcome.COLLISION, *self._collision(executed, checked, row)
            if recorder:
                recorder.approach(stop)
        elif checked.verdict[row] == Verdict.MISSED:
            outcome = Outcome.MISSED
            evidence = Evidence(
                words="closed on nothing: between the fingers nothing is higher than their tips",
                travel=(executed.width / 2, executed.width / 2),
            )
            if recorder:
                recorder.approach(0.0)
                recorder.free_closing(executed.width / 2)
        else:
            advance = self._advance(checked, row)
            if recorder:
                recorder.approach(0.0)
                recorder.free_closing(advance)
            outcome, evidence, comfort = self._executes().run(
                executed, advance, whole=record or self._whole, recorder=recorder, shake=self._shake
            )
        recording = recorder.finish(outcome, evidence.words) if recorder else None
        return Attempt(outcome, seed, executed, bool(dynamic), evidence, comfort, redraws, recording)

    def _collision(self, executed: Grasp, checked: Prechecked, row: int) -> tuple[Evidence, float]:
        """Evidence, and how high above the grasp pose the way ends, metres."""
        body = BODIES[checked.body[row]]
        obstacle = int(checked.obstacle[row])
        bottom = {"rod": self.gripper.finger.z, "base": self.gripper.finger.z + self.gripper.rod.z}.get(body, 0.0)
        stop = float(checked.place[row, 2]) - executed.position[2] - bottom
        what = "the table" if obstacle < 0 else f"object {obstacle}" if len(self._poses) > 1 else "the object"
        evidence = Evidence(
            words=f"the {body.replace('_', ' ')} met {what} on the way in, {millimetres(stop)} above the grasp",
            object=None if obstacle < 0 else obstacle,
            body=body,
            place=triple(checked.place[row]),
        )
        return evidence, stop

    def _executes(self) -> Execution:
        if self._execution is None:
            world = World([p.asset for p in self.scene.objects], self.physics, self.gripper, poses=self._poses)
            self._execution = Execution(world, self._poses)
        return self._execution


def _rows(grasps: Sequence[Grasp]) -> NDArray[np.float64]:
    return np.array([(*grasp.position, grasp.angle, grasp.width) for grasp in grasps])
