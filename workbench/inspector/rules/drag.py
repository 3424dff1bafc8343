"""Rules of dragging and settling objects."""

from __future__ import annotations

from dataclasses import replace

import msgspec
import numpy as np
from numpy.typing import NDArray

from workbench.actions import Notice
from workbench.inspector import actions as a
from workbench.inspector import answers as r
from workbench.inspector import effects as e
from workbench.inspector.poses import floats, matrix, slid, vector
from workbench.inspector.rules.registry import Result, rule
from workbench.inspector.rules.scene import make, want
from workbench.inspector.state import State


@rule(a.Grab)
def _grab(action: a.Grab, state: State) -> Result:
    return (replace(state, grabbed=action.index) if action.index < len(state.request.things) else state), ()


@rule(a.DragMode)
def _mode(action: a.DragMode, state: State) -> Result:
    return replace(state, mode=action.mode or ("free" if state.mode == "slide" else "slide")), ()


@rule(a.Drag)
def _drag(action: a.Drag, state: State) -> Result:
    before = state.pose(state.grabbed)
    if before is None:
        return state, ()
    thing = state.request.things[state.grabbed]
    start = state.dragged_from if state.dragging and state.dragged_from is not None else vector(before)
    loose = thing.loose or not slid(matrix(start), matrix(action.at)) or _floats(state, matrix(action.at))
    moved = msgspec.structs.replace(thing, at=action.at, loose=loose)
    state = replace(state, dragging=not action.ended, dragged_from=start, playback=None, moved_at=action.now)
    if moved.at == thing.at:
        # The drag ended where it was last: what the last movement asked for is shown at rest.
        return (state, ()) if state.making is not None else want(state)
    request = state.request.moved(state.grabbed, moved)
    if state.making is not None:
        return want(state, request)
    return make(replace(state, request=request, ticket=state.ticket + 1, failure=None), action.now)


def _floats(state: State, pose: NDArray[np.float64]) -> bool:
    objects = () if state.scene is None else state.scene.scene.objects
    return state.grabbed < len(objects) and floats(objects[state.grabbed].asset.vertices, pose)


@rule(a.Settle)
def _settle(action: a.Settle, state: State) -> Result:
    if state.scene is None or state.settling:
        return state, ()
    if not state.request.things:
        return state, (Notice("info", "An own image", "There are no objects to let go."),)
    return replace(state, settling=True), (e.SettleScene(state.ticket, state.request, state.setup),)


@rule(r.Settled)
def _settled(action: r.Settled, state: State) -> Result:
    state = replace(state, settling=False)
    names = [thing.name for thing in state.request.things]
    if [thing.name for thing in action.request.things] != names or state.dragging:
        return state, ()
    return want(state, action.request)


@rule(r.SettleFailed)
def _settle_failed(action: r.SettleFailed, state: State) -> Result:
    told = Notice("error", "The objects did not come to rest", action.reason)
    return replace(state, settling=False), (told,)
