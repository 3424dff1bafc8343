"""The desk: one thread that reads and writes the dataset for all browsers, and makes what they show of it."""

from __future__ import annotations

import logging
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import DepthImage
from grasp_core.dataset.agreement import accuracies, agreements
from grasp_core.dataset.archive import shipped_archives
from grasp_core.dataset.bulk import label_all, plan_bulk
from grasp_core.dataset.database import FILE
from grasp_core.dataset.exchange import event_lines, import_events
from grasp_core.dataset.labels import LabelConflict, standing
from grasp_core.dataset.queries import Query
from grasp_core.dataset.rectangle import add_edited
from grasp_core.dataset.review import answer, item_at, next_item, review, reviews, skip, start_review
from grasp_core.dataset.sample import sample_dataset
from grasp_core.dataset.store import DatasetStore
from grasp_core.dataset.trials import pooled_quality
from grasp_core.dataset.undo import redo, undo
from grasp_core.errors import GraspError
from grasp_core.gripper import Gripper
from workbench.actions import Download
from workbench.curate import actions as a
from workbench.curate import effects as e
from workbench.curate.organising import RELABELLING
from workbench.curate.pictures import coloured, crop_picture, thumbnail
from workbench.curate.values import Facts, Sample, Shelf, Thumb
from workbench.view import Post

log = logging.getLogger("workbench")

PAGE = 24
"""Samples of a page."""

EVENTS = 60
"""Label events of a person that are read at once."""


class Desk:
    """Does effects on one dataset, in order.

    Args:
        path: folder of the dataset; it is opened when first needed, so that a broken one breaks this view only.
        gripper: for pictures.
        sample: open the shipped sample dataset, a copy in the user's data folder, where there is no dataset at `path`.

    Attributes:
        path: of the dataset that is used.
    """

    def __init__(self, path: Path, gripper: Gripper, *, sample: bool = False) -> None:
        self.path = path
        self._sample = sample
        self._gripper = gripper
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="desk")
        self._store: DatasetStore | None = None
        self._stopped: set[str] = set()
        self._picture = lru_cache(maxsize=64)(self._read_picture)

    def close(self) -> None:
        """Finish what was asked for, then close the dataset."""
        self._thread.submit(self._close)
        self._thread.shutdown(wait=True)

    def _close(self) -> None:
        if self._store is not None:
            self._store.close()

    def perform(self, post: Post, effect: Any) -> bool:
        """Start doing an effect; False when it belongs to others."""
        if isinstance(effect, e.StopRelabel):
            self._stopped.add(effect.person)
            return True
        work = _WORK.get(type(effect))
        if work is None:
            return False
        self._thread.submit(self._do, work, post, effect)
        return True

    def _do(self, work: Callable[[Desk, Post, Any], None], post: Post, effect: Any) -> None:
        try:
            work(self, post, effect)
        except GraspError as error:
            post(a.Failed(_TITLES.get(type(effect), "That did not work"), str(error)))
        except Exception as error:
            log.exception("the desk failed")
            post(a.Failed("Something went wrong here", f"{type(error).__name__}: {error}"))

    @property
    def store(self) -> DatasetStore:
        """The dataset, open for writing; in this desk's thread only."""
        if self._store is None:
            if self._sample and not (self.path / FILE).exists() and shipped_archives():
                self.path = sample_dataset()
            self._store = DatasetStore.open(self.path)
        return self._store

    # pictures

    def _read_picture(self, scene: int) -> tuple[DepthImage, NDArray[np.uint8]]:
        image = self.store.depth(scene)
        return image, coloured(image)

    def sample(self, grasp: int) -> Sample:
        """All that is known of a sample."""
        store = self.store
        row = store.grasp(grasp)
        found = store.row(
            "SELECT scenes.name AS scene, objects.name AS object, category, scenes.split AS split FROM scenes"
            " JOIN objects ON objects.id = scenes.object WHERE scenes.id = ?",
            (row.scene,),
        )
        assert found is not None
        image, _ = self._picture(row.scene)
        return Sample(
            row=row,
            scene_name=found["scene"],
            object=found["object"],
            category=found["category"],
            split=found["split"],
            scene=store.scene(row.scene),
            image=image,
            attempts=tuple(store.attempts(grasp)),
            history=tuple(store.history(grasp)),
            label=store.current(grasp),
            pooled=pooled_quality(store, grasp),
            crop=crop_picture(image, row.grasp, self._gripper),
        )

    # effects

    def _load_facts(self, post: Post, effect: e.LoadFacts) -> None:
        store = self.store
        weights = store.row("SELECT name FROM weights WHERE digest = ?", (store.meta.weights,))
        views = {}
        for name, query in store.views().items():
            try:
                views[name] = msgspec.convert(query, Query)
            except (msgspec.ValidationError, GraspError) as error:
                log.warning("the saved view '%s' is left out: %s", name, error)
        facts = Facts(
            name=store.meta.name,
            samples=store.count(Query()),
            categories=tuple(row[0] for row in store.rows("SELECT DISTINCT category FROM objects ORDER BY 1")),
            people=tuple(store.people()),
            views=views,
            weights="" if weights is None else weights["name"],
            agreements=tuple(agreements(store)),
            accuracies=tuple(accuracies(store)),
            reviews=tuple(reviews(store, effect.person)),
        )
        post(a.FactsShown(facts))

    def _load_shelf(self, post: Post, effect: e.LoadShelf) -> None:
        page = self.store.page(effect.query, size=PAGE, after=effect.after)
        names = {row["id"]: row["name"] for row in self._objects([row.scene for row in page.rows])}
        thumbs = []
        for row in page.rows:
            image, picture = self._picture(row.scene)
            thumbs.append(Thumb(row, names[row.scene], thumbnail(picture, image, row.grasp, self._gripper)))
        post(a.ShelfShown(effect.ticket, Shelf(tuple(thumbs), page.after, page.total), effect.pick))

    def _objects(self, scenes: list[int]) -> list[Any]:
        marks = ",".join("?" * len(scenes))
        query = "SELECT scenes.id AS id, objects.name AS name FROM scenes JOIN objects ON objects.id = scenes.object"
        return self.store.rows(f"{query} WHERE scenes.id IN ({marks})", scenes)

    def _load_sample(self, post: Post, effect: e.LoadSample) -> None:
        post(a.SampleShown(self.sample(effect.grasp)))

    def _load_next(self, post: Post, effect: e.LoadNext) -> None:
        if effect.skip is not None:
            skip(self.store, effect.skip)
        item, found = next_item(self.store, effect.review), review(self.store, effect.review)
        if item is None:
            post(a.ReviewEnded(found))
        else:
            post(a.SampleShown(self.sample(item.grasp), item, found))

    def _save(self, post: Post, effect: e.Save) -> None:
        decision = effect.decision
        try:
            store = self.store
            if decision.review is not None:
                item = item_at(store, decision.review, decision.place)
                answer(store, item, decision.decision, note=decision.note, seen_event=decision.seen)  # type: ignore[arg-type]
            else:
                store.add_label(
                    decision.grasp,
                    effect.person,
                    decision.decision,  # type: ignore[arg-type]
                    reason="curated in the workbench",
                    note=decision.note,
                    seen_event=decision.seen,
                )
            row = store.grasp(decision.grasp)
        except LabelConflict as conflict:
            post(a.Conflicted(decision, conflict.events))
        except GraspError as error:
            post(a.NotSaved(decision, str(error)))
        else:
            post(a.Saved(decision, row))

    def _step_back(self, post: Post, effect: e.StepBack) -> None:
        events = (redo if effect.redo else undo)(self.store, effect.person)
        if not events:
            post(a.Changed(f"There is nothing of {effect.person} to {'redo' if effect.redo else 'undo'}."))
            return
        word = "Redone" if effect.redo else "Undone"
        what = f"{len(events)} decisions" if len(events) > 1 else "the decision on the sample that is shown now"
        post(a.Changed(f"{word}: {what}.", events[-1].grasp, whole=True))

    def _revert(self, post: Post, effect: e.Revert) -> None:
        event = self.store.revert(effect.event, effect.person, reason="reverted in the workbench")
        post(a.Changed("The event was taken back; that can be undone, too.", event.grasp, whole=True))

    def _count(self, post: Post, effect: e.Count) -> None:
        plan = plan_bulk(self.store, effect.query, effect.decision)  # type: ignore[arg-type]
        post(a.BulkCounted(effect.query, effect.decision, plan))

    def _relabel(self, post: Post, effect: e.Relabel) -> None:
        try:
            bulk = label_all(
                self.store,
                effect.query,
                effect.person,
                effect.decision,  # type: ignore[arg-type]
                effect.plan,
                reason="relabelled in bulk in the workbench",
                progress=lambda done, total: post(a.BulkMoved(min(done, total - 1), total)),
                cancelled=lambda: effect.person in self._stopped,
            )
        finally:
            self._stopped.discard(effect.person)
        post(a.BulkMoved(bulk.events, bulk.events))
        post(a.Changed(f"{bulk.events} samples were relabelled; one undo (Z) takes all of them back.", whole=True))

    def _make_review(self, post: Post, effect: e.MakeReview) -> None:
        made = start_review(self.store, effect.person, effect.rule)
        self._load_next(post, e.LoadNext(made.id))

    def _store_grasp(self, post: Post, effect: e.StoreGrasp) -> None:
        new = add_edited(self.store, effect.parent, effect.grasp, effect.person)
        post(a.Changed("" if effect.verify else "The rectangle is a new grasp; label or verify it.", new, whole=True))
        if effect.verify:
            post(a.Verify(effect.verify, new))

    def _keep_query(self, post: Post, effect: e.KeepQuery) -> None:
        if effect.query is None:
            self.store.delete_view(effect.name)
        else:
            self.store.save_view(effect.name, msgspec.to_builtins(effect.query), effect.person or None)
        self._load_facts(post, e.LoadFacts(effect.person))

    def _load_person(self, post: Post, effect: e.LoadPerson) -> None:
        found = self.store.events_of(effect.name, before=effect.before, limit=EVENTS + 1)
        shown = tuple(found[:EVENTS])
        stand = {
            event.id for grasp in {event.grasp for event in shown} for event in standing(self.store.history(grasp))
        }
        gone = frozenset(event.id for event in shown) - stand
        post(a.PersonShown(effect.name, shown, gone, len(found) > EVENTS, effect.before))

    def _export(self, post: Post, effect: e.Export) -> None:
        content = b"".join(msgspec.json.encode(line) + b"\n" for line in event_lines(self.store))
        post(a.Exported(Download(f"{self.store.meta.name}-labels.jsonl", content)))

    def _import(self, post: Post, effect: e.Import) -> None:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "labels.jsonl"
            file.write_bytes(effect.content)
            merged = import_events(self.store, file)
        left = "".join(f" {count} left out: {reason}." for reason, count in merged.left_out.items())
        post(a.Changed(f"{merged.added} label events added, {merged.known} were there.{left}", whole=True))


_WORK: dict[type, Callable[[Desk, Post, Any], None]] = {
    e.LoadFacts: Desk._load_facts,
    e.LoadShelf: Desk._load_shelf,
    e.LoadSample: Desk._load_sample,
    e.LoadNext: Desk._load_next,
    e.Save: Desk._save,
    e.StepBack: Desk._step_back,
    e.Revert: Desk._revert,
    e.Count: Desk._count,
    e.Relabel: Desk._relabel,
    e.MakeReview: Desk._make_review,
    e.StoreGrasp: Desk._store_grasp,
    e.KeepQuery: Desk._keep_query,
    e.LoadPerson: Desk._load_person,
    e.Export: Desk._export,
    e.Import: Desk._import,
}
_TITLES: dict[type, str] = {
    e.LoadFacts: "The dataset cannot be opened",
    e.LoadShelf: "The list cannot be read",
    e.LoadSample: "The sample cannot be read",
    e.Relabel: RELABELLING,
    e.MakeReview: "No review was made",
    e.StoreGrasp: "The rectangle was not stored",
    e.Import: "Nothing was imported",
}
