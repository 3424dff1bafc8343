"""Grasps and attempts of a dataset, and `samples`, the materialised row that each grasp has for lists and training."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence

import msgspec
import numpy as np
from numpy.typing import NDArray

from grasp_core.dataset.database import Database
from grasp_core.dataset.rows import AttemptRow, GraspTable

_ATTEMPT_COLUMNS = "number, outcome, seed, x, y, z, angle, dynamic, redraws, comfort_m, comfort_rad, evidence"


class GraspTables(Database):
    """The part of a store that holds grasps and attempts."""

    def grasps(self, scene_id: int) -> GraspTable:
        """All grasps of a scene with counts and current labels, as arrays."""
        names = "id, number, x, y, z, angle, width, attempts, successes, collisions, missed, slipped, quality, label"
        query = f"""SELECT {names}, source = 'human', score, heat FROM grasps JOIN samples ON samples.grasp = grasps.id
                    WHERE grasps.scene = ? ORDER BY number"""
        found = self.rows(query, (scene_id,))
        columns: list[tuple] = list(zip(*found, strict=True)) if found else [()] * 17

        def whole(index: int) -> NDArray[np.int64]:
            return np.array(columns[index], np.int64)

        def real(index: int) -> NDArray[np.float64]:
            return np.array(columns[index], dtype=float)  # NULL becomes NaN

        return GraspTable(
            id=whole(0),
            number=whole(1),
            position=np.stack([real(2), real(3), real(4)], axis=-1),
            angle=real(5),
            width=real(6),
            attempts=whole(7),
            successes=whole(8),
            collisions=whole(9),
            missed=whole(10),
            slipped=whole(11),
            quality=real(12),
            label=real(13),
            human=whole(14).astype(bool),
            score=real(15),
            heat=real(16),
        )

    def attempts(self, grasp_id: int) -> list[AttemptRow]:
        """All attempts of a grasp, in order."""
        query = f"SELECT {_ATTEMPT_COLUMNS}, event FROM attempts WHERE grasp = ? ORDER BY number"
        return [
            AttemptRow(
                row["outcome"],
                row["seed"],
                (row["x"], row["y"], row["z"], row["angle"]),
                bool(row["dynamic"]),
                row["redraws"],
                None if row["comfort_m"] is None else (row["comfort_m"], row["comfort_rad"]),
                row["evidence"],
                row["event"],
            )
            for row in self.rows(query, (grasp_id,))
        ]

    def _insert_attempts(self, grasp: int, first: int, attempts: Iterable[AttemptRow]) -> None:
        self._db.executemany(
            f"INSERT INTO attempts (grasp, {_ATTEMPT_COLUMNS}, event) VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?)",
            (
                (
                    grasp,
                    first + number,
                    row.outcome,
                    row.seed,
                    *row.executed,
                    int(row.dynamic),
                    row.redraws,
                    *(row.comfort or (None, None)),
                    row.evidence,
                    row.event,
                )
                for number, row in enumerate(attempts)
            ),
        )

    def _fill_samples(self, where: str, values: Sequence[object]) -> None:
        """Make the rows of `samples` that attempts alone decide; label events are applied by the curation part."""
        self._db.execute(
            f"""INSERT OR REPLACE INTO samples (grasp, scene, object, split, attempts, successes, collisions, missed,
                    slipped, quality, label, state, source)
                SELECT id, scene, object, split, n, good, collisions, missed, slipped,
                    CAST(good AS REAL) / nullif(n, 0), CAST(good AS REAL) / nullif(n, 0),
                    iif(n > 0, 'labelled', 'unlabelled'), iif(n > 0, 'dart', 'none')
                FROM (SELECT grasps.id AS id, grasps.scene AS scene, scenes.object AS object, scenes.split AS split,
                    count(outcome) - coalesce(sum(outcome = 'UNSTABLE'), 0) AS n,
                    coalesce(sum(outcome = 'SUCCESS'), 0) AS good,
                    coalesce(sum(outcome = 'COLLISION'), 0) AS collisions,
                    coalesce(sum(outcome = 'MISSED'), 0) AS missed,
                    coalesce(sum(outcome = 'SLIPPED'), 0) AS slipped
                    FROM grasps JOIN scenes ON scenes.id = grasps.scene
                    LEFT JOIN attempts ON attempts.grasp = grasps.id
                    WHERE {where} GROUP BY grasps.id)""",
            values,
        )

    def scene_digest(self, scene_id: int) -> str:
        """A hash of all that was made with a scene: independent of ids, times and the order of insertion.

        What people added later (their grasps, attempts and labels) is no part of it.
        """
        head = self.rows(
            """SELECT scenes.name, objects.name, objects.digest, scenes.split, scenes.pose, seed, settings, pixels
               FROM scenes JOIN objects ON objects.id = scenes.object JOIN cameras ON cameras.id = scenes.camera
               WHERE scenes.id = ?""",
            (scene_id,),
        )
        placed = self.rows(
            """SELECT slot, objects.digest, pose FROM placements JOIN objects ON objects.id = placements.object
               WHERE scene = ? ORDER BY slot""",
            (scene_id,),
        )
        grasps = self.rows(
            "SELECT number, x, y, z, angle, width FROM grasps WHERE scene = ? AND origin = 'grid' ORDER BY number",
            (scene_id,),
        )
        columns = ", ".join(f"attempts.{name}" for name in _ATTEMPT_COLUMNS.split(", "))
        attempts = self.rows(
            f"""SELECT grasps.number, {columns} FROM grasps JOIN attempts ON attempts.grasp = grasps.id
                WHERE scene = ? AND origin = 'grid' AND event IS NULL ORDER BY grasps.number, attempts.number""",
            (scene_id,),
        )
        value = [[tuple(row) for row in table] for table in (head, placed, grasps, attempts)]
        return hashlib.sha256(msgspec.json.encode(value)).hexdigest()
