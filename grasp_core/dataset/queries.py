"""Lists of samples: filters, sorting and pages that stay quick with a million of them.

Pages are by key, not by offset: a page starts behind the last row of the one before, so that every page costs the same.
"""

from __future__ import annotations

import re
from typing import Any, Literal

import msgspec

from grasp_core import config
from grasp_core.dataset.curation import Curation
from grasp_core.dataset.rows import SPLITS, GraspRow, Split
from grasp_core.errors import StoreError

Sort = Literal["id", "quality", "label", "score", "heat", "gap", "spread", "changed"]

_COLUMNS: dict[str, str] = {
    "id": "samples.grasp",
    "quality": "samples.quality",
    "label": "samples.label",
    "score": "samples.score",
    "heat": "samples.heat",
    "gap": "samples.gap",
    "spread": "(samples.quality * (1 - samples.quality))",
    "changed": "samples.last_event",
}


_CHOICES: dict[str, tuple[str | None, ...]] = {
    "split": (None, *SPLITS),
    "outcome": (None, "SUCCESS", "COLLISION", "MISSED", "SLIPPED"),
    "state": (None, "labelled", "unlabelled", "unsure", "excluded"),
    "source": (None, "none", "dart", "human"),
    "origin": (None, "grid", "person", "planner", "import"),
    "sort": tuple(_COLUMNS),
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
        state: of the label.
        source: of the label.
        flagged: marked or not.
        person: has an event of this person.
        origin: who made the grasp.
        text: words that a note of the sample holds; the last one may be incomplete.
        sort: by what; "gap" is |score − quality|, "spread" the disagreement between the attempts, "changed" the newest
            label event. Rows without the value are left out.
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

_FEW = 20_000
"""So many rows are sorted quicker than they are found by walking a sorted index of a million."""

_OUTCOME_COLUMNS = {"SUCCESS": "successes", "COLLISION": "collisions", "MISSED": "missed", "SLIPPED": "slipped"}


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
        where, values = self._where(query)
        column = _COLUMNS[query.sort]
        if query.sort != "id" and self._rare(query):
            column = f"+{column}"
        way, beyond = ("DESC", "<") if query.descending else ("ASC", ">")
        if query.sort != "id":
            where.append(f"{column} IS NOT NULL")
        if after is not None:
            key, last = after
            if query.sort == "id":
                where.append(f"samples.grasp {beyond} ?")
                values.append(last)
            else:
                where.append(f"({column}, samples.grasp) {beyond} (?, ?)")
                values += [key, last]
        clause = f"WHERE {' AND '.join(where) or '1'} ORDER BY {column} {way}, samples.grasp {way} LIMIT ?"
        keys = self.rows(f"SELECT samples.grasp, {column} AS key FROM samples {clause}", [*values, size + 1])
        shown = [int(row["grasp"]) for row in keys[:size]]
        found = {row.id: row for row in self.grasp_rows(f"WHERE grasps.id IN ({','.join('?' * len(shown))})", shown)}
        rest = (float(keys[size - 1]["key"]), shown[-1]) if len(keys) > size else None
        return Page([found[grasp] for grasp in shown], rest)

    def count(self, query: Query) -> int:
        """How many samples a query selects (its sorting leaves none out)."""
        where, values = self._where(query)
        row = self.row(f"SELECT count(*) FROM samples WHERE {' AND '.join(where) or '1'}", values)
        return 0 if row is None else int(row[0])

    def ids(self, query: Query) -> list[int]:
        """The ids of all samples that a query selects, for bulk actions."""
        where, values = self._where(query)
        found = self.rows(f"SELECT grasp FROM samples WHERE {' AND '.join(where) or '1'} ORDER BY grasp", values)
        return [int(row["grasp"]) for row in found]

    def _rare(self, query: Query) -> bool:
        """Whether a filter with an index of its own leaves so few rows that sorting them is the quick way."""
        common = (query.state in (None, "labelled"), query.source in (None, "dart"), query.flagged is not True)
        if all(common):
            return False
        where, values = self._where(query)
        row = self.row(f"SELECT count(*) FROM (SELECT 1 FROM samples WHERE {' AND '.join(where)} LIMIT {_FEW})", values)
        return row is not None and row[0] < _FEW

    def _where(self, query: Query) -> tuple[list[str], list[Any]]:
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
        for field in ("quality", "label", "score"):
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
