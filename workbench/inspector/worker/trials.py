"""Trying grasps in DART."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import msgspec

from grasp_core.grasp import Grasp
from grasp_core.gripper import load_gripper
from grasp_core.scene import Scene
from grasp_core.simulation.physics import load_physics
from workbench.inspector.orders import Try
from workbench.inspector.setup import Setup

if TYPE_CHECKING:
    from grasp_core.simulation.trial import Attempt, GraspTrial

TRIAL_SEED = 0
"""Of the noise of trials: a candidate's attempts are the same whenever they are made."""

_loaded: list[tuple[str, GraspTrial]] = []


def _trial(scene: Scene, setup: Setup) -> GraspTrial:
    """The trial of this scene; the last one is kept, a click after another does not load the scene anew."""
    from grasp_core.simulation.trial import GraspNoise, GraspTrial

    poses = (placed.asset.digest + placed.world_from_object.tobytes().hex() for placed in scene.objects)
    key = "".join((repr(setup.tries), *poses))
    if not _loaded or _loaded[0][0] != key:
        noise = GraspNoise(setup.sigma_p, math.radians(setup.sigma_phi)) if setup.sigma_p or setup.sigma_phi else None
        _loaded[:] = [(key, GraspTrial(scene, load_gripper(setup.gripper), load_physics(), noise, whole=True))]
    return _loaded[0][1]


def _try(number: int, attempt: Attempt) -> Try:
    comfort = attempt.comfort
    return Try(
        number=number,
        outcome=str(attempt.outcome),
        words=attempt.evidence.words,
        seed=attempt.seed,
        executed=attempt.executed,
        moved=None if comfort is None else (comfort.distance, comfort.rotation),
        dynamic=attempt.dynamic,
        redraws=attempt.redraws,
        evidence=msgspec.json.encode(attempt.evidence).decode() if attempt.dynamic else None,
        recording=attempt.recording,
    )


_expected: dict[tuple[str, Grasp, int], Try] = {}


def expect_attempt(scene: Scene, setup: Setup, grasp: Grasp) -> None:
    """Record the first attempt of a grasp that may be asked for next; those of the scene that is loaded are kept.

    Raises:
        GraspError: the grasp cannot be executed.
    """
    made = record_attempt(scene, setup, grasp, 0)
    key = _loaded[0][0]
    if any(known != key for known, *_ in _expected):
        _expected.clear()
    _expected[key, grasp, 0] = made


def record_attempt(scene: Scene, setup: Setup, grasp: Grasp, number: int) -> Try:
    """Attempt `number` of the grasp's trial, with its recording; equal to what `run_trial` finds.

    Raises:
        GraspError: the grasp cannot be executed.
    """
    from grasp_core.simulation.trial import child_seed

    trial = _trial(scene, setup)
    known = _expected.get((_loaded[0][0], grasp, number))
    return known or _try(number, trial.attempt(grasp, child_seed(TRIAL_SEED, number), record=True))


def run_trial(scene: Scene, setup: Setup, grasp: Grasp) -> tuple[Try, ...]:
    """All attempts of the grasp's trial, without recordings.

    Raises:
        GraspError: the grasp cannot be executed.
    """
    made = _trial(scene, setup).trial(grasp, setup.attempts, TRIAL_SEED).attempts
    return tuple(_try(number, attempt) for number, attempt in enumerate(made))
