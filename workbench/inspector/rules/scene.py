"""Rules of the scene: which objects, which settings, and when a scene that was asked for is there."""

from __future__ import annotations

from dataclasses import replace

import msgspec
import numpy as np

from grasp_core.scene import PlacedObject, Scene
from workbench.actions import Effect, Notice
from workbench.inspector import actions as a
from workbench.inspector import answers as r
from workbench.inspector import effects as e
from workbench.inspector.orders import MOST_THINGS, Choice, OpenedScene, SceneRequest, Thing
from workbench.inspector.poses import matrix
from workbench.inspector.rules.registry import Result, rule
from workbench.inspector.rules.trials import show_attempt
from workbench.inspector.setup import DEFAULT, Setup, changed
from workbench.inspector.state import Live, State

SHAPES = 900
"""Shapes of a family that random scenes draw from; later seeds are for benchmarks only."""
_TRIES_ONLY = {"sigma_p", "sigma_phi", "attempts"}
"""Settings that do not change what is planned."""


def want(state: State, request: SceneRequest | None = None, setup: Setup | None = None) -> Result:
    """Want another scene; of those wanted while one is being made, the last one is made next."""
    asked = replace(
        state,
        request=request or state.request,
        setup=setup or state.setup,
        ticket=state.ticket + 1,
        failure=None,
    )
    return (asked, ()) if state.making is not None else make(asked)


def make(state: State, asked: float | None = None) -> Result:
    """Start what is wanted now: see a known scene anew, or make it."""
    effect: Effect
    if state.known:
        effect = e.SeeScene(state.ticket, state.request, state.setup, asked)
    else:
        effect = e.OpenScene(state.ticket, state.request, state.setup)
    return replace(state, making=state.ticket), (effect,)


@rule(a.ShowObject)
def _show_object(action: a.ShowObject, state: State) -> Result:
    things = (Thing(action.name),)
    if state.request.things == things and state.request.photo is None:
        return state, ()
    return want(replace(state, grabbed=0), msgspec.structs.replace(state.request, things=things, photo=None))


@rule(a.AnotherObject)
def _another_object(action: a.AnotherObject, state: State) -> Result:
    families = state.catalogue.families
    last = state.request.things[-1].name.rpartition("_")[0] if state.request.things else ""
    now = families.index(last) if last in families else -1
    thing = Thing(_name(families[(now + 1) % len(families)], action.draw))
    return want(replace(state, grabbed=0), msgspec.structs.replace(state.request, things=(thing,), photo=None))


def _name(family: str, draw: int) -> str:
    return f"{family}_{draw % SHAPES:03d}"


@rule(a.AnotherPose)
def _another_pose(action: a.AnotherPose, state: State) -> Result:
    if not state.request.things:
        return state, (Notice("info", "An own image", "Nothing in it can be turned over."),)
    index = min(state.grabbed, len(state.request.things) - 1)
    thing = state.request.things[index]
    known = state.scene is not None and not state.opening and index < len(state.scene.rests)
    if known and state.scene is not None and len(state.scene.rests[index].poses) == 1 and thing.at is None:
        return state, (Notice("info", "Only one stable pose", f"{thing.name} rests in one way only."),)
    turned = msgspec.structs.replace(thing, pose=thing.pose + 1, at=None, loose=False)
    return want(state, state.request.moved(index, turned))


@rule(a.RandomScene)
def _random_scene(action: a.RandomScene, state: State) -> Result:
    rng = np.random.default_rng(action.draw)
    things = tuple(
        Thing(_name(str(rng.choice(state.catalogue.families)), int(rng.integers(SHAPES))), int(rng.integers(8)))
        for _ in range(min(max(action.count, 1), MOST_THINGS))
    )
    return want(replace(state, grabbed=0), SceneRequest(things, int(rng.integers(2**31 - 1))))


@rule(a.AddObject)
def _add_object(action: a.AddObject, state: State) -> Result:
    if state.request.photo is not None:
        return _random_scene(a.RandomScene(action.draw), state)
    if len(state.request.things) >= MOST_THINGS:
        return state, (Notice("info", "The table is full", f"A scene has at most {MOST_THINGS} objects."),)
    rng = np.random.default_rng(action.draw)
    thing = Thing(_name(str(rng.choice(state.catalogue.families)), int(rng.integers(SHAPES))))
    return want(state, msgspec.structs.replace(state.request, things=(*state.request.things, thing)))


@rule(a.Change)
def _change(action: a.Change, state: State) -> Result:
    try:
        setup = changed(state.setup, action.name, action.value)
    except ValueError as error:
        return state, (Notice("warning", "That setting was not taken", str(error)),)
    if setup == state.setup:
        return state, ()
    if action.name in _TRIES_ONLY:
        return _try_anew(state, setup)
    return want(replace(state, choice=_in_first_plan(state, setup)), setup=setup)


def _in_first_plan(state: State, setup: Setup) -> Choice | None:
    return None if state.choice is not None and state.choice.side >= len(setup.planners) else state.choice


def _try_anew(state: State, setup: Setup) -> Result:
    """Other noise, other trials: what is known of them is let go."""
    ticket = state.ticket + 1 if state.making is None else state.ticket
    scene = None if state.scene is None else replace(state.scene, setup=setup)
    fresh = replace(
        state,
        setup=setup,
        scene=scene,
        ticket=ticket,
        scene_ticket=ticket if state.making is None else state.scene_ticket,
        trials={},
        playback=None,
        waiting=None,
        sweep=None,
    )
    return fresh, ()


@rule(a.ResetSetup)
def _reset(action: a.ResetSetup, state: State) -> Result:
    return (state, ()) if state.setup == DEFAULT else want(replace(state, choice=None), setup=DEFAULT)


@rule(r.Opened)
def _opened(action: r.Opened, state: State) -> Result:
    if action.ticket != state.making:
        return state, ()
    if action.ticket != state.ticket:
        return make(state)
    return _show(replace(state, request=action.scene.request), action.scene)


@rule(r.Seen)
def _seen(action: r.Seen, state: State) -> Result:
    if action.ticket != state.making:
        return state, ()
    if state.scene is None:
        return make(state)
    shown, effects = _show(state, _moved(state.scene, action), still=state.dragging)
    if action.asked is not None:
        shown = replace(shown, live=_follows(state, action.now, action.asked))
    if action.ticket != state.ticket:
        later = replace(shown, ticket=state.ticket, wanted=state.wanted, waiting=state.waiting)
        return make(later, state.moved_at)
    if state.wanted is None or state.waiting is None or shown.choice != state.wanted:
        return shown, effects
    return show_attempt(shown, state.waiting)


def _follows(state: State, now: float, asked: float) -> Live:
    times = () if state.live is None else tuple(t for t in state.live.times if now - t < 1.5)
    return Live(1000 * (now - asked), (*times, now))


def _moved(scene: OpenedScene, action: r.Seen) -> OpenedScene:
    """The scene that is shown, as it was seen anew."""
    if action.request.photo is not None:
        return replace(scene, request=action.request, setup=action.setup, sight=action.sight)
    placed, rests = [], []
    for thing, old, rest in zip(action.request.things, scene.scene.objects, scene.rests, strict=True):
        placed.append(old if thing.at is None else PlacedObject(old.asset, matrix(thing.at)))
        rests.append(rest if thing.at is None else rest.at(matrix(thing.at)))
    return replace(
        scene,
        request=action.request,
        setup=action.setup,
        scene=Scene(tuple(placed), action.sight.image.camera),
        rests=tuple(rests),
        sight=action.sight,
    )


def _show(state: State, scene: OpenedScene, still: bool = False) -> Result:
    """Show a scene; what was known of candidates of another one is let go."""
    same = state.scene is not None and [t.name for t in state.scene.request.things] == [
        t.name for t in scene.request.things
    ]
    shown = replace(
        state,
        making=None,
        scene=scene,
        scene_ticket=state.making if state.making is not None else state.ticket,
        failure=None,
        wanted=None,
        choice=_chosen(state, scene),
        trials={},
        waiting=None,
        sweep=None,
        playback=None,
        pinned=state.pinned if same else None,
        verdicts={},
        judging=False,
        by_physics=False,
        place=None,
        grabbed=min(state.grabbed, max(len(scene.request.things) - 1, 0)),
        live=state.live if same else None,
        moved_at=state.moved_at if still else None,
    )
    if still or shown.loose or not scene.scene.objects or shown.choice is None:
        return shown, ()
    return shown, (e.ExpectTrial(shown.scene_ticket, scene, shown.choice),)


def _chosen(state: State, scene: OpenedScene) -> Choice | None:
    """The candidate that a link asks for, else the best one of the plan that is looked at."""
    side = state.side
    if state.wanted is not None and state.wanted.index < len(scene.candidates(state.wanted.side)):
        return state.wanted
    for plan in (side, 0, 1):
        if scene.candidates(plan):
            return Choice(plan, 0)
    return None


@rule(r.OpenFailed)
def _open_failed(action: r.OpenFailed, state: State) -> Result:
    if action.ticket != state.making:
        return state, ()
    if action.ticket != state.ticket:
        return make(state)
    told = Notice("error", "This scene could not be made", action.reason)
    return replace(state, making=None, failure=action.reason, wanted=None, waiting=None), (told,)
