"""Lists of samples: filters, sorting and pages that stay quick with a million of them.

Pages are by key, not by offset: a page starts behind the last row of the one before. Three ways lead to a page. Few
matching samples are read whole and sorted. Many are found by walking the sorted index until the page is full. Where the
filters and the sorting work against each other, so that the walk gets long, all samples are looked through once.
"""

from __future__ import annotations

import re
from typing import Any

import msgspec

from grasp_core.dataset.curation import Curation
from grasp_core.dataset.queries import RANGES, Query
from grasp_core.dataset.rows import GraspRow
from grasp_core.errors import StoreError

Key = tuple[float, int]
"""What a page is sorted by, and the id of the grasp."""


class Page(msgspec.Struct, frozen=True):
    """One page of a list.

    Attributes:
        rows: the samples.
        after: hand it to the next call for the next page; None when this is the last.
        total: samples that the filters select, those without a value to sort by included; None where there are too
            many to count on the way, see `Lists.count`.
    """

    rows: list[GraspRow]
    after: Key | None
    total: int | None


_COMMON = {"state": "labelled", "source": "dart"}
"""What nearly all samples are: the other values have partial indices."""

_FEW = 10_000
"""So many matching samples are read whole; of a million, more are dense enough to walk an index."""

_WALK = 10_000
"""Entries of a sorted index that are walked for a page before all samples are looked through instead."""

_OUTCOME_COLUMNS = {"SUCCESS": "successes", "COLLISION": "collisions", "MISSED": "missed", "SLIPPED": "slipped"}
_NOT_BEYOND = str.maketrans("<>", "><")
_SORT_COLUMNS = {"id": "grasp", "changed": "last_event"}
"""Sorts whose column is called otherwise."""


class Lists(Curation):
    """The part of a store that lists samples."""

    def page(self, query: Query, *, size: int = 50, after: Key | None = None) -> Page:
        """One page of the samples that a query selects.

        Args:
            query: filters and sorting.
            size: rows a page.
            after: `Page.after` of the page before, None for the first page.

        Raises:
            StoreError: the page size is below 1.
        """
        if size < 1:
            raise StoreError(f"a page has at least 1 row, not {size}")
        where, values = self.conditions(query)
        column = "samples." + _SORT_COLUMNS.get(query.sort, query.sort)
        total = None
        keys = self._few(query, column, where, values) if where else None
        if keys is not None:
            total = len(keys)
            keys = [key for key in keys if key[0] is not None]
            if after is not None:
                keys = [key for key in keys if (key < after if query.descending else key > after)]
            keys.sort(reverse=query.descending)
        else:
            keys = self._many(query, column, where, values, size + 1, after)
        shown = [grasp for _, grasp in keys[:size]]
        found = {row.id: row for row in self.grasp_rows(f"WHERE grasps.id IN ({','.join('?' * len(shown))})", shown)}
        rest = (float(keys[size - 1][0]), shown[-1]) if len(keys) > size else None
        return Page([found[grasp] for grasp in shown], rest, total)

    def _few(self, query: Query, column: str, where: list[str], values: list[Any]) -> list[Key] | None:
        """The keys of all samples that the filters select, in any order, or None where they are many."""
        clause = f"WHERE {' AND '.join(where)} LIMIT {_FEW}"
        found = self.rows(f"SELECT {column}, samples.grasp FROM samples {clause}", values)
        return [(row[0], row[1]) for row in found] if len(found) < _FEW else None

    def _many(
        self, query: Query, column: str, where: list[str], values: list[Any], most: int, after: Key | None
    ) -> list[Key]:
        """The first `most` keys behind `after`."""
        way, beyond = ("DESC", "<") if query.descending else ("ASC", ">")
        given = [] if after is None else list(after)

        def select(table: str, key: str, filters: list[str], limit: str) -> str:
            behind = [] if after is None else [f"({key}, samples.grasp) {beyond} (?, ?)"]
            rows = f"FROM samples {table} WHERE {' AND '.join([*filters, f'{key} IS NOT NULL', *behind])}"
            return f"SELECT {key}, samples.grasp {rows} ORDER BY {key} {way}, samples.grasp {way} LIMIT {limit}"

        if query.sort == "id":
            found = self.rows(select("NOT INDEXED", column, where, f"{most}"), [*values, *given])
        else:
            index = f"INDEXED BY samples_{_SORT_COLUMNS.get(query.sort, query.sort)}"
            end = self.row(select(index, column, [], f"1 OFFSET {_WALK}"), given) if where else None
            until = [] if end is None else [f"({column}, samples.grasp) {beyond.translate(_NOT_BEYOND)}= (?, ?)"]
            found = self.rows(select(index, column, [*where, *until], f"{most}"), [*values, *(end or ()), *given])
            if end is not None and len(found) < most:
                found = self.rows(select("", f"+{column}", where, f"{most}"), [*values, *given])
        return [(row[0], row[1]) for row in found]

    def count(self, query: Query, *, most: int | None = None) -> int:
        """How many samples a query selects (its sorting leaves none out); with `most`, counting ends there."""
        where, values = self.conditions(query)
        inner = f"SELECT 1 FROM samples WHERE {' AND '.join(where) or '1'}"
        row = self.row(f"SELECT count(*) FROM ({inner} LIMIT ?)", [*values, -1 if most is None else most])
        return 0 if row is None else int(row[0])

    def ids(self, query: Query) -> list[int]:
        """The ids of all samples that a query selects, for bulk actions."""
        where, values = self.conditions(query)
        found = self.rows(f"SELECT grasp FROM samples WHERE {' AND '.join(where) or '1'} ORDER BY grasp", values)
        return [int(row["grasp"]) for row in found]

    def conditions(self, query: Query) -> tuple[list[str], list[Any]]:
        """The filters of a query as SQL conditions on `samples`, and the values that they bind.

        A unary plus keeps SQLite from using an index that selects many samples: looking them up one by one would take
        longer than looking through all.
        """
        where: list[str] = []
        values: list[Any] = []

        def add(condition: str, *given: Any) -> None:
            where.append(condition)
            values.extend(given)

        def add_range(condition: str, *given: Any) -> None:
            inner = f"SELECT 1 FROM samples WHERE {condition} LIMIT {_FEW}"
            found = self.row(f"SELECT count(*) FROM ({inner})", given)
            add(condition if found is not None and found[0] < _FEW else f"+{condition}", *given)

        if query.split is not None:
            add("+samples.split = ?", query.split)
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
                add(f"samples.object IN (SELECT id FROM objects WHERE {field} = ?)", value)
        if query.scene is not None:
            add("samples.scene = (SELECT id FROM scenes WHERE name = ?)", query.scene)
        if query.outcome is not None:
            add_range(f"samples.{_OUTCOME_COLUMNS[query.outcome]} > 0")
        for field in RANGES:
            if (bounds := getattr(query, field)) is not None:
                add_range(f"samples.{field} BETWEEN ? AND ?", *bounds)
        if query.flagged is not None:
            add("samples.flagged = 1" if query.flagged else "+samples.flagged = 0")
        if query.person is not None:
            add(
                "samples.grasp IN (SELECT grasp FROM label_events WHERE person ="
                " (SELECT id FROM people WHERE name = ?))",
                query.person,
            )
        if query.origin is not None:
            rare = "" if query.origin == "grid" else " AND origin <> 'grid'"
            add(f"samples.grasp IN (SELECT id FROM grasps WHERE origin = '{query.origin}'{rare})")
        if query.text is not None:
            words = re.findall(r"\w+", query.text)
            if words:
                match = " ".join(f'"{word}"' for word in words) + "*"
                add(
                    "samples.grasp IN (SELECT grasp FROM label_events WHERE id IN (SELECT rowid FROM notes WHERE notes"
                    " MATCH ?))",
                    match,
                )
        return where, values
