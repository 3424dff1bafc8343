"""Rules of the image and of what is switched on in it and in the scene."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from workbench.actions import Notice
from workbench.inspector import actions as a
from workbench.inspector import answers as r
from workbench.inspector import effects as e
from workbench.inspector.orders import Place
from workbench.inspector.rules.registry import Result, rule
from workbench.inspector.state import State


@rule(a.Toggle)
def _toggle_layer(action: a.Toggle, state: State) -> Result:
    return replace(state, shown=state.shown ^ {action.what}), ()


@rule(a.ToggleMark)
def _toggle_mark(action: a.ToggleMark, state: State) -> Result:
    return replace(state, picture=replace(state.picture, marks=state.picture.marks ^ {action.what})), ()


@rule(a.Overlay)
def _overlay(action: a.Overlay, state: State) -> Result:
    return replace(state, picture=replace(state.picture, opacity=float(np.clip(action.opacity, 0, 1)))), ()


@rule(a.DepthColours)
def _colours(action: a.DepthColours, state: State) -> Result:
    return replace(state, picture=replace(state.picture, colours=action.name)), ()


@rule(a.DepthRange)
def _range(action: a.DepthRange, state: State) -> Result:
    near = float(np.clip(action.near, 0.0, 0.98))
    far = float(np.clip(action.far, near + 0.02, 1.0))
    return replace(state, picture=replace(state.picture, near=near, far=far)), ()


@rule(a.AskPlace)
def _ask_place(action: a.AskPlace, state: State) -> Result:
    plan = state.plan
    if plan is None or state.scene is None:
        return state, ()
    height, width = plan.canvas.depth.shape
    column, row = round(action.u), round(action.v)
    if not (0 <= column < width and 0 <= row < height):
        return state, ()
    depth = float(plan.canvas.depth[row, column]) if plan.canvas.valid[row, column] else None
    place = Place(float(column), float(row), depth, float(plan.quality_map[row, column]))
    ask = e.ScorePlace(state.scene_ticket, state.scene, plan.canvas.camera, place.u, place.v)
    return replace(state, place=place), (ask,)


@rule(r.PlaceScored)
def _place_scored(action: r.PlaceScored, state: State) -> Result:
    place = state.place
    if place is None or action.ticket != state.scene_ticket or (place.u, place.v) != (action.u, action.v):
        return state, ()
    return replace(state, place=replace(place, scores=action.scores, failed="")), ()


@rule(r.PlaceFailed)
def _place_failed(action: r.PlaceFailed, state: State) -> Result:
    if state.place is None or action.ticket != state.scene_ticket:
        return state, ()
    told = Notice("warning", "This place could not be scored", action.reason)
    return replace(state, place=replace(state.place, failed=action.reason)), (told,)
