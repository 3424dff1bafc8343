"""What runs in the worker process for the curation: attempts, replays and scores. Each is a call that scripts make."""

from __future__ import annotations

import time
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from workbench.curate.values import Played

if TYPE_CHECKING:
    from grasp_core.networks.runtime import Runtime
    from grasp_core.simulation.trial import GraspTrial

SLICE = 1.5
"""Seconds after which scoring hands over, so that other jobs come in between."""


@lru_cache(maxsize=4)
def _trial(path: Path, scene: int) -> GraspTrial:
    from grasp_core.dataset.store import DatasetStore
    from grasp_core.dataset.trials import scene_trial

    with DatasetStore.open(path, readonly=True) as store:
        return scene_trial(store, scene)


@lru_cache(maxsize=1)
def _runtime() -> Runtime:
    from grasp_core.networks.runtime import load_runtime

    return load_runtime("default")


def verify(path: Path, grasp: int, attempts: int, person: str) -> str:
    """Run more attempts on a sample and pool them; what came out, for people.

    Raises:
        GraspError: see `trials.verify_grasp`.
    """
    from grasp_core.dataset.store import DatasetStore
    from grasp_core.dataset.trials import verify_grasp

    with DatasetStore.open(path) as store:
        trial = _trial(path, store.grasp(grasp).scene)
        _, pooled = verify_grasp(store, grasp, attempts, person=person, trial=trial)
    return (
        f"{attempts} attempts more: quality {pooled.successes}/{pooled.attempts}, between"
        f" {pooled.low:.2f} and {pooled.high:.2f} (95 %)"
    )


def replay(path: Path, grasp: int, number: int) -> Played:
    """Execute a stored attempt again, recorded.

    Raises:
        GraspError: see `trials.replay`.
    """
    from grasp_core.dataset.store import DatasetStore
    from grasp_core.dataset.trials import replay as again

    with DatasetStore.open(path, readonly=True) as store:
        found = again(store, grasp, number, trial=_trial(path, store.grasp(grasp).scene))
    assert found.attempt.recording is not None
    return Played(number, found.same, found.attempt.outcome.value, found.words, found.attempt.recording)


def score(path: Path) -> tuple[int, int]:
    """Score further scenes for a moment; scenes done and all scenes. At the end lists show the scores.

    Raises:
        GraspError: the weights are for another gripper, or the dataset cannot be written.
    """
    from grasp_core.dataset.predictions import score_dataset
    from grasp_core.dataset.store import DatasetStore
    from grasp_core.errors import Cancelled

    ends = time.monotonic() + SLICE
    told = [(0, 1)]
    with DatasetStore.open(path) as store:
        try:
            done = score_dataset(
                store,
                _runtime(),
                progress=lambda *counts: told.append(counts),
                cancelled=lambda: len(told) > 1 and time.monotonic() > ends,
            )
        except Cancelled:
            return told[-1]
    return done.scenes + done.before, done.scenes + done.before
