"""Filters of lists as SQL, chosen so that they stay quick with a million samples."""

from __future__ import annotations

import re
from typing import Any

from grasp_core.dataset.curation import Curation
from grasp_core.dataset.queries import RANGES, Query

FEW = 10_000
"""So many matching samples are quickly looked up one by one, in any order."""

_LIMITS = {"quality": 150_000, "label": 150_000, "spread": 150_000}
"""Columns of few values → so many samples are looked up in less time than a million are read: they come in runs of
ascending ids. So do those of an outcome."""

_LIMIT = 50_000
"""The same for other columns, whose samples have to be put in the order of their ids first."""

_COMMON = {"state": "labelled", "source": "dart"}
"""What nearly all samples are: the other values have partial indices."""

_OUTCOME_COLUMNS = {"SUCCESS": "successes", "COLLISION": "collisions", "MISSED": "missed", "SLIPPED": "slipped"}


class Filters(Curation):
    """The part of a store that turns filters into SQL."""

    def conditions(self, query: Query, *, part: bool = False) -> tuple[list[str], list[Any]]:
        """The filters of a query as SQL conditions on `samples`, and the values that they bind.

        A unary plus keeps SQLite from using an index that selects many samples: looking them up one by one would take
        longer than looking through all.

        Args:
            query: the filters; its sorting is not used.
            part: only the first samples by id are wanted, not all.
        """
        where, values, selective = self._plain(query)
        ranges = self._ranges(query, FEW if part or selective else None)
        least = min(ranges, key=lambda found: found[2], default=None)
        for found in ranges:
            condition, given, count, limit = found
            if count >= FEW and (count >= limit or found is not least):
                condition = f"+{condition}"
            elif count >= FEW and limit == _LIMIT:
                condition = f"samples.grasp IN (SELECT grasp FROM samples WHERE {condition})"
            where.append(condition)
            values.extend(given)
        return where, values

    def _ranges(self, query: Query, most: int | None) -> list[tuple[str, list[Any], int, int]]:
        """Conditions on ranges of values: what they bind, and how many samples they select, counted up to a limit.

        The limit is `most`, if given, else what can be looked up in less time than all samples are read.
        """
        asked: list[tuple[str, list[Any], int]] = []
        if query.outcome is not None:
            asked.append((f"samples.{_OUTCOME_COLUMNS[query.outcome]} > 0", [], _LIMITS["quality"]))
        for field in RANGES:
            if (bounds := getattr(query, field)) is not None:
                asked.append((f"samples.{field} BETWEEN ? AND ?", list(bounds), _LIMITS.get(field, _LIMIT)))
        found = []
        for condition, given, limit in asked:
            limit = most or limit
            row = self.row(f"SELECT count(*) FROM (SELECT 1 FROM samples WHERE {condition} LIMIT {limit})", given)
            found.append((condition, given, 0 if row is None else int(row[0]), limit))
        return found

    def _plain(self, query: Query) -> tuple[list[str], list[Any], bool]:
        """All other conditions, what they bind, and whether an index finds the few samples that one of them selects."""
        where: list[str] = []
        values: list[Any] = []
        selective = False

        def add(condition: str, *given: Any) -> None:
            nonlocal selective
            where.append(condition)
            values.extend(given)
            selective = selective or not condition.startswith("+")

        for field in ("state", "source"):
            if (value := getattr(query, field)) is not None:
                # checked by the settings type; written out because partial indices do not see bound values
                add(
                    f"samples.{field} = '{value}' AND samples.{field} <> '{_COMMON[field]}'"
                    if value != _COMMON[field]
                    else f"+samples.{field} = '{value}'"
                )
        for field, value in (("category", query.category), ("name", query.object)):
            if value is not None:
                ids = [str(row["id"]) for row in self.rows(f"SELECT id FROM objects WHERE {field} = ?", (value,))]
                add(f"samples.object IN ({','.join(ids)})")
        if query.scene is not None:
            add("samples.scene = (SELECT id FROM scenes WHERE name = ?)", query.scene)
        if query.flagged is not None:
            add("samples.flagged = 1" if query.flagged else "+samples.flagged = 0")
        if query.person is not None:
            add(
                "samples.grasp IN (SELECT grasp FROM label_events WHERE person ="
                " (SELECT id FROM people WHERE name = ?))",
                query.person,
            )
        if query.origin is not None:
            made = "SELECT id FROM grasps WHERE origin <> 'grid'"  # few, with an index of their own
            add(
                f"+samples.grasp NOT IN ({made})"
                if query.origin == "grid"
                else f"samples.grasp IN ({made} AND origin = '{query.origin}')"
            )
        if query.text is not None and (words := re.findall(r"\w+", query.text)):
            add(
                "samples.grasp IN (SELECT grasp FROM label_events WHERE id IN (SELECT rowid FROM notes WHERE notes"
                " MATCH ?))",
                " ".join(f'"{word}"' for word in words) + "*",
            )
        if query.split is not None:
            # the samples of a split come in long runs of ids, so that its index is quick, too
            where.append("samples.split = ?")
            values.append(query.split)
        return where, values, selective
