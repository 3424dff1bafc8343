"""Rules of the list and of which sample is shown."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import msgspec

from grasp_core.dataset.queries import RANGES, Query
from grasp_core.errors import GraspError
from workbench.actions import Notice
from workbench.curate import actions as a
from workbench.curate import effects as e
from workbench.curate.registry import Result, rule
from workbench.curate.state import State


def list_again(state: State, pick: int | None = None) -> Result:
    """Read the page that is shown anew."""
    ticket = state.ticket + 1
    wanted = e.LoadShelf(ticket, state.query, state.keys[-1], pick)
    return replace(state, ticket=ticket, loading=True), (wanted,)


@rule(a.SayName)
def _say_name(action: a.SayName, state: State) -> Result:
    name = " ".join(action.name.split())[:60]
    return replace(state, person=name, review=None, item=None), (e.LoadFacts(name),)


@rule(a.Filter)
def _filter(action: a.Filter, state: State) -> Result:
    fields = msgspec.structs.asdict(state.query)
    if action.field not in fields:
        return state, ()
    text = action.text.strip()
    value: Any = text or None
    if action.field in RANGES and text:
        value = text.split("..")
    elif action.field in ("flagged", "descending"):
        value = None if not text else text == "yes"
    if action.field == "descending":
        value = bool(value)
    try:
        query = msgspec.convert({**fields, action.field: value}, Query, strict=False)
    except (msgspec.ValidationError, GraspError) as error:
        return state, (Notice("warning", "No such filter", str(error)),)
    return use_query(state, query)


def use_query(state: State, query: Query) -> Result:
    """Show another list from its first page, and its first sample."""
    return list_again(replace(state, query=query, keys=(None,), bulk=None), 0)


@rule(a.UseQuery)
def _use_query(action: a.UseQuery, state: State) -> Result:
    return use_query(state, action.query)


@rule(a.OpenView)
def _open_view(action: a.OpenView, state: State) -> Result:
    views = {} if state.facts is None else state.facts.views
    if action.name not in views:
        return state, (Notice("warning", "No such list", f"Nobody saved a list called '{action.name[:60]}'."),)
    return use_query(state, views[action.name])


@rule(a.TurnPage)
def _turn_page(action: a.TurnPage, state: State) -> Result:
    return _turn(state, action.by, 0)


def _turn(state: State, by: int, pick: int) -> Result:
    if state.loading or state.shelf is None:
        return state, ()
    if by > 0:
        if state.shelf.after is None:
            return state, (Notice("info", "This is the last sample", "There is no further page in this list."),)
        return list_again(replace(state, keys=(*state.keys, state.shelf.after)), pick)
    if len(state.keys) < 2:
        return state, (Notice("info", "This is the first sample", "The list begins here."),)
    return list_again(replace(state, keys=state.keys[:-1]), pick)


@rule(a.ShelfShown)
def _shelf_shown(action: a.ShelfShown, state: State) -> Result:
    if action.ticket != state.ticket:
        return state, ()
    state = replace(state, shelf=action.shelf, loading=False)
    thumbs = action.shelf.thumbs
    if action.pick is None or state.review is not None or not thumbs:
        return state, ()
    return show(state, thumbs[min(action.pick, len(thumbs) - 1)].row.id)


def show(state: State, grasp: int) -> Result:
    """Want a sample."""
    return replace(state, wanted=grasp), (e.LoadSample(grasp),)


@rule(a.Pick)
def _pick(action: a.Pick, state: State) -> Result:
    return (state, ()) if state.review is not None else show(state, action.grasp)


@rule(a.SampleShown)
def _sample_shown(action: a.SampleShown, state: State) -> Result:
    grasp = action.sample.row.id
    if action.item is None and grasp != state.wanted:
        return state, ()
    if action.review is not None:
        state = replace(state, review=action.review)
    same = state.sample is not None and state.sample.row.id == grasp
    kept = state if same else replace(state, edited=None, playing=None, note="")
    return replace(kept, sample=action.sample, wanted=grasp, item=action.item), ()


@rule(a.Move)
def move(action: a.Move, state: State) -> Result:
    """The next sample, or the one before; beyond the page's ends the page turns. In a review the next one skips."""
    if state.review is not None:
        if action.by < 0 or state.item is None:
            return state, ()
        return state, (e.LoadNext(state.review.id, state.item),)
    if state.shelf is None:
        return state, ()
    place = state.place
    after = 0 if place is None else place + action.by
    if after < 0:
        return _turn(state, -1, 10_000)
    if after >= len(state.shelf.thumbs):
        return _turn(state, 1, 0)
    return show(state, state.shelf.thumbs[after].row.id)
