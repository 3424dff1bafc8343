from dataclasses import replace

import pytest

from workbench.inspector import effects as e
from workbench.inspector.orders import SceneRequest, Thing
from workbench.inspector.state import Playback
from workbench.inspector.view import READERS, Inspector


class Desk:
    def perform(self, post, effect):
        return True


@pytest.fixture
def inspector(catalogue, state):
    return Inspector(Desk(), catalogue, state.request)


def test_a_new_page_opens_the_first_scene_once(inspector, state):
    first = inspector.first({})
    opening, effects = inspector.arrive(first, {}, True)
    assert [type(effect) for effect in effects] == [e.OpenScene] and effects[0].request == state.request
    assert inspector.arrive(opening, {}, True) == (opening, ())


def test_a_link_opens_its_scene(inspector):
    state, effects = inspector.arrive(inspector.first({}), {"object": "mug_001", "seed": "4"}, True)
    assert state.request.things == (Thing("mug_001"),) and effects[0].setup.seed == 4


def test_a_link_to_another_view_is_none_of_its_business(inspector):
    state, _ = inspector.arrive(inspector.first({}), {"object": "mug_001"}, False)
    assert state.request != SceneRequest((Thing("mug_001"),))


def test_words_of_a_link_that_are_not_understood_are_left_out_and_told(inspector, shown):
    state, effects = inspector.arrive(inspector.first({}), {"object": "mug_001", "seed": "<b>"}, True)
    assert state.making is not None and effects[-1].tone == "warning" and "seed" in effects[-1].body
    assert state.request.things[0].name == "mug_001"
    again, effects = inspector.arrive(shown, {"pose": "x"}, True)
    assert again is shown and len(effects) == 1


def test_ticks_are_wanted_while_a_replay_runs(inspector, shown, attempt):
    playing = replace(shown, playback=Playback(shown.choice, attempt()))
    assert inspector.ticking(playing) and not inspector.ticking(shown)


def test_what_is_kept_comes_back(inspector, shown):
    there = replace(shown, loop=True)
    assert inspector.first(inspector.keep(there)).loop and inspector.link(there)["object"] == "box_003"


def test_every_message_has_one_reader():
    from workbench.inspector.panels import (
        candidates_panel,
        images_panel,
        inputs_panel,
        scene_panel,
        settings_panel,
        trial_panel,
    )  # fmt: skip

    parts = (candidates_panel, images_panel, inputs_panel, scene_panel, settings_panel, trial_panel)
    assert len(READERS) == sum(len(part.READERS) for part in parts)


def test_all_of_it_is_shown_in_every_state(inspector, bridge, client, shown, state, empty_scene, attempt, scores):
    from workbench.inspector.orders import Place
    from workbench.inspector.state import Pinned, Sweep

    with bridge.section("/inspect"):
        part = inspector.show(bridge, state)
    made, old = len(client.made), None
    playing = replace(shown, playback=Playback(shown.choice, attempt()), pinned=Pinned(shown.choice, 0.5, attempt(1)))
    asked = replace(shown, place=Place(5.0, 6.0, None, 0.1, scores(5.0, 6.0)))
    states = [state, shown, asked, playing, replace(shown, sweep=Sweep(0, (1,), 3), by_physics=True), shown,
              replace(shown, scene=empty_scene, choice=None), replace(state, failure="no"), state]  # fmt: skip
    for new in states:
        part.update(old, new)
        old = new
    assert len(client.made) == made, "handles are kept and updated in place"


def test_no_hotkey_flies_the_camera_or_stands_twice(inspector, bridge, state):
    with bridge.section("/inspect"):
        inspector.show(bridge, state)
    keys = [key for key, _, _ in bridge.hotkeys]
    assert len(keys) == len(set(keys)) > 15 and not set(keys) & set("WASDQE")
