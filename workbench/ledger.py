"""Writes verdicts to the workbench's dataset; every rule is the store's own."""

from __future__ import annotations

import getpass
import hashlib
import itertools
import threading
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import platformdirs

from grasp_core import config
from grasp_core.dataset.content import SceneRecord
from grasp_core.dataset.database import FILE
from grasp_core.dataset.events import LabelEvent
from grasp_core.dataset.rows import AttemptRow, StoredPose
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import MismatchError
from grasp_core.gripper import Gripper
from grasp_core.sensing.renderer import Renderer
from grasp_core.simulation.physics import Physics
from workbench.inspector.orders import Choice, Judgement, OpenedScene, Try
from workbench.inspector.setup import DEFAULT


class Source(config.Settings):
    """Stands where generated datasets keep their recipe.

    Attributes:
        made_by: what added the scenes.
    """

    made_by: str = "grasp-workbench"


def default_dataset(gripper: Gripper, physics: Physics) -> Path:
    """The user's own dataset, in their data folder.

    After an update that changed gripper or physics the old one is left as it is and the next name is taken.

    Raises:
        StoreError: a dataset there cannot be read.
    """
    folder = Path(platformdirs.user_data_dir("grasp-workbench"))
    for name in itertools.chain(["workbench"], (f"workbench-{number}" for number in itertools.count(2))):
        try:
            Ledger(folder / name, gripper, physics).check()
        except MismatchError:
            continue
        return folder / name
    raise AssertionError("names never end")


def person() -> str:
    """The name that verdicts are stored under: the user's on this machine."""
    try:
        return getpass.getuser()
    except (OSError, KeyError, ImportError):
        return "somebody"


class Ledger:
    """The dataset that verdicts go to, made when the first one is stored.

    Attributes:
        path: its folder.
    """

    def __init__(self, path: Path, gripper: Gripper, physics: Physics) -> None:
        self.path = path
        self._gripper = gripper
        self._physics = physics
        self._lock = threading.Lock()
        self.thread = ThreadPoolExecutor(1, thread_name_prefix="ledger")

    def check(self) -> None:
        """Open the dataset if it is there, so that a wrong one is refused before work starts.

        Raises:
            StoreError: it cannot be read.
            MismatchError: it was made with another gripper or physics.
        """
        if (self.path / FILE).exists() or self.path.name == FILE:
            self._open().close()

    def _open(self) -> DatasetStore:
        folder = self.path.parent if self.path.name == FILE else self.path
        if (folder / FILE).exists():
            store = DatasetStore.open(folder)
            try:
                store.check(gripper=self._gripper, physics=self._physics)
            except BaseException:
                store.close()
                raise
            return store
        return DatasetStore.create(
            folder, name=folder.name, gripper=self._gripper, physics=self._physics, recipe=Source()
        )

    def record(self, opened: OpenedScene, choice: Choice, judgement: Judgement, attempts: Sequence[Try]) -> LabelEvent:
        """Store a person's verdict on a candidate, with its scene, grasp and attempts where they are new.

        Attempts with another noise than the shipped one are left out: they would count for the label.

        Raises:
            StoreError: it cannot be written.
            MismatchError: the dataset, or the candidate, was made with another gripper or physics.
        """
        if opened.gripper.digest != self._gripper.digest:
            raise MismatchError(
                f"the dataset is for the gripper '{self._gripper.name}', not '{opened.gripper.name}'; plan with its own"
            )
        with self._lock, self._open() as store:
            placed, thing = opened.scene.objects[0], opened.request.things[0]
            poses = [StoredPose(tuple(p.reshape(-1).tolist()), share) for p, share in opened.rests[0].poses]
            store.add_object(placed.asset, "train", poses)
            name = scene_name(opened)
            clean = Renderer(opened.scene).render()
            record = SceneRecord(name, placed.asset.name, thing.pose, opened.request.place, opened.scene, clean, (), ())
            store.add_scene(record)
            candidate = opened.candidates(choice.side)[choice.index]
            who = person()
            grasp = store.add_grasp(store.scene_id(name), candidate.grasp, origin="planner")
            known = {row.seed for row in store.attempts(grasp)}
            usual = opened.setup.tries[1:] == DEFAULT.tries[1:]
            rows = [_row(attempt) for attempt in attempts if usual and attempt.seed not in known]
            if rows:
                store.add_attempts(grasp, rows, person=who, reason="tried in the workbench")
            plan = opened.sight.plans[choice.side]
            details = {
                "score": candidate.score,
                "planner": opened.setup.planners[choice.side],
                "weights": "" if plan is None else plan.weights,
            }
            return store.add_label(
                grasp, who, 1.0 if judgement == "good" else 0.0, reason="verdict in the workbench", details=details
            )


def scene_name(opened: OpenedScene) -> str:
    """The name that a scene of one object is stored under: the same wherever and whenever it is made."""
    placed, thing = opened.scene.objects[0], opened.request.things[0]
    name = f"workbench_{placed.asset.name}_{thing.pose}_{opened.request.place}"
    usual = opened.setup.sees[:3] == DEFAULT.sees[:3]
    if thing.at is None and usual:
        return name
    content = placed.world_from_object.tobytes() + repr(opened.setup.sees[:3]).encode()
    return f"{name}_{hashlib.sha256(content).hexdigest()[:8]}"


def _row(attempt: Try) -> AttemptRow:
    p = attempt.executed
    return AttemptRow(
        attempt.outcome,
        attempt.seed,
        (*p.position, p.angle),
        attempt.dynamic,
        attempt.redraws,
        attempt.moved,
        attempt.evidence,
    )
