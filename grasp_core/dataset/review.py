"""Reviews: queues of samples that one person looks through, chosen by a rule, blind if wanted, with hidden samples.

A queue is stored, so that it goes on after a restart. Hidden samples are those whose outcome physics settled with many
attempts that all ended alike; an answer on them is an opinion, which leaves the label alone, and measures the person.
Second opinions are opinions, too. All other answers are decisions on the label.
"""

from __future__ import annotations

import random
from typing import Literal

import msgspec

from grasp_core import config
from grasp_core.dataset.content import now_ms
from grasp_core.dataset.labels import Kind, LabelEvent
from grasp_core.dataset.lists import Lists
from grasp_core.dataset.queries import Query, Sort
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import StoreError

Choice = Literal["disagreement", "audit", "mistakes", "opinions"]
CHOICES: dict[Choice, str] = {
    "disagreement": "where score and quality are furthest apart",
    "audit": "samples at random",
    "mistakes": "where the newest weights are furthest from the label",
    "opinions": "what others decided, for a second opinion",
}
"""Rules of a queue → what they choose, for people."""


class Rule(config.Settings):
    """Which samples a review holds.

    Attributes:
        choice: see `CHOICES`.
        size: at most so many samples, without the hidden ones.
        query: filters that samples must pass; its sorting is not used.
        measure: of disagreement.
        blind: score, quality, attempts and labels are hidden until the answer is given.
        hidden: samples of known outcome, as a share of the others.
        settled: attempts that a hidden sample has at least, all with one outcome.
        seed: of what is drawn.
    """

    choice: Choice = "disagreement"
    size: int = 100
    query: Query = Query()
    measure: Sort = "gap"
    blind: bool = False
    hidden: float = 0.1
    settled: int = 5
    seed: int = 0

    def __post_init__(self) -> None:
        if self.choice not in CHOICES:
            raise StoreError(f"a review's choice is one of: {', '.join(CHOICES)}; not '{self.choice}'")
        if self.size < 1 or not 0 <= self.hidden <= 1 or self.settled < 1:
            raise StoreError("a review has at least 1 sample, a share of hidden ones in [0, 1], settled by 1 attempt")


class Review(msgspec.Struct, frozen=True):
    """A review of one person.

    Attributes:
        id: of the review.
        person: who looks.
        rule: what it holds.
        items: how many samples, hidden ones included.
        done: answered or skipped.
    """

    id: int
    person: str
    rule: Rule
    items: int
    done: int


class Item(msgspec.Struct, frozen=True):
    """The sample that a review shows.

    Attributes:
        review: its id.
        place: in the queue, from 0.
        grasp: id of the sample.
        opinion: the answer is an opinion, not a decision (not to be shown: it would give hidden samples away).
    """

    review: int
    place: int
    grasp: int
    opinion: bool


def start_review(store: DatasetStore, person: str, rule: Rule) -> Review:
    """Choose samples by a rule and store the queue.

    Raises:
        StoreError: the rule finds no sample, or it cannot be written.
    """
    draw = random.Random(rule.seed)
    chosen = _chosen(store, person, rule, draw)
    if not chosen:
        raise StoreError(f"no sample to review: {CHOICES[rule.choice]}; loosen the filters or score the dataset first")
    hidden = _hidden(store, rule, set(chosen), round(rule.hidden * len(chosen)), draw)
    items: list[tuple[int, float | None]] = [(grasp, None) for grasp in chosen]
    for entry in hidden:
        items.insert(draw.randrange(len(items) + 1), entry)
    with store.transaction() as db:
        text = msgspec.json.encode(rule).decode()
        new = db.execute(
            "INSERT INTO reviews (person, rule, made) VALUES (?,?,?)", (store.person_id(person), text, now_ms())
        ).lastrowid
        assert new is not None
        db.executemany(
            "INSERT INTO review_items (review, place, grasp, truth) VALUES (?,?,?,?)",
            ((new, place, grasp, truth) for place, (grasp, truth) in enumerate(items)),
        )
    return review(store, new)


def _chosen(store: DatasetStore, person: str, rule: Rule, draw: random.Random) -> list[int]:
    if rule.choice in ("disagreement", "mistakes"):
        sort: Sort = "mistake" if rule.choice == "mistakes" else rule.measure
        query = msgspec.structs.replace(rule.query, sort=sort, descending=True)
        return [row.id for row in store.page(query, size=rule.size).rows]
    where, values = store.conditions(rule.query)
    if rule.choice == "opinions":
        own = "(SELECT id FROM people WHERE name = ?)"
        judged = "SELECT grasp FROM label_events WHERE source = 'human' AND kind IN ('value', 'unsure', 'opinion')"
        where += [
            "+samples.source = 'human'",
            f"samples.grasp IN ({judged} AND person <> {own})",
            f"samples.grasp NOT IN ({judged} AND person = {own})",
        ]
        values += [person, person]
    found = [
        row["grasp"] for row in store.rows(f"SELECT grasp FROM samples WHERE {' AND '.join(where) or '1'}", values)
    ]
    return draw.sample(found, min(rule.size, len(found)))


def _hidden(
    store: Lists, rule: Rule, taken: set[int], count: int, draw: random.Random
) -> list[tuple[int, float | None]]:
    """Samples of known outcome with it: half of them good, half bad where both exist."""
    where, values = store.conditions(rule.query)
    found: list[tuple[int, float | None]] = []
    for truth in (1.0, 0.0):
        settled = [*where, "samples.attempts >= ?", "samples.quality = ?", "+samples.source = 'dart'"]
        rows = store.rows(
            f"SELECT grasp FROM samples WHERE {' AND '.join(settled)} ORDER BY attempts DESC, grasp LIMIT 10000",
            [*values, rule.settled, truth],
        )
        free = [row["grasp"] for row in rows if row["grasp"] not in taken]
        wanted = count - len(found) if truth == 0 else -(-count // 2)
        found += [(grasp, truth) for grasp in draw.sample(free, min(wanted, len(free)))]
    return found


def review(store: DatasetStore, review_id: int) -> Review:
    """A stored review.

    Raises:
        StoreError: no such review.
    """
    found = _reviews(store, "reviews.id = ?", review_id)
    if not found:
        raise StoreError(f"{store.path}: holds no review {review_id}")
    return found[0]


def reviews(store: DatasetStore, person: str) -> list[Review]:
    """A person's reviews, newest first."""
    return _reviews(store, "people.name = ?", person)


def _reviews(store: DatasetStore, where: str, value: int | str) -> list[Review]:
    rows = store.rows(
        f"""SELECT reviews.id AS id, people.name AS person, rule, count(place) AS items,
                total(event IS NOT NULL OR skipped) AS done
            FROM reviews JOIN people ON people.id = reviews.person JOIN review_items ON review = reviews.id
            WHERE {where} GROUP BY reviews.id ORDER BY reviews.id DESC""",
        (value,),
    )
    return [
        Review(row["id"], row["person"], msgspec.json.decode(row["rule"], type=Rule), row["items"], int(row["done"]))
        for row in rows
    ]


def next_item(store: DatasetStore, review_id: int) -> Item | None:
    """The first sample of a review that is neither answered nor skipped; None at the end."""
    row = store.row(
        "SELECT place FROM review_items WHERE review = ? AND event IS NULL AND NOT skipped ORDER BY place LIMIT 1",
        (review_id,),
    )
    return None if row is None else item_at(store, review_id, row["place"])


def item_at(store: DatasetStore, review_id: int, place: int) -> Item:
    """The sample at a place of a review, answered or not.

    Raises:
        StoreError: no such review or place.
    """
    row = store.row("SELECT grasp, truth FROM review_items WHERE review = ? AND place = ?", (review_id, place))
    if row is None:
        raise StoreError(f"{store.path}: review {review_id} has no sample at place {place}")
    opinion = row["truth"] is not None or review(store, review_id).rule.choice == "opinions"
    return Item(review_id, place, row["grasp"], opinion)


def answer(
    store: DatasetStore, item: Item, decision: float | Kind, *, note: str = "", seen_event: int | None = None
) -> LabelEvent:
    """Answer a review's sample: a decision on its label, or an opinion where the label must stay.

    Args:
        store: the dataset, open for writing.
        item: from `next_item`.
        decision: as in `DatasetStore.add_label`.
        note: free text.
        seen_event: as in `DatasetStore.add_label`.

    Raises:
        LabelConflict: somebody decided meanwhile.
        StoreError: it cannot be written.
    """
    found = review(store, item.review)
    details: dict[str, object] = {"review": item.review, "choice": found.rule.choice, "blind": found.rule.blind}
    value = float(decision) if not isinstance(decision, str) else None
    opinion = item.opinion and (value is not None or decision in ("unsure", "exclude"))
    if opinion and value is None:
        details["opinion"] = decision
    with store.transaction() as db:
        event = store.add_label(
            item.grasp,
            found.person,
            "opinion" if opinion else decision,
            reason=f"review: {CHOICES[found.rule.choice]}",
            note=note,
            details=details,
            seen_event=None if opinion else seen_event,
            value=value,
        )
        db.execute(
            "UPDATE review_items SET event = ? WHERE review = ? AND place = ?", (event.id, item.review, item.place)
        )
    return event


def skip(store: DatasetStore, item: Item) -> None:
    """Leave a review's sample without an answer."""
    with store.transaction() as db:
        db.execute("UPDATE review_items SET skipped = 1 WHERE review = ? AND place = ?", (item.review, item.place))
