"""Label events as JSON Lines: work done on one copy of a dataset goes into another, in any order, any number of times.

A line is one event with the scene's name and the grasp's number, which are the same in every copy, the grasp itself
(those that people made travel with their labels) and with the attempts that the event asked for.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Literal

import msgspec

from grasp_core.dataset import schema
from grasp_core.dataset.labels import Kind, Source
from grasp_core.dataset.rows import AttemptRow, GraspRow, Origin
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import StoreError
from grasp_core.grasp import Grasp


class EventLine(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One label event as it travels.

    Attributes:
        uid: of the event.
        scene: name.
        number: of the grasp in the scene.
        grasp: x, y, z (m), angle (rad), width (m).
        origin: who made the grasp.
        maker: the person who made it, if one did.
        at: Unix time, ms.
        person: who decided.
        source: human or dart.
        kind: see `LabelEvent`.
        value: likewise.
        reason: likewise.
        note: likewise.
        reverts: uid of the event taken back.
        batch: of a bulk action.
        details: likewise.
        attempts: that the event added.
    """

    uid: str
    scene: str
    number: int
    grasp: tuple[float, float, float, float, float]
    origin: Origin
    at: int
    source: Source
    kind: Kind
    maker: str | None = None
    person: str | None = None
    value: float | None = None
    reason: str = ""
    note: str = ""
    reverts: str | None = None
    batch: str | None = None
    details: dict = {}
    attempts: list[AttemptRow] = []


class Merged(msgspec.Struct, frozen=True):
    """What an import did.

    Attributes:
        added: events that were new.
        known: events that were there already.
        left_out: reason → number of events that could not be used.
    """

    added: int
    known: int
    left_out: dict[str, int]


def event_lines(store: DatasetStore) -> Iterator[EventLine]:
    """All label events of a dataset, oldest first."""
    names = {row["id"]: row["name"] for row in store.rows("SELECT id, name FROM scenes")}
    uids: dict[int, str] = {}
    grasps: dict[int, GraspRow] = {}
    for event in store.events():
        uids[event.id] = event.uid
        row = grasps.setdefault(event.grasp, store.grasp(event.grasp))
        attempts = []
        if event.kind == "attempts":
            added = [attempt for attempt in store.attempts(event.grasp) if attempt.event == event.id]
            attempts = [msgspec.structs.replace(attempt, event=None) for attempt in added]
        yield EventLine(
            uid=event.uid,
            scene=names[row.scene],
            number=row.number,
            grasp=(*row.grasp.position, row.grasp.angle, row.grasp.width),
            origin=row.origin,
            maker=row.person,
            at=event.at,
            person=event.person,
            source=event.source,
            kind=event.kind,
            value=event.value,
            reason=event.reason,
            note=event.note,
            reverts=None if event.reverts is None else uids[event.reverts],
            batch=event.batch,
            details=event.details,
            attempts=attempts,
        )


def export_events(store: DatasetStore, file: str | Path) -> int:
    """Write all label events to a JSON Lines file; how many.

    Raises:
        StoreError: the file cannot be written.
    """
    lines = [msgspec.json.encode(line) for line in event_lines(store)]
    try:
        Path(file).write_bytes(b"".join(line + b"\n" for line in lines))
    except OSError as error:
        raise StoreError(f"{file}: cannot be written ({error.strerror}); give another file") from error
    return len(lines)


def import_events(store: DatasetStore, file: str | Path) -> Merged:
    """Add the events of a JSON Lines file that are not there yet; all of them or, on an error, none.

    Events of scenes that this dataset does not hold are left out and counted.

    Raises:
        StoreError: the file cannot be read, or a line is no label event.
    """
    try:
        data = Path(file).read_bytes()
    except OSError as error:
        raise StoreError(f"{file}: cannot be read ({error.strerror})") from error
    lines = []
    for number, text in enumerate(data.splitlines(), start=1):
        if text.strip():
            try:
                lines.append(msgspec.json.decode(text, type=EventLine))
            except msgspec.DecodeError as error:
                raise StoreError(f"{file}: line {number} is no label event ({error}); nothing was imported") from error
    return add_events(store, lines)


def add_events(store: DatasetStore, lines: Iterable[EventLine]) -> Merged:
    """Add events that are not there yet, in one transaction."""
    added = known = 0
    left_out: Counter[str] = Counter()
    with store.transaction():
        ids = {row["uid"]: row["id"] for row in store.rows("SELECT uid, id FROM label_events")}
        for line in lines:
            if line.uid in ids:
                known += 1
                continue
            grasp = _grasp_of(store, line)
            if isinstance(grasp, str):
                left_out[grasp] += 1
                continue
            if line.reverts is not None and line.reverts not in ids:
                left_out["it takes back an event that is not there"] += 1
                continue
            used = {row["seed"] for row in store.rows("SELECT seed FROM attempts WHERE grasp = ?", (grasp,))}
            ids[line.uid] = store.append_event(
                grasp,
                line.person,
                line.source,
                line.kind,
                line.value,
                line.reason,
                line.note,
                None if line.reverts is None else ids[line.reverts],
                line.batch,
                line.details,
                uid=line.uid,
                at=line.at,
                attempts=[attempt for attempt in line.attempts if attempt.seed not in used],
            ).id
            added += 1
    return Merged(added, known, dict(left_out))


_CLOSE = 1e-6
"""Metres and rad: grasps of one number that differ by more are not the same grasp."""


def _grasp_of(store: DatasetStore, line: EventLine) -> int | Literal["its scene is not there", "its grasp differs"]:
    """The id of a line's grasp, which is added when people made it; or why it cannot be used."""
    scene = store.row("SELECT id FROM scenes WHERE name = ?", (line.scene,))
    if scene is None:
        return "its scene is not there"
    row = store.row(
        "SELECT id, x, y, z, angle, width FROM grasps WHERE scene = ? AND number = ?", (scene["id"], line.number)
    )
    if row is not None:
        here = (row["x"], row["y"], row["z"], row["angle"], row["width"])
        same = all(abs(a - b) <= _CLOSE for a, b in zip(here, line.grasp, strict=True))
        return int(row["id"]) if same else "its grasp differs"
    if line.number < schema.HAND_MADE:
        return "its grasp differs"
    x, y, z, angle, width = line.grasp
    return store.add_grasp(scene["id"], Grasp((x, y, z), angle, width), person=line.maker, origin=line.origin)
