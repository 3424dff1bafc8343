"""What else people keep in a dataset: grasps of their own, saved views, and scores of networks to look at."""

from __future__ import annotations

import hashlib
import struct
from collections.abc import Sequence
from typing import Any

import msgspec
import numpy as np
from numpy.typing import ArrayLike

from grasp_core.dataset import schema
from grasp_core.dataset.content import now_ms
from grasp_core.dataset.events import LabelEvents
from grasp_core.dataset.rows import GraspRow, Origin
from grasp_core.errors import StoreError
from grasp_core.grasp import Grasp


class Curation(LabelEvents):
    """The part of a store that keeps people's grasps, views and networks' scores."""

    def add_grasp(
        self,
        scene_id: int,
        grasp: Grasp,
        *,
        person: str | None = None,
        parent: int | None = None,
        origin: Origin = "person",
    ) -> int:
        """Store a grasp that people or a planner made; the id of the one that is there when it was made before.

        Raises:
            StoreError: no such scene, or it cannot be written.
        """
        numbers = struct.pack("<5d", *grasp.position, grasp.angle, grasp.width)
        number = schema.HAND_MADE + int.from_bytes(hashlib.sha256(numbers).digest()[:6], "little")
        with self.transaction() as db:
            found = self.row("SELECT id FROM grasps WHERE scene = ? AND number = ?", (scene_id, number))
            if found is not None:
                return int(found["id"])
            self._scene_field(scene_id, "scenes.id")
            who = None if person is None else self.person_id(person)
            new = db.execute(
                "INSERT INTO grasps (scene, number, x, y, z, angle, width, origin, person, parent, added)"
                " VALUES (?,?,?,?,?,?,?,?,?,?,?)",
                (scene_id, number, *grasp.position, grasp.angle, grasp.width, origin, who, parent, now_ms()),
            ).lastrowid
            assert new is not None
            self._fill_samples("grasps.id = ?", (new,))
            return new

    def grasp(self, grasp_id: int) -> GraspRow:
        """One grasp with its current label.

        Raises:
            StoreError: no such grasp.
        """
        rows = self.grasp_rows("WHERE grasps.id = ?", (grasp_id,))
        if not rows:
            raise StoreError(f"{self.path}: holds no grasp with the id {grasp_id}")
        return rows[0]

    def grasp_rows(self, where: str, values: Sequence[Any]) -> list[GraspRow]:
        """Grasps with their labels, for a WHERE … ORDER BY … LIMIT clause on `grasps` and `samples`."""
        found = self.rows(
            f"""SELECT grasps.id, grasps.scene, number, x, y, z, angle, width, origin, people.name AS person, parent,
                    attempts, successes, quality, label, state, source, flagged, last_event, score, heat
                FROM samples JOIN grasps ON grasps.id = samples.grasp
                LEFT JOIN people ON people.id = grasps.person {where}""",
            values,
        )
        rows = []
        for row in map(dict, found):
            place = (row.pop("x"), row.pop("y"), row.pop("z"))
            grasp = Grasp(place, row.pop("angle"), row.pop("width"))
            rows.append(GraspRow(grasp=grasp, **{**row, "flagged": bool(row["flagged"])}))
        return rows

    def people(self) -> list[str]:
        """The names of all who labelled, in order of arrival."""
        return [row["name"] for row in self.rows("SELECT name FROM people ORDER BY id")]

    def save_view(self, name: str, query: dict, person: str | None = None) -> None:
        """Keep a list's filters and sorting under a name; the same name is replaced."""
        with self.transaction() as db:
            who = None if person is None else self.person_id(person)
            text = msgspec.json.encode(query, order="sorted").decode()
            db.execute(
                "INSERT INTO views (name, query, person, changed) VALUES (?,?,?,?) ON CONFLICT (name) DO UPDATE SET"
                " query = excluded.query, person = excluded.person, changed = excluded.changed",
                (name, text, who, now_ms()),
            )

    def views(self) -> dict[str, dict]:
        """Saved views, name → query."""
        found = self.rows("SELECT name, query FROM views ORDER BY name")
        return {row["name"]: msgspec.json.decode(row["query"]) for row in found}

    def delete_view(self, name: str) -> None:
        """Forget a saved view."""
        with self.transaction() as db:
            db.execute("DELETE FROM views WHERE name = ?", (name,))

    def add_predictions(
        self, digest: str, name: str, grasp_ids: ArrayLike, scores: ArrayLike, heats: ArrayLike | None = None
    ) -> None:
        """Keep scores of some grasps under a weights digest; those of the weights in use show in `samples` at once.

        Args:
            digest: of the weights.
            name: of the weights, for people.
            grasp_ids: (N,) ids.
            scores: (N,) P(class 1).
            heats: (N,) of the quality map, or none.
        """
        ids = np.asarray(grasp_ids, np.int64).tolist()
        values = np.asarray(scores, float).tolist()
        maps = [None] * len(ids) if heats is None else np.asarray(heats, float).tolist()
        with self.transaction() as db:
            db.execute("INSERT OR IGNORE INTO weights (digest, name, added) VALUES (?,?,?)", (digest, name, now_ms()))
            weights = db.execute("SELECT id FROM weights WHERE digest = ?", (digest,)).fetchone()[0]
            db.executemany(
                "INSERT OR REPLACE INTO predictions (weights, grasp, score, heat) VALUES (?,?,?,?)",
                zip([weights] * len(ids), ids, values, maps, strict=True),
            )
            in_use = self.row("SELECT value FROM meta WHERE key = 'weights'")
            if in_use is not None and msgspec.json.decode(in_use["value"]) == digest:
                db.executemany(
                    "UPDATE samples SET score = ?, heat = ?, gap = abs(? - quality) WHERE grasp = ?",
                    zip(values, maps, values, ids, strict=True),
                )

    def use_weights(self, digest: str) -> None:
        """Show the scores of these weights in `samples`, where lists sort and filter by them.

        Raises:
            StoreError: no scores of these weights are stored.
        """
        with self.transaction() as db:
            row = self.row("SELECT id FROM weights WHERE digest = ?", (digest,))
            if row is None:
                known = ", ".join(r["digest"] for r in self.rows("SELECT digest FROM weights ORDER BY id")) or "none"
                raise StoreError(f"{self.path}: holds no scores of the weights {digest}; it has those of: {known}")
            db.execute("UPDATE samples SET score = NULL, heat = NULL, gap = NULL WHERE score IS NOT NULL")
            db.execute(
                """UPDATE samples SET score = p.score, heat = p.heat, gap = abs(p.score - quality)
                   FROM predictions AS p WHERE p.grasp = samples.grasp AND p.weights = ?""",
                (row["id"],),
            )
            db.execute(
                "INSERT OR REPLACE INTO meta (key, value) VALUES ('weights', ?)",
                (msgspec.json.encode(digest).decode(),),
            )
