"""Label events of a dataset: decisions, remarks, reverts and further attempts, each appended and never changed.

Every call is one transaction and durable when it returns. The label in `samples` is computed by `labels.current_label`
in the same transaction as the event that changes it, so that the two never differ.
"""

from __future__ import annotations

import uuid
from collections import Counter
from collections.abc import Sequence
from typing import Any

import msgspec

from grasp_core.dataset.content import Content, now_ms
from grasp_core.dataset.labels import CurrentLabel, Kind, LabelConflict, LabelEvent, current_label, standing
from grasp_core.dataset.rows import AttemptRow
from grasp_core.errors import StoreError

VERDICTS = ("SUCCESS", "COLLISION", "MISSED", "SLIPPED")
"""Outcomes that count as attempts, in the order of the columns of `samples`."""

_NAMES = "id, uid, grasp, at, source, kind, value, old_value, new_value, reason, note, reverts, batch, details"
_EVENTS = f"""SELECT {", ".join("e." + name for name in _NAMES.split(", "))}, people.name AS person
    FROM label_events AS e LEFT JOIN people ON people.id = e.person"""


class LabelEvents(Content):
    """The part of a store that keeps who decided what, when and why."""

    def add_label(
        self,
        grasp_id: int,
        person: str,
        decision: float | Kind,
        *,
        reason: str = "",
        note: str = "",
        batch: str | None = None,
        details: dict | None = None,
        seen_event: int | None = None,
        value: float | None = None,
    ) -> LabelEvent:
        """Record a person's decision or remark on a sample.

        Args:
            grasp_id: of the grasp.
            person: self-declared name.
            decision: a value in [0, 1], or "unsure", "exclude", "flag", "unflag", "note", "opinion".
            reason: why, one sentence.
            note: free text.
            batch: shared by the events of one bulk action.
            details: more about how it came about.
            seen_event: the newest event that the person saw (0: none); given it, newer decisions are a conflict.
            value: of an opinion, in [0, 1].

        Raises:
            LabelConflict: somebody decided meanwhile; nothing was written.
            StoreError: no such grasp, a value out of range, or it cannot be written.
        """
        kind: Kind = decision if isinstance(decision, str) else "value"
        if not isinstance(decision, str):
            value = float(decision)
        if kind in ("attempts", "revert"):
            raise StoreError(f"'{kind}' is no decision: use add_attempts or revert")
        if value is not None and not 0 <= value <= 1:
            raise StoreError(f"a label is a value between 0 and 1, not {value}")
        with self.transaction():
            if seen_event is not None:
                self._refuse_unseen(grasp_id, seen_event)
            return self.append_event(grasp_id, person, "human", kind, value, reason, note, None, batch, details or {})

    def revert(self, event_id: int, person: str, *, reason: str = "", batch: str | None = None) -> LabelEvent:
        """Take an event back; reverting a revert event brings back what it took.

        Raises:
            StoreError: no such event.
        """
        with self.transaction():
            row = self.row("SELECT grasp FROM label_events WHERE id = ?", (event_id,))
            if row is None:
                raise StoreError(f"{self.path}: holds no label event {event_id}")
            return self.append_event(row["grasp"], person, "human", "revert", None, reason, "", event_id, batch, {})

    def _refuse_unseen(self, grasp_id: int, seen_event: int) -> None:
        newer = sorted((e for e in self.history(grasp_id) if e.id > seen_event), key=lambda event: event.id)
        if newer:
            last = newer[-1]
            raise LabelConflict(
                f"{last.person or 'DART'} changed this sample meanwhile ({last.kind}"
                f"{'' if last.value is None else f' {last.value:g}'}); look at both and decide again",
                tuple(newer),
            )

    def append_event(
        self,
        grasp_id: int,
        person: str | None,
        source: str,
        kind: Kind,
        value: float | None,
        reason: str,
        note: str,
        reverts: int | None,
        batch: str | None,
        details: dict,
        *,
        uid: str | None = None,
        at: int | None = None,
        attempts: Sequence[AttemptRow] = (),
    ) -> LabelEvent:
        """Append one event (and the attempts it stands for) and bring the sample's label up to date."""
        before = self.current(grasp_id)
        who = None if person is None else self.person_id(person)
        known = self.history(grasp_id)
        event = LabelEvent(
            id=self._db.execute("SELECT coalesce(max(id), 0) + 1 FROM label_events").fetchone()[0],
            uid=uid or uuid.uuid4().hex,
            grasp=grasp_id,
            at=max([now_ms(), *(other.at + 1 for other in known)]) if at is None else at,
            person=person,
            source="human" if source == "human" else "dart",
            kind=kind,
            value=value,
            old_value=before.value,
            new_value=None,
            reason=reason,
            note=note,
            reverts=reverts,
            batch=batch,
            details=details,
        )
        counts = self._pooled(grasp_id, standing([*known, event]))
        counts.update(row.outcome for row in attempts)
        after = current_label([*known, event], counts["SUCCESS"], sum(counts[name] for name in VERDICTS))
        event = msgspec.structs.replace(event, new_value=after.value)
        values = {**msgspec.structs.asdict(event), "person": who}
        values["details"] = msgspec.json.encode(details, order="sorted").decode()
        names = ", ".join(values)
        self._db.execute(
            f"INSERT INTO label_events ({names}) VALUES ({','.join('?' * len(values))})", list(values.values())
        )
        if attempts:
            query = "SELECT coalesce(max(number), -1) + 1 FROM attempts WHERE grasp = ?"
            first = self._db.execute(query, (grasp_id,)).fetchone()[0]
            self._insert_attempts(grasp_id, first, [msgspec.structs.replace(row, event=event.id) for row in attempts])
        self._write_label(grasp_id, after, counts, len(known) + 1, event.id)
        return event

    def _pooled(self, grasp: int, stand: Sequence[LabelEvent]) -> Counter[str]:
        """Outcomes of a grasp's attempts, but for those whose event was taken back."""
        ids = {event.id for event in stand}
        counts: Counter[str] = Counter()
        query = "SELECT event, outcome, count(*) AS n FROM attempts WHERE grasp = ? GROUP BY event, outcome"
        for row in self.rows(query, (grasp,)):
            if row["event"] is None or row["event"] in ids:
                counts[row["outcome"]] += row["n"]
        return counts

    def _write_label(
        self, grasp: int, label: CurrentLabel, counts: Counter[str], events: int, last: int | None
    ) -> None:
        n = sum(counts[name] for name in VERDICTS)
        quality = counts["SUCCESS"] / n if n else None
        self._db.execute(
            """UPDATE samples SET attempts = ?, successes = ?, collisions = ?, missed = ?, slipped = ?, quality = ?,
                   gap = abs(score - ?), label = ?, state = ?, source = ?, flagged = ?, events = ?, last_event = ?
               WHERE grasp = ?""",
            (
                n,
                *(counts[name] for name in VERDICTS),
                quality,
                quality,
                label.value,
                label.state,
                label.source,
                int(label.flagged),
                events,
                last,
                grasp,
            ),
        )

    def rebuild_labels(self, scene_id: int | None = None) -> None:
        """Make `samples` anew from attempts and label events (scores are put back by `use_weights`)."""
        where, values = ("grasps.scene = ?", [scene_id]) if scene_id is not None else ("1", [])
        with self.transaction() as db:
            self._fill_samples(where, values)
            touched = db.execute(
                f"SELECT DISTINCT grasp FROM label_events JOIN grasps ON grasps.id = grasp WHERE {where}", values
            ).fetchall()
            for (grasp,) in touched:
                known = self.history(grasp)
                counts = self._pooled(grasp, standing(known))
                label = current_label(known, counts["SUCCESS"], sum(counts[name] for name in VERDICTS))
                self._write_label(grasp, label, counts, len(known), max(event.id for event in known))

    def differing_labels(self) -> list[int]:
        """Ids of grasps whose row in `samples` is not what attempts and label events say."""
        counted = """SELECT attempts.grasp AS grasp, sum(outcome <> 'UNSTABLE') AS n, sum(outcome = 'SUCCESS') AS good
            FROM attempts WHERE grasp NOT IN (SELECT grasp FROM label_events) GROUP BY grasp"""
        found = self.rows(
            f"""SELECT samples.grasp FROM samples JOIN ({counted}) AS c ON c.grasp = samples.grasp
                WHERE (attempts, successes) IS NOT (n, good) OR label IS NOT CAST(good AS REAL) / nullif(n, 0)
                    OR quality IS NOT CAST(good AS REAL) / nullif(n, 0)"""
        )
        differ = [int(row["grasp"]) for row in found]
        labelled = "SELECT DISTINCT e.grasp, label, state, flagged FROM label_events AS e JOIN samples USING (grasp)"
        for row in self.rows(labelled):
            known = self.history(row["grasp"])
            counts = self._pooled(row["grasp"], standing(known))
            label = current_label(known, counts["SUCCESS"], sum(counts[name] for name in VERDICTS))
            if (label.value, label.state, label.flagged) != (row["label"], row["state"], bool(row["flagged"])):
                differ.append(int(row["grasp"]))
        return sorted(differ)

    def history(self, grasp_id: int) -> list[LabelEvent]:
        """All label events of a sample, oldest first."""
        return self._events("WHERE e.grasp = ? ORDER BY e.at, e.uid", (grasp_id,))

    def events_of(self, person: str, *, before: int | None = None, limit: int = 100) -> list[LabelEvent]:
        """A person's events, newest first; `before` is the id of the last one of the page before."""
        where, values = ("AND e.id < ?", [before]) if before is not None else ("", [])
        query = f"WHERE e.person = (SELECT id FROM people WHERE name = ?) {where} ORDER BY e.id DESC LIMIT ?"
        return self._events(query, (person, *values, limit))

    def batch(self, batch: str) -> list[LabelEvent]:
        """The events of one bulk action, oldest first."""
        return self._events("WHERE e.batch = ? ORDER BY e.id", (batch,))

    def events(self) -> list[LabelEvent]:
        """All label events of the dataset, oldest first."""
        return self._events("ORDER BY e.id", ())

    def _events(self, where: str, values: Sequence[Any]) -> list[LabelEvent]:
        return [
            LabelEvent(**{**dict(row), "details": msgspec.json.decode(row["details"])})
            for row in self.rows(f"{_EVENTS} {where}", values)
        ]

    def current(self, grasp_id: int) -> CurrentLabel:
        """The label of a sample now, with the rule that gave it.

        Raises:
            StoreError: no such grasp.
        """
        row = self.row("SELECT attempts, successes FROM samples WHERE grasp = ?", (grasp_id,))
        if row is None:
            raise StoreError(f"{self.path}: holds no grasp with the id {grasp_id}")
        return current_label(self.history(grasp_id), row["successes"], row["attempts"])

    def add_attempts(
        self,
        grasp_id: int,
        attempts: Sequence[AttemptRow],
        *,
        person: str | None = None,
        reason: str = "",
        details: dict | None = None,
    ) -> LabelEvent:
        """Pool more DART attempts into a sample's quality; seeds that it has already are refused.

        Raises:
            StoreError: no such grasp, no attempts, or a seed used before (the same attempt would count twice).
        """
        if not attempts:
            raise StoreError("there are no attempts to add")
        with self.transaction():
            used = {row["seed"] for row in self.rows("SELECT seed FROM attempts WHERE grasp = ?", (grasp_id,))}
            seeds = [row.seed for row in attempts]
            twice = sorted(used.intersection(seeds)) or [s for s in set(seeds) if seeds.count(s) > 1]
            if twice:
                raise StoreError(f"seed {twice[0]} stands twice for this grasp: give attempts with fresh seeds")
            more = {"seeds": seeds, **(details or {})}
            return self.append_event(
                grasp_id, person, "dart", "attempts", None, reason, "", None, None, more, attempts=attempts
            )

    def person_id(self, name: str) -> int:
        """The id of a person, who is added when new.

        Raises:
            StoreError: an empty name.
        """
        name = name.strip()
        if not name:
            raise StoreError("a label needs the name of the person who gives it; say who you are")
        found = self.row("SELECT id FROM people WHERE name = ?", (name,))
        if found is not None:
            return int(found["id"])
        with self.transaction() as db:
            new = db.execute("INSERT INTO people (name, added) VALUES (?, ?)", (name, now_ms())).lastrowid
        assert new is not None
        return new
