"""How well people agree with each other (Cohen's kappa) and with samples of known outcome."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Mapping
from itertools import combinations
from typing import Literal

import msgspec

from grasp_core.dataset.store import DatasetStore
from grasp_core.rates import wilson

Verdict = Literal["good", "bad", "unsure"]

GOOD = 0.5
"""Values from here on are called good."""


class Agreement(msgspec.Struct, frozen=True):
    """Two people on the samples that both judged.

    Attributes:
        people: their names.
        samples: that both judged.
        agreed: share of them with the same verdict.
        kappa: agreement beyond chance (J. Cohen, 1960): 1 is full, 0 what chance gives; None where chance alone agrees
            fully, or there is no common sample.
    """

    people: tuple[str, str]
    samples: int
    agreed: float | None
    kappa: float | None


class Accuracy(msgspec.Struct, frozen=True):
    """A person on hidden samples of known outcome.

    Attributes:
        person: the name.
        samples: answered, those called unsure left out.
        right: of them.
        unsure: answered with unsure.
        low: lower end of the 95 % Wilson interval of right / samples.
        high: its upper end.
    """

    person: str
    samples: int
    right: int
    unsure: int
    low: float
    high: float


def verdict(value: float | None) -> Verdict:
    """What a value says in one word; None is unsure."""
    return "unsure" if value is None else "good" if value >= GOOD else "bad"


def verdicts(store: DatasetStore) -> dict[str, dict[int, Verdict]]:
    """Person → sample → their newest standing verdict, decisions and opinions alike; exclusions are none."""
    reverted: set[int] = set()
    rows = store.rows(
        "SELECT e.id, e.grasp, e.kind, e.value, e.reverts, people.name AS person FROM label_events AS e"
        " JOIN people ON people.id = e.person WHERE e.source = 'human' ORDER BY e.id"
    )
    for row in reversed(rows):  # an event is reverted by later ones only
        if row["reverts"] is not None and row["id"] not in reverted:
            reverted.add(row["reverts"])
    found: dict[str, dict[int, Verdict]] = defaultdict(dict)
    for row in rows:
        if row["kind"] in ("value", "unsure", "opinion") and row["id"] not in reverted:
            found[row["person"]][row["grasp"]] = verdict(row["value"])
    return dict(found)


def cohens_kappa(first: Mapping[int, Verdict], second: Mapping[int, Verdict]) -> tuple[int, float | None, float | None]:
    """Two people's verdicts → number of common samples, share with the same verdict, and kappa."""
    common = first.keys() & second.keys()
    n = len(common)
    if n == 0:
        return 0, None, None
    agreed = sum(first[grasp] == second[grasp] for grasp in common) / n
    ours, theirs = (Counter(person[grasp] for grasp in common) for person in (first, second))
    chance = sum(ours[name] * theirs[name] for name in ours) / n**2
    return n, agreed, None if chance == 1 else (agreed - chance) / (1 - chance)


def agreements(store: DatasetStore) -> list[Agreement]:
    """Every pair of people with at least one common sample."""
    found = verdicts(store)
    pairs = [(pair, cohens_kappa(found[pair[0]], found[pair[1]])) for pair in combinations(sorted(found), 2)]
    return [Agreement(pair, *values) for pair, values in pairs if values[0]]


def accuracies(store: DatasetStore) -> list[Accuracy]:
    """Every person who answered hidden samples; answers that were reverted do not count."""
    rows = store.rows(
        """SELECT people.name AS person, truth, value FROM review_items
           JOIN reviews ON reviews.id = review JOIN people ON people.id = reviews.person
           JOIN label_events AS e ON e.id = review_items.event
           WHERE truth IS NOT NULL AND kind = 'opinion' AND NOT EXISTS
               (SELECT 1 FROM label_events AS r WHERE r.grasp = e.grasp AND r.reverts = e.id)
           ORDER BY people.name"""
    )
    answers: dict[str, list[tuple[Verdict, Verdict]]] = defaultdict(list)
    for row in rows:
        answers[row["person"]].append((verdict(row["value"]), verdict(row["truth"])))
    found = []
    for person, given in answers.items():
        sure = [(said, truth) for said, truth in given if said != "unsure"]
        right = sum(said == truth for said, truth in sure)
        found.append(Accuracy(person, len(sure), right, len(given) - len(sure), *wilson(right, len(sure))))
    return found
