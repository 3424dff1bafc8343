from dataclasses import replace

from workbench.actions import Notice, RandomScene
from workbench.screen import READERS, Screen


def test_every_message_has_one_reader():
    from workbench.panels import candidates_panel, scene_panel, trial_panel

    assert len(READERS) == sum(len(part.READERS) for part in (candidates_panel, scene_panel, trial_panel))


def test_the_screen_shows_every_state(client, posted, catalogue, state, shown, empty_scene, attempt):
    screen = Screen(client, posted.append, catalogue, state, "~/data")
    made = len(client.made)
    states = [state, shown, replace(shown, selected=2), replace(shown, scene=empty_scene, selected=None), state]
    old = None
    for new in states:
        screen.update(old, new)
        old = new
    assert len(client.made) == made, "handles are kept and updated in place"
    assert posted == []


def test_notices_are_shown_and_other_effects_left_alone(client, posted, catalogue, state):
    screen = Screen(client, posted.append, catalogue, state, "~/data")
    assert screen.perform(Notice("info", "Title", "Body")) and client.notices == [("Title", "Body")]
    assert not screen.perform(RandomScene(1))
