"""The curation as a view of the workbench."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
import viser

from grasp_core.dataset.queries import RANGES, Query
from grasp_core.dataset.rectangle import depth_rule
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import GraspError
from grasp_core.gripper import Gripper
from grasp_core.planning.crops import DepthRule
from workbench.actions import Action, Effect, Notice
from workbench.bridge import Bridge, Reader
from workbench.curate import actions as a
from workbench.curate import effects as e
from workbench.curate import workshop
from workbench.curate.browsing import list_again
from workbench.curate.desk import Desk
from workbench.curate.organising import SCORING
from workbench.curate.panels import history_panel, list_panel, review_panel, sample_panel
from workbench.curate.panels.history_panel import HistoryPanel
from workbench.curate.panels.list_panel import ListPanel
from workbench.curate.panels.review_panel import ReviewPanel
from workbench.curate.panels.sample_panel import SamplePanel
from workbench.curate.scene import SampleScene
from workbench.curate.state import State
from workbench.curate.trying import Rules
from workbench.curate.values import Decision
from workbench.jobs import Jobs
from workbench.view import Part, Post

log = logging.getLogger("workbench")

READERS: dict[str, Reader] = {
    **list_panel.READERS,
    **sample_panel.READERS,
    **history_panel.READERS,
    **review_panel.READERS,
}
RIGHT = 348
"""Width of the right column, pixels."""
_MOST_KEPT = 200
"""Unsaved decisions that a browser keeps."""


class Curation:
    """See `View`.

    Args:
        jobs: the worker.
        path: folder of the dataset; it may be missing as yet.
        gripper: of the pictures and the scene.
        sample: show the shipped sample dataset where there is none at `path`.
    """

    name = "curate"
    label = "Curate"
    actions: type[Action] = a.CurateAction
    readers: Mapping[str, Reader] = READERS

    def __init__(self, jobs: Jobs, path: Path, gripper: Gripper, *, sample: bool = False) -> None:
        self._jobs = jobs
        self._gripper = gripper
        self._desk = Desk(path, gripper, sample=sample)
        self._rules = Rules(gripper, _rule_of(path))

    def close(self) -> None:
        """Store what is under way, then close the dataset."""
        self._desk.close()

    def first(self, kept: Mapping[str, Any]) -> State:
        """See `View`."""
        try:
            unsaved = msgspec.convert(kept.get("unsaved", []), tuple[Decision, ...])[:_MOST_KEPT]
        except msgspec.ValidationError:
            unsaved = ()
        person = kept.get("person", "")
        trouble = "They were kept by this browser from its last visit." if unsaved else ""
        return State(person=person[:60] if isinstance(person, str) else "", unsaved=unsaved, trouble=trouble)

    def arrive(self, state: State, query: Mapping[str, str], shown: bool) -> tuple[State, tuple[Effect, ...]]:
        """See `View`."""
        told: tuple[Effect, ...] = ()
        pick: int | None = 0
        if shown:
            state, refused = _arrived(state, query)
            pick = None if state.wanted is not None else 0
            if refused:
                told = (Notice("warning", "A part of this link was left out", "; ".join(refused)),)
        elif state.shelf is not None:
            return state, ()
        state, effects = list_again(state, pick)
        sample = (e.LoadSample(state.wanted),) if state.wanted is not None else ()
        return state, (*told, e.LoadFacts(state.person), *effects, *sample)

    def reduce(self, state: State, action: Action) -> tuple[State, tuple[Effect, ...]]:
        """See `View`."""
        return self._rules.reduce(state, action)

    def ticking(self, state: State) -> bool:
        """See `View`."""
        return state.playing is not None and state.playing.playing

    def moving(self, state: State) -> bool:
        """See `View`."""
        return False

    def link(self, state: State) -> Mapping[str, str]:
        """See `View`."""
        found = {}
        for field, value in msgspec.structs.asdict(state.query).items():
            if value not in (None, False) and (field, value) != ("sort", "id"):
                shown = "..".join(f"{x:g}" for x in value) if field in RANGES else str(value)
                found[field] = {"True": "yes"}.get(shown, shown)
        if state.sample is not None and state.review is None:
            found["sample"] = str(state.sample.row.id)
        return found

    def keep(self, state: State) -> Mapping[str, Any]:
        """See `View`."""
        asked = (conflict.decision for conflict in state.conflicts)
        held = (*state.unsaved, *asked, *state.pending)[:_MOST_KEPT]
        return {"person": state.person, "unsaved": msgspec.to_builtins(held)}

    def show(self, bridge: Bridge, state: State) -> Part:
        """See `View`."""
        return _Curated(bridge, self._gripper, state)

    def perform(self, post: Post, effect: Effect) -> bool:
        """See `View`."""
        path = self._desk.path
        match effect:
            case e.TryMore(grasp, attempts, person):
                self._jobs.submit(
                    lambda words: post(a.Changed(words, grasp, whole=True)),
                    lambda why: post(a.Failed("Nothing was verified", why)),
                    workshop.verify,
                    path,
                    grasp,
                    attempts,
                    person,
                )
            case e.PlayAttempt(grasp, number):
                self._jobs.submit(
                    lambda played: post(a.ReplayShown(grasp, played)),
                    lambda why: post(a.Failed("The attempt cannot be replayed", why)),
                    workshop.replay,
                    path,
                    grasp,
                    number,
                )
            case e.ScoreMore():
                self._jobs.submit(
                    lambda counts: post(a.Scored(*counts, words=_scored(*counts))),
                    lambda why: post(a.Failed(SCORING, why)),
                    workshop.score,
                    path,
                )
            case _:
                return self._desk.perform(post, effect)
        return True


def _scored(done: int, total: int) -> str:
    return f"All {total} scenes have scores now." if done >= total else ""


def _rule_of(path: Path) -> DepthRule:
    """The depth rule of a dataset; the default one where it cannot be read, which the desk will tell."""
    try:
        with DatasetStore.open(path, readonly=True) as store:
            return depth_rule(store)
    except GraspError:
        return DepthRule()


def _arrived(state: State, query: Mapping[str, str]) -> tuple[State, list[str]]:
    """The state that a link asks for, and what is wrong with words that were left out."""
    fields: dict[str, Any] = {}
    refused = []
    for field in Query.__struct_fields__:
        if field in query:
            text = query[field]
            value = text.split("..") if field in RANGES else text == "yes" if field in _FLAGS else text
            try:
                fields[field] = getattr(msgspec.convert({field: value}, Query, strict=False), field)
            except (msgspec.ValidationError, GraspError) as error:
                refused.append(f"{field}: {error}")
    if "sample" in query and not (query["sample"].isdecimal() and int(query["sample"]) < 2**63):
        refused.append(f"sample: '{query['sample'][:40]}' is no number of a sample")
    elif "sample" in query:
        state = replace(state, wanted=int(query["sample"]))
    if fields:
        state = replace(state, query=Query(**fields), keys=(None,))
    return state, refused


_FLAGS = ("flagged", "descending")


class _Curated:
    def __init__(self, bridge: Bridge, gripper: Gripper, state: State) -> None:
        self._parts: list[Part] = [ListPanel(bridge, state)]
        tabs = [("Sample", viser.Icon.TAG), ("History", viser.Icon.HISTORY), ("Reviews", viser.Icon.USERS)]
        with bridge.panel(tabs, RIGHT) as (sample, history, reviews):
            with sample:
                self._parts.append(SamplePanel(bridge, gripper))
            with history:
                self._parts.append(HistoryPanel(bridge))
            with reviews:
                self._parts.append(ReviewPanel(bridge))
        self._parts.append(SampleScene(bridge, gripper))

    def update(self, old: State | None, new: State) -> None:
        for part in self._parts:
            part.update(old, new)
