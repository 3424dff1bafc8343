"""Lists of samples: filters, sorting and pages that stay quick with a million of them.

Pages are by key, not by offset: a page starts behind the last row of the one before. All matching samples are read and
sorted where they are few. Where they are many, the page is found by walking the sorted index until it is full. Where
filters and sorting work against each other, so that the walk gets long, the reading goes on to the end after all.
"""

from __future__ import annotations

from typing import Any

import msgspec

from grasp_core.dataset.filters import FEW, Filters
from grasp_core.dataset.queries import Query
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


_WALK = 2_000
"""Entries of a sorted index that are walked for a page before the other samples are read instead."""

_SURE_WALK = 40_000
"""So many are walked where they are known to fill the page; walking more takes longer than reading everything."""

_SORT_COLUMNS = {"id": "grasp", "changed": "last_event"}
"""Sorts whose column is called otherwise."""


class _Selection:
    """What a page is taken from, in SQL.

    Attributes:
        where: the filters, 1 where there are none.
        values: that they bind.
        name: of the column that is sorted by.
        way: of sorting.
        beyond: compares what comes later with what comes earlier.
        after: the last key of the page before.
        most: keys that are wanted.
    """

    def __init__(self, query: Query, where: list[str], values: list[Any], after: Key | None, most: int) -> None:
        self.where = " AND ".join(where) or "1"
        self.values = values
        self.name = _SORT_COLUMNS.get(query.sort, query.sort)
        self.way, self.beyond = ("DESC", "<") if query.descending else ("ASC", ">")
        self.after = after
        self.most = most

    def along_index(self, columns: str, values: list[Any], until: float | None = None) -> tuple[str, list[Any]]:
        """A query along the sorted index from where the page begins, and all that it binds.

        Args:
            columns: to select.
            values: that they bind.
            until: the last value to go to.
        """
        parts: list[tuple[str, list[Any]]] = [(f"{self.name} IS NOT NULL", [])]
        if self.after is not None:  # one comparison of pairs would go along all samples of equal value
            value, grasp = self.after
            equal, later = f"{self.name} = ? AND grasp {self.beyond} ?", f"{self.name} {self.beyond} ?"
            parts = [(equal, [value, grasp]), (later, [value])]
        if until is not None:
            parts = [(f"{part} AND ? {self.beyond}= {self.name}", [*given, until]) for part, given in parts]
        begin = f"SELECT {columns} FROM samples INDEXED BY samples_{self.name} WHERE"
        bound = [value for _, given in parts for value in (*values, *given)]
        return " UNION ALL ".join(f"{begin} {part}" for part, _ in parts), bound


class Lists(Filters):
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
        where, values = self.conditions(query, part=True)
        chosen = _Selection(query, where, values, after, size + 1)
        total, last, keys = self._first(chosen) if where else (None, 0, [])
        if total is None:
            if query.sort == "id":
                keys = self._next(chosen)
            else:
                walked = self._walk(chosen, self._steps(chosen, keys) if where else size + 1)
                if walked is None:
                    chosen = _Selection(query, *self.conditions(query), after, size + 1)
                    walked = self._all(chosen, keys, last)
                keys = walked
        ids = [grasp for _, grasp in keys[:size]]
        found = {row.id: row for row in self.grasp_rows(f"WHERE grasps.id IN ({','.join('?' * len(ids))})", ids)}
        rest = (float(keys[size - 1][0]), ids[-1]) if len(keys) > size else None
        return Page([found[grasp] for grasp in ids], rest, total)

    def _keys(self, sql: str, values: list[Any]) -> list[Key]:
        return [(row[0], row[1]) for row in self.rows(sql, values)]

    def _first(self, chosen: _Selection) -> tuple[int | None, int, list[Key]]:
        """Look at the first `FEW` samples by id that the filters select.

        Returns:
            How many they are, None where there are more; the id of the last one; the first keys of the page among them.
        """
        way, highest = chosen.way, "min" if chosen.way == "DESC" else "max"
        behind, given = ("1", []) if chosen.after is None else (f"(value, grasp) {chosen.beyond} (?, ?)", chosen.after)
        found = self.rows(
            f"""WITH first AS MATERIALIZED (SELECT samples.{chosen.name} AS value, grasp FROM samples
                    WHERE {chosen.where} ORDER BY samples.grasp {way} LIMIT {FEW}),
                shown AS (SELECT value, grasp FROM first WHERE value IS NOT NULL AND {behind}
                    ORDER BY value {way}, grasp {way} LIMIT {chosen.most})
                SELECT NULL AS value, count(*) AS grasp, ifnull({highest}(grasp), 0) AS last FROM first
                UNION ALL SELECT value, grasp, NULL FROM shown""",
            [*chosen.values, *given],
        )
        count, last = next((row["grasp"], row["last"]) for row in found if row["value"] is None)
        keys = [(row["value"], row["grasp"]) for row in found if row["value"] is not None]
        return count if count < FEW else None, last, sorted(keys, reverse=way == "DESC")

    def _next(self, chosen: _Selection) -> list[Key]:
        """The keys of a list that is sorted by id."""
        behind, given = ("", []) if chosen.after is None else (f"AND grasp {chosen.beyond} ?", [chosen.after[1]])
        rows = f"FROM samples WHERE {chosen.where} {behind} ORDER BY grasp {chosen.way} LIMIT {chosen.most}"
        return self._keys(f"SELECT grasp, grasp {rows}", [*chosen.values, *given])

    def _steps(self, chosen: _Selection, known: list[Key]) -> int:
        """How far to walk along the sorted index: to the last of a full page of known keys where that is not far."""
        if len(known) < chosen.most:
            return _WALK
        sql, given = chosen.along_index("1", [], known[-1][0])
        steps = self.rows(f"SELECT count(*) FROM ({sql} LIMIT {_SURE_WALK + 1})", given)[0][0]
        return int(steps) if steps <= _SURE_WALK else _WALK

    def _walk(self, chosen: _Selection, steps: int) -> list[Key] | None:
        """The keys of a list along its sorted index, or None where more than `steps` would be needed."""
        sql, given = chosen.along_index(f"{chosen.name}, grasp, {chosen.where}", chosen.values)
        keys: list[Key] = []
        left = steps
        for value, grasp, passes in self.each(f"{sql} ORDER BY 1 {chosen.way}, 2 {chosen.way} LIMIT {steps}", given):
            left -= 1
            if passes:
                keys.append((value, grasp))
                if len(keys) == chosen.most:
                    return keys
        return keys if left else None

    def _all(self, chosen: _Selection, known: list[Key], last: int) -> list[Key]:
        """The keys of a list of which those up to the id `last` are known, by reading all others.

        Only what sorts before the last of the known keys can still be shown: so hardly anything has to be sorted.
        """
        column, way, beyond = f"+samples.{chosen.name}", chosen.way, chosen.beyond
        limits = [f"samples.grasp {beyond} ?", f"{column} IS NOT NULL"]
        given: list[float] = [last]
        if chosen.after is not None:
            limits.append(f"({column}, samples.grasp) {beyond} (?, ?)")
            given += chosen.after
        if len(known) == chosen.most:
            limits.append(f"(?, ?) {beyond} ({column}, samples.grasp)")
            given += known[-1]
        rows = f"FROM samples WHERE {' AND '.join([chosen.where, *limits])} ORDER BY 1 {way}, 2 {way}"
        others = self._keys(f"SELECT {column}, samples.grasp {rows} LIMIT {chosen.most}", [*chosen.values, *given])
        return sorted([*known, *others], reverse=way == "DESC")

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
