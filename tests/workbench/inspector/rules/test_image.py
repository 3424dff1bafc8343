from dataclasses import replace

from workbench.inspector import actions as a
from workbench.inspector import answers as r
from workbench.inspector import effects as e
from workbench.inspector.rules import reduce


def run(state, *steps):
    effects = []
    for step in steps:
        state, more = reduce(state, step)
        effects += more
    return state, effects


def test_layers_and_marks_are_switched(shown):
    state, _ = run(shown, a.Toggle("points"), a.ToggleMark("samples"), a.ToggleMark("region"))
    assert "points" in state.shown and state.picture.marks == {"rectangles", "samples"}


def test_how_the_image_is_shown(shown):
    state, _ = run(shown, a.Overlay(7), a.DepthColours("turbo"), a.DepthRange(0.2, 0.6))
    assert state.picture.opacity == 1.0 and state.picture.colours == "turbo"
    assert (state.picture.near, state.picture.far) == (0.2, 0.6)
    narrow, _ = run(shown, a.DepthRange(1.0, 1.0))
    assert 0 <= narrow.picture.near < narrow.picture.far <= 1


def test_a_pixel_is_probed_at_once_and_scored_later(shown, scores):
    state, effects = run(shown, a.AskPlace(150.3, 139.8))
    assert (state.place.u, state.place.v) == (150, 140)
    assert abs(state.place.depth - 0.64) < 1e-6 and abs(state.place.heat - 0.7) < 1e-6
    assert effects == [e.ScorePlace(1, shown.scene, shown.plan.canvas.camera, 150.0, 140.0)]
    found = scores(150.0, 140.0)
    assert run(state, r.PlaceScored(1, 150.0, 140.0, found))[0].place.scores is found
    assert run(state, r.PlaceScored(1, 9.0, 9.0, found))[0].place.scores is None, "another pixel was asked meanwhile"
    failed, effects = run(state, r.PlaceFailed(1, "other gripper"))
    assert failed.place.failed == "other gripper" and effects[0].tone == "warning"


def test_pixels_outside_and_without_depth(shown, state, one_plan):
    for u, v in ((-1, 5), (300, 5), (5, 1e9)):
        assert run(shown, a.AskPlace(u, v)) == (shown, [])
    assert run(state, a.AskPlace(5, 5)) == (state, [])
    shown.scene.sight.plans[0].canvas.valid[5, 5] = False
    assert run(replace(shown), a.AskPlace(5, 5))[0].place.depth is None
