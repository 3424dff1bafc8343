"""Bulk relabelling: one decision on every sample of a filtered list, counted first, undone in one step."""

from __future__ import annotations

import uuid
from collections.abc import Callable

import msgspec

from grasp_core.dataset.labels import Kind
from grasp_core.dataset.queries import Query
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import Cancelled, StoreError

_CHANGES = {
    "unsure": "state <> 'unsure'",
    "exclude": "state <> 'excluded'",
    "flag": "flagged = 0",
    "unflag": "flagged = 1",
}
"""Decisions without a value → which samples they change, in SQL."""


class BulkPlan(msgspec.Struct, frozen=True):
    """What a bulk decision would do.

    Attributes:
        samples: that the filters select.
        changing: of them, those whose label or state would change.
        human: of them, those that a person has decided on: their decisions would be overruled.
    """

    samples: int
    changing: int
    human: int


class Bulk(msgspec.Struct, frozen=True):
    """A bulk decision that was made.

    Attributes:
        batch: shared by its events; `undo` takes all of them back.
        events: how many.
    """

    batch: str
    events: int


def plan_bulk(store: DatasetStore, query: Query, decision: float | Kind) -> BulkPlan:
    """Count what a decision on all samples of a list would do, and do nothing (dry run).

    Raises:
        StoreError: the decision is none that may be given in bulk.
    """
    where, values = store.conditions(query)
    if isinstance(decision, str):
        if decision not in _CHANGES:
            raise StoreError(f"a bulk decision is a value or one of: {', '.join(_CHANGES)}; not '{decision}'")
        changes, given = _CHANGES[decision], []
    else:
        changes, given = "label IS NOT ? OR state <> 'labelled'", [float(decision)]
    row = store.row(
        f"SELECT count(*), total({changes}), total(source = 'human') FROM samples WHERE {' AND '.join(where) or '1'}",
        [*given, *values],
    )
    assert row is not None
    return BulkPlan(*map(int, row))


def label_all(
    store: DatasetStore,
    query: Query,
    person: str,
    decision: float | Kind,
    plan: BulkPlan,
    *,
    reason: str = "",
    progress: Callable[[int, int], None] | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> Bulk:
    """Give all samples of a list one decision: all of them or, on an error or when cancelled, none.

    Args:
        store: the dataset.
        query: selects the samples.
        person: who decides.
        decision: as in `DatasetStore.add_label`.
        plan: what was counted before; the list must still be the same.
        reason: why, one sentence.
        progress: called with (done, total) samples.
        cancelled: asked between samples.

    Raises:
        StoreError: the list has changed since it was counted, or it cannot be written.
        Cancelled: `cancelled` said so.
    """
    batch = uuid.uuid4().hex
    with store.transaction():
        found = plan_bulk(store, query, decision)
        if found != plan:
            raise StoreError(
                f"the list changed meanwhile: {found.samples} samples, {found.changing} of them to change, instead of"
                f" {plan.samples} and {plan.changing}; look at the new count and decide again"
            )
        chosen = store.ids(query)
        for index, grasp in enumerate(chosen):
            if cancelled is not None and cancelled():
                raise Cancelled("cancelled; no label was changed")
            store.add_label(grasp, person, decision, reason=reason, batch=batch)
            if progress is not None and (index + 1) % 100 == 0:
                progress(index + 1, len(chosen))
    return Bulk(batch, len(chosen))
