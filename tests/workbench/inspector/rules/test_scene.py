from dataclasses import replace

import msgspec
import pytest

from workbench.inspector import actions as a
from workbench.inspector import answers as r
from workbench.inspector import effects as e
from workbench.inspector.orders import MOST_THINGS, Choice, Photo, SceneRequest, Thing
from workbench.inspector.rules import reduce
from workbench.inspector.setup import DEFAULT


def run(state, *steps):
    effects = []
    for step in steps:
        state, more = reduce(state, step)
        effects += more
    return state, effects


def test_another_object_is_another_family_with_a_drawn_shape(shown):
    state, effects = run(shown, a.AnotherObject(1234))
    assert state.opening and state.scene is shown.scene, "the old scene stays until the new one is there"
    assert effects == [e.OpenScene(2, state.request, DEFAULT)]
    assert state.request.things == (Thing("mug_334"),)


def test_another_pose_keeps_the_object(shown):
    state, _ = run(shown, a.AnotherPose())
    assert state.request.things == (Thing("box_003", 1),)


def test_the_only_pose_is_told(shown):
    rests = (replace(shown.scene.rests[0], poses=shown.scene.rests[0].poses[:1]),)
    state, effects = run(replace(shown, scene=replace(shown.scene, rests=rests)), a.AnotherPose())
    assert not state.opening and effects[0].title == "Only one stable pose"


def test_random_scenes_follow_from_their_draw(shown):
    one, two = (run(shown, a.RandomScene(5, 3))[0].request for _ in range(2))
    assert one == two != run(shown, a.RandomScene(6, 3))[0].request
    assert len(one.things) == 3 and len(run(shown, a.RandomScene(5, 99))[0].request.things) == MOST_THINGS


def test_objects_are_added_until_the_table_is_full(shown):
    state, _ = run(shown, *[a.AddObject(i) for i in range(MOST_THINGS - 1)])
    assert len(state.request.things) == MOST_THINGS and state.request.things[0] == Thing("box_003")
    _, effects = run(state, a.AddObject(9))
    assert effects[0].title == "The table is full"


def test_of_many_wishes_the_last_one_is_made_next(shown, opened):
    state, effects = run(shown, a.ShowObject("mug_000"), a.ShowObject("pen_000"), a.ShowObject("pen_001"))
    assert len(effects) == 1
    state, effects = run(state, r.Opened(2, opened))
    assert effects == [e.OpenScene(4, state.request, DEFAULT)] and state.request.things == (Thing("pen_001"),)
    state, _ = run(state, r.Opened(4, opened))
    assert not state.opening and state.scene is opened


def test_a_new_scene_lets_go_what_was_known(shown, opened, attempt):
    tried, _ = run(shown, r.Tried(1, shown.choice, (attempt(),)), a.AnotherPose())
    state, effects = run(tried, r.Opened(2, opened))
    assert state.trials == {} and state.playback is None and state.choice == Choice(0, 0)
    assert effects == [e.ExpectTrial(2, opened, Choice(0, 0))]


def test_a_link_selects_its_candidate(shown, opened):
    state, _ = run(replace(shown, making=1, wanted=Choice(0, 2)), r.Opened(1, opened))
    assert state.choice == Choice(0, 2)
    state, _ = run(replace(shown, making=1, wanted=Choice(0, 99)), r.Opened(1, opened))
    assert state.choice == Choice(0, 0)


def test_a_plan_without_candidates_selects_nothing(shown, empty_scene):
    state, effects = run(replace(shown, making=1), r.Opened(1, empty_scene))
    assert state.choice is None and effects == []


def test_failures_are_told_and_leave_the_scene(shown):
    state, effects = run(shown, a.ShowObject("pen_000"), r.OpenFailed(2, "no such object"))
    assert state.failure == "no such object" and state.scene is shown.scene and effects[-1].tone == "error"


def test_settings_of_planning_see_the_known_scene_anew(shown):
    state, effects = run(shown, a.Change("threshold", 0.25))
    assert effects == [e.SeeScene(2, shown.request, state.setup, None)] and state.setup.threshold == 0.25


def test_another_gripper_makes_the_scene_anew(shown):
    _, effects = run(shown, a.Change("gripper", "compact"))
    assert isinstance(effects[0], e.OpenScene)


def test_a_sight_replaces_what_was_seen(shown, sight):
    state, _ = run(shown, a.Change("threshold", 0.25))
    fresh = sight()
    state, _ = run(state, r.Seen(2, state.request, state.setup, fresh, None, 5.0))
    assert state.scene.sight is fresh and state.scene.setup.threshold == 0.25 and not state.opening
    assert state.scene.scene.objects == shown.scene.scene.objects


def test_settings_of_trials_plan_nothing_but_forget_trials(shown, attempt):
    tried, _ = run(shown, r.Tried(1, shown.choice, (attempt(),)))
    state, effects = run(tried, a.Change("sigma_p", 0.0))
    assert effects == [] and state.trials == {} and state.scene.setup.sigma_p == 0
    late, _ = run(state, r.Tried(1, shown.choice, (attempt(),)))
    assert late.trials == {}, "an answer with the old noise"


@pytest.mark.parametrize(("name", "value"), [("threshold", 5), ("planner", "x"), ("what", 1)])
def test_bad_settings_are_told(shown, name, value):
    state, effects = run(shown, a.Change(name, value))
    assert state is shown and effects[0].tone == "warning"


def test_the_planner_beside_may_go(shown):
    two = replace(shown, setup=msgspec.structs.replace(DEFAULT, beside="random"), choice=Choice(1, 0))
    state, _ = run(two, a.Change("beside", ""))
    assert state.choice is None
    assert run(two, a.ResetSetup())[0].setup == DEFAULT and run(shown, a.ResetSetup()) == (shown, [])


def test_own_images_have_no_poses(shown):
    own = replace(shown, request=SceneRequest((), 1, Photo("image-1")))
    assert run(own, a.AnotherPose())[1][0].title == "An own image"
    assert run(own, a.AddObject(1))[0].request.things, "an object comes in its place"
