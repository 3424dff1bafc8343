from dataclasses import replace
from urllib.parse import parse_qsl, urlencode

import msgspec
import pytest

from workbench.inspector.links import follow, is_link, kept, take_up, to_query
from workbench.inspector.orders import Choice, Photo, SceneRequest, Thing
from workbench.inspector.setup import DEFAULT


def through(state, fresh):
    """What another browser makes of a link to a state."""
    there, refused = follow(fresh, dict(parse_qsl(urlencode(to_query(state)))))
    assert refused == []
    return there


def test_a_link_restores_scene_settings_and_selection(shown, state):
    setup = msgspec.structs.replace(DEFAULT, planner="antipodal", beside="random", threshold=0.25, seed=9)
    things = (Thing("mug_003", 2), Thing("pen_000", 0, (0.1, -0.05, 0.03, 0.7071, 0.0, 0.0, 0.7071), True))
    there = replace(shown, request=SceneRequest(things, 77), setup=setup, choice=Choice(1, 2))
    found = through(there, state)
    assert found.request == there.request and found.setup == setup and found.wanted == Choice(1, 2)


def test_shipped_settings_make_short_links(shown):
    assert to_query(shown) == {"object": "box_003", "place": "1"}


def test_links_to_own_images_name_their_key(shown, state):
    photo = Photo("image-abc", "primesense", (525.0, 525.0, 319.5, 239.5), 0.001)
    assert through(replace(shown, request=SceneRequest((), 1, photo)), state).request.photo == photo


@pytest.mark.parametrize(
    "query",
    [{"object": ""}, {"object": "a," * 20}, {"object": "mug_000", "pose": "1,2"}, {"pose": "-1"}, {"place": "1e9"},
     {"place": "9" * 30}, {"at": "1:2:3"}, {"at": "nan:0:0:1:0:0:0"}, {"at": "0:0:99:1:0:0:0"}, {"at": "0:0:0:0:0:0:0"},
     {"loose": "2"}, {"select": "x"}, {"select": "0"}, {"threshold": "7"}, {"planner": "<b>"}, {"seed": "1.5"},
     {"image": "a", "typed": "1:2"}, {"image": "a", "scale": "x"}],
)  # fmt: skip
def test_words_that_mean_nothing_are_told(state, query):
    there, refused = follow(state, {"place": "7", "opacity": "x", "seed": "3"} | query)
    assert refused and all(why.partition(":")[0] in {*query, "pose", "at"} for why in refused)
    if not {"image", "seed", "place"} & set(query):  # the other words still count
        assert there.request.place == 7 and there.setup.seed == 3


def test_only_words_of_the_inspector_make_a_link():
    assert is_link({"object": "mug_000"}) and is_link({"seed": "1"})
    assert not is_link({"view": "inspect", "fixedDpr": "1"})


def test_a_browser_keeps_its_settings(shown, state):
    setup = msgspec.structs.replace(DEFAULT, threshold=0.25)
    picture = replace(shown.picture, opacity=0.8, colours="turbo", marks=frozenset({"samples"}))
    there = replace(shown, setup=setup, picture=picture, shown=frozenset({"grid"}), speed=2.0, loop=True)
    again = take_up(state, kept(there))
    assert (again.setup, again.picture, again.shown, again.speed, again.loop) == (
        setup, picture, frozenset({"grid"}), 2.0, True,
    )  # fmt: skip
    assert again.request == state.request, "no scene is kept"


@pytest.mark.parametrize(
    "found",
    [{"setup": 5}, {"setup": {"planner": "no"}}, {"opacity": "x"}, {"opacity": 9}, {"shown": 3}, {"marks": {"a": 1}},
     {"speed": [1]}, {"speed": 7}, {"colours": 3}, {"loop": "yes"}, {"shown": ["all"]}],
)  # fmt: skip
def test_nonsense_in_the_storage_is_left_out(state, found):
    again = take_up(state, found)
    assert again.setup == DEFAULT and again.speed == 1.0 and not again.loop
