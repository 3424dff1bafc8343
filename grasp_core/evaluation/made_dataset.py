"""A made dataset of any size, for benchmarks of lists and labels: rows as generation leaves them, drawn at random.

It holds everything that lists read (objects, scenes, grasps, attempts, scores, label events and notes), and neither
images nor meshes, which no list reads.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from grasp_core import config
from grasp_core.camera import canonical_camera
from grasp_core.dataset.events import VERDICTS
from grasp_core.dataset.labels import Kind
from grasp_core.dataset.rows import camera_json
from grasp_core.dataset.store import DatasetStore
from grasp_core.gripper import load_gripper
from grasp_core.simulation.physics import load_physics

GRASPS = 726
"""A scene, as in the paper's grid: 11 × 11 positions, 6 angles."""

SCENES_AN_OBJECT = 3
WEIGHTS = "made-up-weights"
_CATEGORIES = 50
_SHARES = (0.1, 0.75, 0.1, 0.05)
"""Of the four outcomes, about those of real datasets."""


_DECISIONS: tuple[float | Kind, ...] = (1.0, 0.0, "unsure", "exclude", "flag")


class Made(config.Settings):
    """Stands where generated datasets keep their recipe.

    Attributes:
        samples: at least so many; scenes are whole.
        decisions: label events of people.
        seed: everything random hangs on it.
    """

    samples: int = 1_000_000
    decisions: int = 20_000
    seed: int = 0


def make_dataset(path: Path, made: Made, *, progress: Callable[[int, int], None] | None = None) -> DatasetStore:
    """Fill a new dataset, open for work.

    Args:
        path: folder, without a dataset yet.
        made: how much.
        progress: called with (done, total) scenes.

    Raises:
        StoreError: there is a dataset, or no room.
    """
    rng = np.random.default_rng(made.seed)
    store = DatasetStore.create(path, name="made", gripper=load_gripper(), physics=load_physics(), recipe=made)
    total = -(-made.samples // GRASPS)
    with store.transaction() as db:
        db.execute("INSERT INTO cameras VALUES (1, 'made', ?)", (camera_json(canonical_camera()),))
    for scene in range(total):
        with store.transaction():
            _add_scene(store, scene, rng)
        if progress:
            progress(scene + 1, total)
    with store.transaction() as db:
        store._fill_samples("1", ())
        db.execute("ANALYZE")
    _score(store, rng)
    _decide(store, made.decisions, rng)
    return store


def _add_scene(store: DatasetStore, scene: int, rng: np.random.Generator) -> None:
    subject = scene // SCENES_AN_OBJECT + 1
    split = ("train", "train", "train", "train", "validation", "test")[subject % 6]
    with store.transaction() as db:
        if scene % SCENES_AN_OBJECT == 0:
            name, category = f"thing_{subject:05d}", f"category_{subject % _CATEGORIES:02d}"
            db.execute(
                "INSERT INTO objects VALUES (?,?,?,?,'made',?,'made','made')",
                (subject, name, category, split, f"{name}.npz"),
            )
        name = f"scene_{scene:05d}"
        db.execute(
            "INSERT INTO scenes VALUES (?,?,?,?,0,0,1,?,'made','made','made',0,0)",
            (scene + 1, name, subject, split, f"{name}.png"),
        )
        first = scene * GRASPS + 1
        places = rng.uniform(-0.1, 0.1, (GRASPS, 3)).tolist()
        db.executemany(
            "INSERT INTO grasps (id, scene, number, x, y, z, angle, width, origin) VALUES (?,?,?,?,?,?,?,0.1,'grid')",
            ((first + k, scene + 1, k, *place, 0.5 * (k % 6) - 1.5) for k, place in enumerate(places)),
        )
        attempts = rng.integers(1, 3, GRASPS)
        drawn = rng.choice(len(VERDICTS), (GRASPS, 2), p=_SHARES)
        db.executemany(
            "INSERT INTO attempts (grasp, number, outcome, seed, x, y, z, angle, dynamic, redraws)"
            " VALUES (?,?,?,?,0,0,0,0,0,0)",
            (
                (first + k, number, VERDICTS[drawn[k, number]], number)
                for k in range(GRASPS)
                for number in range(attempts[k])
            ),
        )


def _score(store: DatasetStore, rng: np.random.Generator) -> None:
    ids = np.arange(1, store.rows("SELECT max(id) FROM grasps")[0][0] + 1)
    for part in np.array_split(ids, max(1, len(ids) // 100_000)):
        store.add_predictions(WEIGHTS, "made", part, rng.beta(0.3, 2.0, len(part)), rng.random(len(part)))
    store.use_weights(WEIGHTS)


def _decide(store: DatasetStore, decisions: int, rng: np.random.Generator) -> None:
    highest = store.rows("SELECT max(id) FROM grasps")[0][0]
    words = ("rim", "handle", "slips", "bent", "look", "again", "edge", "lid")
    with store.transaction():
        for index, grasp in enumerate(rng.integers(1, highest + 1, decisions).tolist()):
            decision = _DECISIONS[index % len(_DECISIONS)]
            note = " ".join(rng.choice(words, 3)) if index % 4 == 0 else ""
            store.add_label(grasp, f"person {index % 7}", decision, note=note)
