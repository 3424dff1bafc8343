"""The curation benchmark: how long a page, a filter and a label take on a large dataset."""

from __future__ import annotations

import time
from collections.abc import Callable
from itertools import product

import msgspec
import numpy as np

from grasp_core.dataset.bulk import plan_bulk
from grasp_core.dataset.lists import Page
from grasp_core.dataset.queries import Query, Sort
from grasp_core.dataset.store import DatasetStore
from grasp_core.dataset.undo import undo

FILTERS: dict[str, dict] = {
    "split": {"split": "validation"},
    "largest split": {"split": "train"},
    "made by the grid": {"origin": "grid"},
    "category": {"category": "category_07"},
    "object": {"object": "thing_00012"},
    "scene": {"scene": "scene_00012"},
    "outcome": {"outcome": "SLIPPED"},
    "quality": {"quality": (0.4, 0.6)},
    "score": {"score": (0.9, 1.0)},
    "disagreement": {"gap": (0.8, 1.0)},
    "human against DART": {"dissent": (0.5, 1.0)},
    "by people": {"source": "human"},
    "flagged": {"flagged": True},
    "excluded": {"state": "excluded"},
    "person": {"person": "person 3"},
    "note": {"text": "handle ben"},
    "few of many": {"quality": (1.0, 1.0), "score": (0.0, 0.001), "split": "test"},
    "many at once": {"category": "category_07", "outcome": "SUCCESS", "score": (0.0, 0.3), "gap": (0.5, 1.0)},
    "none": {"outcome": "SUCCESS", "quality": (0.0, 0.0)},
}
"""Filters of lists, by what people would call them."""

SORTS: tuple[Sort, ...] = ("id", "gap", "mistake", "spread", "changed")


class Times(msgspec.Struct, frozen=True):
    """How long something takes.

    Attributes:
        median_ms: of the repetitions.
        most_ms: the slowest.
        cpu_most_ms: the most processor time of this process that one took; other work on the machine adds little to it.
    """

    median_ms: float
    most_ms: float
    cpu_most_ms: float


class Curation(msgspec.Struct, frozen=True):
    """The benchmark's results.

    Attributes:
        samples: in the dataset.
        events: label events in it.
        page_ms: sorting → one page of the whole dataset, the first or a later one.
        filter_ms: filter → the first page of the filtered list, under every sorting.
        label_ms: one decision, on disk.
        undo_ms: of it.
        dry_run_ms: the exact count of a bulk decision on a third of the dataset.
        worst_page_ms: the slowest page.
        worst_filter_ms: the slowest filter.
    """

    samples: int
    events: int
    page_ms: dict[str, Times]
    filter_ms: dict[str, Times]
    label_ms: Times
    undo_ms: Times
    dry_run_ms: Times
    worst_page_ms: float
    worst_filter_ms: float


def run_curation(
    store: DatasetStore, *, repeat: int = 5, labels: int = 200, seed: int = 0, tell: Callable[[str], None] | None = None
) -> Curation:
    """Time lists and labels of a made dataset, open for work; its labels are as before at the end.

    Args:
        store: see `made_dataset.make_dataset`.
        repeat: how often each list is asked for.
        labels: how many decisions are made and undone.
        seed: of the samples that are labelled.
        tell: called with what is timed next.
    """
    say = tell or (lambda _: None)
    pages: dict[str, Times] = {}
    filters: dict[str, Times] = {}
    for sort in ("quality", "label", "score", "heat", "networks", "dissent", *SORTS):
        say(f"pages by {sort}")
        pages[sort] = _times(_pages(store, Query(sort=sort, descending=True), repeat))  # type: ignore[arg-type]
    for name, values in FILTERS.items():
        say(f"filter: {name}")
        found = []
        for sort, descending in product(SORTS, (False, True)):
            query = Query(**values, sort=sort, descending=descending)
            found += [_timed(lambda q=query: store.page(q)) for _ in range(repeat)]  # type: ignore[misc]
        filters[name] = _times(found)
    say("labels")
    rng = np.random.default_rng(seed)
    highest = store.rows("SELECT max(grasp) FROM samples")[0][0]
    chosen = rng.integers(1, highest + 1, labels).tolist()
    labelled = _times([_timed(lambda g=grasp: store.add_label(g, "benchmark", 1.0)) for grasp in chosen])  # type: ignore[misc]
    undone = _times([_timed(lambda: undo(store, "benchmark")) for _ in chosen])
    say("dry run")
    dry = _times([_timed(lambda: plan_bulk(store, Query(score=(0.0, 0.02)), 0.0)) for _ in range(repeat)])
    return Curation(
        samples=store.count(Query()),
        events=len(store.events()),
        page_ms=pages,
        filter_ms=filters,
        label_ms=labelled,
        undo_ms=undone,
        dry_run_ms=dry,
        worst_page_ms=max(times.most_ms for times in pages.values()),
        worst_filter_ms=max(times.most_ms for times in filters.values()),
    )


_Time = tuple[float, float]
"""Wall and processor time, ms."""


def _pages(store: DatasetStore, query: Query, repeat: int) -> list[_Time]:
    """Times of the first pages, one after another."""
    after, found = None, []
    for _ in range(repeat):
        pages: list[Page] = []
        found.append(_timed(lambda pages=pages, after=after: pages.append(store.page(query, after=after))))  # type: ignore[misc]
        after = pages[0].after
        if after is None:
            break
    return found


def _timed(work: Callable[[], object]) -> _Time:
    wall, cpu = time.perf_counter(), time.process_time()
    work()
    return 1000 * (time.perf_counter() - wall), 1000 * (time.process_time() - cpu)


def _times(found: list[_Time]) -> Times:
    wall, cpu = np.array(found).T
    return Times(round(float(np.median(wall)), 2), round(float(wall.max()), 2), round(float(cpu.max()), 2))
