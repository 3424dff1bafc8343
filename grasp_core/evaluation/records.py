"""The raw outcomes of a benchmark, one JSON object a line; every metric is computed from this log.

A line is written whole and flushed to the disk before the next scene counts as done. A run that was stopped goes on
from its log; a last line that was cut in the middle is dropped.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import msgspec

from grasp_core.errors import GraspError, MismatchError
from grasp_core.evaluation.scenes import SceneSpec
from grasp_core.grasp import Grasp


class Run(msgspec.Struct, frozen=True, tag="run", tag_field="kind"):
    """First line of a log: what the run was made with; only an equal run goes on from it.

    Where a run goes on with further planners, another such line names those too.

    Attributes:
        objects: the folder or suite as given.
        scale: of the meshes.
        seed: of the run.
        attempts: executions a candidate.
        weights: name or path, of the planners with networks.
        physics: digest.
        gripper: digest.
        camera: digest of camera and pose.
        noise: digest of Eq. 4 and 5.
        planners: planner → what its plans follow from: kind, digest of its settings, name and digest of its weights;
            None in logs from before these were kept, which are read but not gone on with.
    """

    objects: str
    scale: str
    seed: int
    attempts: int
    weights: str
    physics: str
    gripper: str
    camera: str
    noise: str
    planners: dict[str, str] | None = None


class SceneRecord(msgspec.Struct, frozen=True, tag="scene", tag_field="kind"):
    """A scene and what the oracle says of it.

    Attributes:
        spec: which scene.
        category: of the object.
        probability: of the stable pose.
        world_from_object: 4×4, rows.
        graspable: whether the oracle knows a grasp.
        quality: of its best grasp, re-tested with fresh seeds; 0 without one.
        shape_off: share of the object's pixels at which its convex parts, which are simulated, stand more than 5 mm off
            its mesh, which is seen: failures of such an object may be its parts' and not the planner's.
        distinct: how many of the oracle's grasps are distinct; None in logs from before they were counted.
    """

    spec: SceneSpec
    category: str
    probability: float
    world_from_object: list[list[float]]
    graspable: bool
    quality: float
    shape_off: float
    distinct: int | None = None


class CandidateRecord(msgspec.Struct, frozen=True):
    """One returned candidate and its executions.

    Attributes:
        grasp: in the world.
        score: of the planner.
        outcomes: names of the outcomes, one an attempt.
        seeds: of the attempts, to replay them.
        redraws: how often each was drawn anew because the solver diverged; an execution that was counts as failed.
        shift: metres that the object moved in the gripper, one an attempt, where it was held.
    """

    grasp: Grasp
    score: float
    outcomes: tuple[str, ...]
    seeds: tuple[int, ...]
    redraws: tuple[int, ...]
    shift: tuple[float | None, ...] = ()

    @property
    def successes(self) -> int:
        """How many attempts succeeded at first draw."""
        return sum(o == "SUCCESS" and not r for o, r in zip(self.outcomes, self.redraws, strict=True))


class PlanRecord(msgspec.Struct, frozen=True, tag="plan", tag_field="kind"):
    """What one planner did on one scene.

    Attributes:
        scene: name of the scene.
        planner: name of the planner.
        plan_ms: wall time of the call.
        reason: why the plan is empty, or none.
        candidates: best first.
        weights: name and digest of what the planner really used, "" without networks.
    """

    scene: str
    planner: str
    plan_ms: float
    reason: str | None
    candidates: tuple[CandidateRecord, ...]
    weights: str = ""


Record = Run | SceneRecord | PlanRecord


class Log:
    """A JSON Lines file of records; without a path it lives in memory only."""

    def __init__(self, run: Run, path: Path | None = None) -> None:
        """Open or begin a log.

        Raises:
            MismatchError: the file is the log of another run.
            GraspError: the file is no log or cannot be written.
        """
        self.path = path
        self.run = run
        self.scenes: dict[str, SceneRecord] = {}
        self.plans: dict[tuple[str, str], PlanRecord] = {}
        found = list(_read(path)) if path is not None and path.is_file() else []
        if found:
            self._go_on(run, found)
        elif path is not None:
            try:
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(b"")
            except OSError as error:
                raise GraspError(f"{path}: cannot be written ({error.strerror}); give another folder") from error
            self._append(run)

    def _go_on(self, run: Run, found: list[Record]) -> None:
        first = found[0]
        if not isinstance(first, Run):
            raise GraspError(f"{self.path}: does not begin with the settings of a run; give another folder")
        known, own = _planners(found), run.planners or {}
        different = [
            name for name in run.__struct_fields__ if name != "planners" and getattr(run, name) != getattr(first, name)
        ]
        different += [f"{name} ({known[name]})" for name in own if known and known.get(name, own[name]) != own[name]]
        if different:
            raise MismatchError(
                f"{self.path}: is the log of a run with other {', '.join(different)}; repeat its settings and weights"
                " to go on with it, or give another folder"
            )
        self.run = msgspec.structs.replace(run, planners=None if known is None else known | own)
        for record in found[1:]:
            self._keep(record)
        if known is not None and not own.keys() <= known.keys():
            self._append(self.run)

    def check_more(self) -> None:
        """Refuse to add to a log that does not tell what its planners were.

        Raises:
            MismatchError: the log is an old one.
        """
        if self.run.planners is None:
            raise MismatchError(
                f"{self.path}: was written before logs told the settings and weights of their planners, so that it can"
                " be reported but not gone on with; give another folder"
            )

    def _keep(self, record: Record) -> None:
        if isinstance(record, SceneRecord):
            self.scenes[record.spec.name] = record
        elif isinstance(record, PlanRecord):
            self.plans[record.scene, record.planner] = record

    def _append(self, record: Record) -> None:
        if self.path is None:
            return
        with self.path.open("ab") as stream:
            stream.write(msgspec.json.encode(record) + b"\n")
            stream.flush()
            os.fsync(stream.fileno())

    def add(self, record: SceneRecord | PlanRecord) -> None:
        """Append a record; it is on the disk when the call returns."""
        self._append(record)
        self._keep(record)


def _planners(found: list[Record]) -> dict[str, str] | None:
    """What a log tells of its planners."""
    told = [record.planners for record in found if isinstance(record, Run) and record.planners is not None]
    return told[-1] if told else None


def _read(path: Path) -> Iterator[Record]:
    """The whole lines of a log; a cut last line is removed from the file."""
    decoder = msgspec.json.Decoder(Record)
    data = path.read_bytes()
    whole = data.rpartition(b"\n")[0]
    for number, line in enumerate(whole.splitlines(), start=1):
        try:
            yield decoder.decode(line)
        except msgspec.DecodeError as error:
            raise GraspError(f"{path}: line {number} is no record ({error}); give another folder") from error
    if data and not data.endswith(b"\n"):
        path.write_bytes(whole + b"\n" if whole else b"")
