"""Lists of samples: filters, sorting and pages that stay quick with a million of them.

Pages are by key, not by offset: a page starts behind the last row of the one before, so that every page costs the same.
"""

from __future__ import annotations

import re
from typing import Any, Literal, get_args

import msgspec

from grasp_core import config
from grasp_core.dataset.curation import Curation
from grasp_core.dataset.rows import SPLITS, GraspRow, Split
from grasp_core.errors import StoreError

Sort = Literal["id", "quality", "label", "score", "heat", "gap", "mistake", "networks", "dissent", "spread", "changed"]

RANGES = ("quality", "label", "score", "gap", "mistake", "networks", "dissent", "spread")
"""Filters that take a lowest and a highest value, inclusive; each has its column and index in `samples`."""


_CHOICES: dict[str, tuple[str | None, ...]] = {
    "split": (None, *SPLITS),
    "outcome": (None, "SUCCESS", "COLLISION", "MISSED", "SLIPPED"),
    "state": (None, "labelled", "unlabelled", "unsure", "excluded"),
    "source": (None, "none", "dart", "human"),
    "origin": (None, "grid", "person", "planner", "import"),
    "sort": get_args(Sort),
}


class Query(config.Settings):
    """Which samples a list shows, and in which order; None means that the filter is off.

    Attributes:
        split: of the object.
        category: of the object.
        object: its name.
        scene: its name.
        outcome: at least one attempt ended so.
        quality: lowest and highest quality, inclusive.
        label: lowest and highest label.
        score: lowest and highest score of the weights in use.
        gap: |score − quality|, lowest and highest, as are the following ones.
        mistake: |score − label|.
        networks: |heat − score|, the Regression against the Refined Network.
        dissent: |label − quality| where a person set the label: human against DART.
        spread: quality · (1 − quality), the variance of the attempts.
        state: of the label.
        source: of the label.
        flagged: marked or not.
        person: has an event of this person.
        origin: who made the grasp.
        text: words that a note of the sample holds; the last one may be incomplete.
        sort: by one of these, by heat, or by "changed", the newest label event. Rows without the value are left out.
        descending: highest first.
    """

    split: Split | None = None
    category: str | None = None
    object: str | None = None
    scene: str | None = None
    outcome: Literal["SUCCESS", "COLLISION", "MISSED", "SLIPPED"] | None = None
    quality: tuple[float, float] | None = None
    label: tuple[float, float] | None = None
    score: tuple[float, float] | None = None
    gap: tuple[float, float] | None = None
    mistake: tuple[float, float] | None = None
    networks: tuple[float, float] | None = None
    dissent: tuple[float, float] | None = None
    spread: tuple[float, float] | None = None
    state: Literal["labelled", "unlabelled", "unsure", "excluded"] | None = None
    source: Literal["none", "dart", "human"] | None = None
    flagged: bool | None = None
    person: str | None = None
    origin: Literal["grid", "person", "planner", "import"] | None = None
    text: str | None = None
    sort: Sort = "id"
    descending: bool = False

    def __post_init__(self) -> None:
        for field, choices in _CHOICES.items():
            if getattr(self, field) not in choices:
                valid = ", ".join(str(choice) for choice in choices if choice is not None)
                raise StoreError(f"a list's {field} is one of: {valid}; not '{getattr(self, field)}'")


class Page(msgspec.Struct, frozen=True):
    """One page of a list.

    Attributes:
        rows: the samples.
        after: hand it to the next call for the next page; None when this is the last.
    """

    rows: list[GraspRow]
    after: tuple[float, int] | None


_COMMON = {"state": "labelled", "source": "dart"}
"""What nearly all samples are: the other values have partial indices."""

_FEW = 5_000
"""So many rows are sorted quicker than they are found by walking a sorted index of a million."""

_OUTCOME_COLUMNS = {"SUCCESS": "successes", "COLLISION": "collisions", "MISSED": "missed", "SLIPPED": "slipped"}


_SORT_COLUMNS = {"id": "grasp", "changed": "last_event"}
"""Sorts whose column is called otherwise."""


def _index(column: str) -> str:
    return column.replace(".", "_")


class Lists(Curation):
    """The part of a store that lists samples."""

    def page(self, query: Query, *, size: int = 50, after: tuple[float, int] | None = None) -> Page:
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
        few = bool(where) and self.count(query, most=_FEW) < _FEW
        column = "samples." + _SORT_COLUMNS.get(query.sort, query.sort)
        table = (
            "samples" if few else f"samples {'NOT INDEXED' if query.sort == 'id' else f'INDEXED BY {_index(column)}'}"
        )
        if query.sort != "id":
            where.append(f"{column} IS NOT NULL")
        key = f"+{column}" if few else column
        way, beyond = ("DESC", "<") if query.descending else ("ASC", ">")
        if after is not None:
            where.append(f"({key}, samples.grasp) {beyond} (?, ?)")
            values += after
        clause = f"WHERE {' AND '.join(where) or '1'} ORDER BY {key} {way}, samples.grasp {way} LIMIT ?"
        keys = self.rows(f"SELECT samples.grasp, {column} AS key FROM {table} {clause}", [*values, size + 1])
        shown = [int(row["grasp"]) for row in keys[:size]]
        found = {row.id: row for row in self.grasp_rows(f"WHERE grasps.id IN ({','.join('?' * len(shown))})", shown)}
        rest = (float(keys[size - 1]["key"]), shown[-1]) if len(keys) > size else None
        return Page([found[grasp] for grasp in shown], rest)

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
        """The filters of a query as SQL conditions on `samples`, and the values that they bind."""
        where: list[str] = []
        values: list[Any] = []

        def add(condition: str, *given: Any) -> None:
            where.append(condition)
            values.extend(given)

        if query.split is not None:
            add("samples.split = ?", query.split)
        for field in ("state", "source"):
            if (value := getattr(query, field)) is not None:
                # checked by the settings type; written out because partial indices do not see bound values
                add(
                    f"samples.{field} = '{value}' AND samples.{field} <> '{_COMMON[field]}'"
                    if value != _COMMON[field]
                    else f"samples.{field} = '{value}'"
                )
        for field in ("category", "name"):
            value = query.category if field == "category" else query.object
            if value is not None:
                add(f"samples.object IN (SELECT id FROM objects WHERE {field} = ?)", value)
        if query.scene is not None:
            add("samples.scene = (SELECT id FROM scenes WHERE name = ?)", query.scene)
        if query.outcome is not None:
            add(f"samples.{_OUTCOME_COLUMNS[query.outcome]} > 0")
        for field in RANGES:
            if (bounds := getattr(query, field)) is not None:
                add(f"samples.{field} BETWEEN ? AND ?", *bounds)
        if query.flagged is not None:
            add("samples.flagged = 1" if query.flagged else "samples.flagged = 0")
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
