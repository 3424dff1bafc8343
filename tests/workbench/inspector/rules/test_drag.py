from dataclasses import replace

import numpy as np
import pytest

from workbench.inspector import actions as a
from workbench.inspector import answers as r
from workbench.inspector import effects as e
from workbench.inspector.orders import Choice, SceneRequest
from workbench.inspector.poses import vector
from workbench.inspector.rules import reduce
from workbench.inspector.setup import DEFAULT


def run(state, *steps):
    effects = []
    for step in steps:
        state, more = reduce(state, step)
        effects += more
    return state, effects


def pose(state, x=0.0, z=0.0):
    moved = state.scene.scene.objects[0].world_from_object.copy()
    moved[:3, 3] += [x, 0, z]
    return vector(moved)


def test_plans_follow_a_drag_one_at_a_time(shown, sight):
    state, effects = run(shown, a.Drag(pose(shown, 0.01), False, 1.0))
    assert state.dragging and effects == [e.SeeScene(2, state.request, DEFAULT, 1.0)]
    first = state.request
    state, effects = run(state, a.Drag(pose(shown, 0.02), False, 1.05), a.Drag(pose(shown, 0.03), False, 1.1))
    assert effects == [], "one plan is under way"
    state, effects = run(state, r.Seen(2, first, DEFAULT, sight(), 1.0, 1.12))
    assert effects == [e.SeeScene(4, state.request, DEFAULT, 1.1)], "the newest place is next"
    assert state.live.latency_ms == pytest.approx(120) and state.request.things[0].at == pose(shown, 0.03)
    assert state.scene.scene.objects[0].world_from_object[0, 3] == pytest.approx(pose(shown, 0.01)[0])
    state, effects = run(state, r.Seen(4, state.request, DEFAULT, sight(), 1.1, 1.2))
    assert effects == [] and state.live.rate == pytest.approx(1 / 0.08)
    assert np.isclose(state.scene.scene.objects[0].world_from_object[0, 3], pose(shown, 0.03)[0])


def test_what_is_lifted_bit_by_bit_is_not_at_rest(shown):
    state = shown
    for step in range(1, 5):
        state, _ = run(state, a.Drag(pose(shown, 0.01, 0.001 * step), False, 1.0 + 0.1 * step))
    assert state.loose, "each movement was under 2 mm, all of them were not"
    state = shown
    for step in range(1, 7):  # many short drags
        state, _ = run(
            state,
            a.Drag(pose(shown, 0.01, 0.0015 * step), False, step),
            a.Drag(pose(shown, 0.01, 0.0015 * step), True, step),
        )
    assert state.loose
    state, _ = run(shown, *(a.Drag(pose(shown, 0.01 * step), False, 1.0 + step) for step in range(6)))
    assert not state.loose, "it slid"


def test_the_end_of_a_drag_is_seen_at_rest(shown, sight):
    state, _ = run(shown, a.Drag(pose(shown, 0.01), False, 1.0))
    state, _ = run(state, r.Seen(2, state.request, DEFAULT, sight(), 1.0, 1.1))
    state, effects = run(state, a.Drag(pose(shown, 0.01), True, 1.2))
    assert not state.dragging and isinstance(effects[0], e.SeeScene)
    state, effects = run(state, r.Seen(state.ticket, state.request, DEFAULT, sight(), None, 1.3))
    assert [type(effect) for effect in effects] == [e.ExpectTrial], "the best candidate may be clicked next"


def test_a_click_while_the_end_of_a_drag_is_being_seen_is_tried_in_the_plan_that_comes(shown, sight):
    state, _ = run(shown, a.Drag(pose(shown, 0.01), False, 1.0))
    state, _ = run(state, a.Drag(pose(shown, 0.02), True, 1.2))
    state, effects = run(state, a.Select(Choice(0, 1)))
    assert effects == [] and state.waiting == 0 and not state.trying
    state, effects = run(state, r.Seen(state.making, state.request, DEFAULT, sight(), 1.0, 1.3))
    assert [type(effect) for effect in effects] == [e.SeeScene], "a newer place is wanted"
    state, effects = run(state, r.Seen(state.making, state.request, DEFAULT, sight(), None, 1.4))
    assert state.choice == Choice(0, 1) and state.waiting is None and state.trial.running
    assert effects == [
        e.RecordAttempt(state.scene_ticket, state.scene, Choice(0, 1), 0),
        e.RunTrial(state.scene_ticket, state.scene, Choice(0, 1)),
    ]


def test_sliding_keeps_an_object_at_rest_and_lifting_does_not(shown):
    assert not run(shown, a.Drag(pose(shown, 0.05), True, 1.0))[0].loose
    lifted, _ = run(shown, a.Drag(pose(shown, 0.05, 0.02), True, 1.0))
    assert lifted.loose
    again, _ = run(lifted, a.Drag(pose(shown, 0.06, 0.02), True, 1.0))
    assert again.loose, "it hangs in the air still"


def test_settling_takes_the_request_that_dart_gives_back(shown):
    state, effects = run(shown, a.Settle())
    assert state.settling and effects == [e.SettleScene(1, shown.request, DEFAULT)]
    assert run(state, a.Settle())[1] == [], "once at a time"
    thing = shown.request.things[0]
    rested = SceneRequest((type(thing)(thing.name, 0, pose(shown, 0.02)),), 1)
    state, effects = run(state, r.Settled(1, rested))
    assert not state.settling and state.request == rested and isinstance(effects[0], e.SeeScene)


def test_settling_that_comes_too_late_or_fails_changes_nothing(shown):
    state, _ = run(shown, a.Settle())
    other, _ = run(replace(state, request=SceneRequest()), r.Settled(1, shown.request))
    assert other.request == SceneRequest() and not other.settling
    failed, effects = run(state, r.SettleFailed(1, "it rolls"))
    assert not failed.settling and effects[0].tone == "error"


def test_modes_and_the_grabbed_object(shown):
    assert run(shown, a.DragMode("free"))[0].mode == "free"
    assert run(shown, a.DragMode())[0].mode == "free" and run(shown, a.DragMode(), a.DragMode())[0].mode == "slide"
    assert run(shown, a.Grab(5))[0].grabbed == 0


def test_nothing_is_dragged_before_the_first_scene(state):
    assert run(state, a.Drag((0, 0, 0, 1, 0, 0, 0), False, 1.0)) == (state, [])
