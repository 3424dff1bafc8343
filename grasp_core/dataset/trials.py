"""More DART attempts on stored grasps, pooled into their quality, and replays of stored attempts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import msgspec

from grasp_core import config
from grasp_core.dataset.generate import attempt_row
from grasp_core.dataset.labels import LabelEvent
from grasp_core.dataset.rows import AttemptRow
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import Cancelled, MismatchError, StoreError
from grasp_core.rates import wilson
from grasp_core.simulation.physics import Physics
from grasp_core.simulation.trial import Attempt, GraspNoise, GraspTrial, child_seed


class Pooled(msgspec.Struct, frozen=True):
    """The quality of a sample over all its standing attempts.

    Attributes:
        successes: of them.
        attempts: those with a verdict.
        quality: successes / attempts, None without attempts.
        low: lower end of the 95 % Wilson interval.
        high: its upper end.
    """

    successes: int
    attempts: int
    quality: float | None
    low: float
    high: float


@dataclass(frozen=True)
class Replay:
    """A stored attempt executed again, with everything that moved.

    Attributes:
        stored: the attempt as the dataset has it.
        attempt: what happened now, with its recording.
        same: the outcomes agree.
        words: for people.
    """

    stored: AttemptRow
    attempt: Attempt
    same: bool
    words: str


def pooled_quality(store: DatasetStore, grasp_id: int) -> Pooled:
    """The quality of a sample with its interval.

    Raises:
        StoreError: no such grasp.
    """
    row = store.grasp(grasp_id)
    return Pooled(row.successes, row.attempts, row.quality, *wilson(row.successes, row.attempts))


def scene_trial(store: DatasetStore, scene_id: int) -> GraspTrial:
    """A scene ready for trials under the gripper, physics and noise that the dataset was made with.

    Raises:
        MismatchError: this version cannot reproduce that physics.
    """
    meta = store.meta
    physics = config.convert(meta.physics, Physics, f"{store.file}, physics")
    if physics.digest != meta.physics_digest:
        raise MismatchError(
            f"{store.path}: was made under physics that this version does not reproduce; attempts of both must not be"
            " mixed, so generate the dataset anew to verify grasps"
        )
    noise = meta.recipe.get("noise")
    drawn = GraspNoise() if noise is None else config.convert(noise, GraspNoise, f"{store.file}, noise")
    return GraspTrial(store.scene(scene_id), store.gripper(), physics, drawn)


def fresh_seeds(store: DatasetStore, grasp_id: int, count: int) -> list[int]:
    """Seeds for further attempts on a grasp that none of its attempts has used, the same ones each time."""
    row = store.grasp(grasp_id)
    scene = store.rows("SELECT seed FROM scenes WHERE id = ?", (row.scene,))[0]["seed"]
    used = {attempt.seed for attempt in store.attempts(grasp_id)}
    seeds: list[int] = []
    index = 0
    while len(seeds) < count:
        seed = child_seed(child_seed(scene, row.number + 1_000_003), index)
        if seed not in used:
            seeds.append(seed)
            used.add(seed)
        index += 1
    return seeds


def verify_grasp(
    store: DatasetStore,
    grasp_id: int,
    attempts: int = 5,
    *,
    person: str | None = None,
    trial: GraspTrial | None = None,
    progress: Callable[[int, int], None] | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> tuple[LabelEvent, Pooled]:
    """Run more DART attempts on a grasp and pool them into its quality.

    Args:
        store: the dataset, open for writing.
        grasp_id: of the grasp.
        attempts: how many.
        person: who asks.
        trial: the scene's `scene_trial`, made here by default.
        progress: called with (done, total) attempts.
        cancelled: asked between attempts.

    Returns:
        The label event, and the quality over all attempts.

    Raises:
        StoreError: no such grasp, or no attempts asked for.
        MismatchError: see `scene_trial`.
        Cancelled: nothing was stored.
    """
    if attempts < 1:
        raise StoreError(f"verifying takes at least one attempt, not {attempts}")
    row = store.grasp(grasp_id)
    ready = trial or scene_trial(store, row.scene)
    found = []
    for number, seed in enumerate(fresh_seeds(store, grasp_id, attempts)):
        if cancelled is not None and cancelled():
            raise Cancelled("cancelled; no attempt was stored")
        found.append(attempt_row(ready.attempt(row.grasp, seed)))
        if progress is not None:
            progress(number + 1, attempts)
    details = {"physics": store.meta.physics_digest}
    event = store.add_attempts(grasp_id, found, person=person, reason="verified in DART", details=details)
    return event, pooled_quality(store, grasp_id)


def replay(store: DatasetStore, grasp_id: int, number: int, *, trial: GraspTrial | None = None) -> Replay:
    """Execute a stored attempt again, recorded.

    Args:
        store: the dataset.
        grasp_id: of the grasp.
        number: of the attempt in `DatasetStore.attempts`.
        trial: the scene's `scene_trial`, made here by default.

    Raises:
        StoreError: no such grasp or attempt.
        MismatchError: see `scene_trial`.
    """
    row, stored = store.grasp(grasp_id), store.attempts(grasp_id)
    if not 0 <= number < len(stored):
        raise StoreError(f"grasp {grasp_id} has {len(stored)} attempts, counted from 0; there is no {number}")
    ready = trial or scene_trial(store, row.scene)
    attempt = ready.attempt(row.grasp, stored[number].seed, record=True)
    same = attempt.outcome.value == stored[number].outcome
    words = attempt.evidence.words
    if not same:
        words = (
            f"ends as {attempt.outcome.value} now, but {stored[number].outcome} is stored: program or machine differ"
            f" from those that made the dataset. {words}"
        )
    return Replay(stored[number], attempt, same, words)
