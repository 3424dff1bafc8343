"""Undo and redo of a person's label events, found in the log itself: they work after a restart, too.

A step is one event or all events of one bulk action. Undoing appends revert events, redoing reverts those; both say in
their details which step they are about. A new step ends what may be redone. Events that a colleague added meanwhile
stay as they are.
"""

from __future__ import annotations

import uuid

import msgspec

from grasp_core.dataset.labels import LabelEvent, standing
from grasp_core.dataset.store import DatasetStore


class Step(msgspec.Struct, frozen=True):
    """What undo or redo would act on next.

    Attributes:
        key: uid of the event, or name of the batch.
        events: how many.
        kind: of its newest event.
        grasp: of its newest event.
    """

    key: str
    events: int
    kind: str
    grasp: int


def undoable(store: DatasetStore, person: str) -> Step | None:
    """The newest step of a person that is not undone."""
    done, _ = _stacks(store, person)
    return done[-1] if done else None


def redoable(store: DatasetStore, person: str) -> Step | None:
    """The step that was undone last, unless something was done since."""
    _, undone = _stacks(store, person)
    return undone[-1] if undone else None


def undo(store: DatasetStore, person: str) -> list[LabelEvent]:
    """Take a person's newest step back; the revert events, none when there is nothing to undo."""
    with store.transaction():
        step = undoable(store, person)
        return [] if step is None else _revert(store, person, step.key, "undo", step.key)


def redo(store: DatasetStore, person: str) -> list[LabelEvent]:
    """Bring the step back that was undone last; the revert events, none when there is nothing to redo."""
    with store.transaction():
        step = redoable(store, person)
        if step is None:
            return []
        newest = store.row(
            f"SELECT coalesce(batch, uid) AS key FROM label_events WHERE person = {_PERSON}"
            " AND json_extract(details, '$.undoes') = ? ORDER BY id DESC LIMIT 1",
            (person, step.key),
        )
        assert newest is not None
        return _revert(store, person, newest["key"], "redo", step.key)


_PERSON = "(SELECT id FROM people WHERE name = ?)"


def _stacks(store: DatasetStore, person: str) -> tuple[list[Step], list[Step]]:
    """Steps that stand and steps that may be redone, each with the next one last."""
    rows = store.rows(
        f"""SELECT coalesce(batch, uid) AS key, count(*) AS events, max(id) AS last, kind, grasp,
                json_extract(details, '$.undoes') AS undoes, json_extract(details, '$.redoes') AS redoes
            FROM label_events WHERE person = {_PERSON} GROUP BY 1 ORDER BY last""",
        (person,),
    )
    done: dict[str, Step] = {}
    undone: dict[str, Step] = {}
    for row in rows:
        if row["undoes"] is not None:
            if row["undoes"] in done:
                undone[row["undoes"]] = done.pop(row["undoes"])
        elif row["redoes"] is not None:
            if row["redoes"] in undone:
                done[row["redoes"]] = undone.pop(row["redoes"])
        else:
            undone.clear()
            done[row["key"]] = Step(row["key"], row["events"], row["kind"], row["grasp"])
    return list(done.values()), list(undone.values())


def _revert(store: DatasetStore, person: str, key: str, word: str, step: str) -> list[LabelEvent]:
    """Revert what stands of the events with a key; at least one, so that the step counts as undone."""
    rows = store.rows(
        f"SELECT id, grasp FROM label_events WHERE person = {_PERSON} AND coalesce(batch, uid) = ? ORDER BY id",
        (person, key),
    )
    stand = [row for row in rows if any(event.id == row["id"] for event in standing(store.history(row["grasp"])))]
    batch = uuid.uuid4().hex if len(rows) > 1 else None
    details = {f"{word}es": step}
    return [
        store.append_event(row["grasp"], person, "human", "revert", None, word, "", row["id"], batch, details)
        for row in stand or rows[:1]
    ]
