"""Which samples a list shows, and in which order: settings that people fill in, save and share."""

from __future__ import annotations

from typing import Literal, get_args

from grasp_core import config
from grasp_core.dataset.rows import SPLITS, Split
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
