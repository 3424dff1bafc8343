import json

import pytest

from workbench.actions import Download, Effect, Notice, ShowKeys
from workbench.screen import READERS, Screen, address, arrival


@pytest.fixture
def screen(client, posted, shell):
    return Screen(client, posted.append, shell, shell.first({}))


def test_views_are_made_once_and_updated_in_place(client, posted, shell, counter, screen):
    made = len(client.made)
    first = shell.first({})
    second = first.having("count", 3)
    screen.update(None, first)
    screen.update(first, second)
    assert counter.shown == [(None, 0), (0, 3)]
    assert len(client.made) == made and posted == []


def test_one_view_is_shown_at_a_time(client, shell, screen):
    from dataclasses import replace

    first = shell.first({})
    screen.update(None, first)
    frames = {handle.label: handle for handle in client.made if handle.kind == "add_frame"}
    assert frames["/count"].visible and not frames["/other"].visible
    screen.update(first, replace(first, view="other"))
    assert frames["/other"].visible and not frames["/count"].visible
    hidden = [handle for handle in client.made if handle.kind == "html" and not handle.visible]
    assert [handle.content for handle in hidden] == ["made count"]
    assert 'aria-selected="true"' in client.page() and "view:other" in client.page()


def test_notices_are_shown_files_handed_out_and_other_effects_left_alone(client, screen):
    assert screen.perform(Notice("info", "Title", "Body")) and client.notices == [("Title", "Body.")]
    assert screen.perform(Download("a.html", b"x")) and client.files == [("a.html", b"x")]
    assert not screen.perform(Effect())


def test_the_browser_keeps_what_its_views_want_kept(client, shell, screen):
    first = shell.first({})
    screen.update(None, first.having("count", 7))
    assert json.loads(client.kept["kept"]) == {"dark": True, "count": {"value": 7}, "other": {"value": 0}}


def test_the_theme_follows(client, shell, screen):
    from dataclasses import replace

    first = shell.first({})
    screen.update(None, first)
    screen.update(first, replace(first, dark=False))
    assert [theme["dark_mode"] for theme in client.themes] == [True, False]
    assert 'data-theme="light"' in client.page()


def test_the_address_waits_for_the_end_of_a_movement_and_the_page_draws_coarser_meanwhile(client, shell, screen):
    from dataclasses import replace

    still = replace(shell.first({}), arrivals=1)
    screen.update(None, still)
    assert "value=0" in client.page() and "gwPace(true)" not in client.page()
    moved = still.having("count", 9)
    screen.update(still, moved)
    assert "value=9" not in client.page() and "gwPace(true)" in client.page()
    let_go = still.having("count", 10)
    screen.update(moved, let_go)
    assert "value=10" in client.page() and "gwPace(false)" in client.page()


def test_the_query_of_the_page_is_sent_once_it_is_loaded(client, screen):
    assert "arrive:" in client.page() and "encodeURIComponent" in client.page()
    page = arrival("abc")
    assert page.count("gwSend") == 1 and page.index("gwCame!==") < page.index("gwSend"), "once, though put there twice"


def test_the_address_is_escaped():
    page = address('view=count&value="><script>')
    assert "<script>" not in page and "&quot;&gt;" in page


def test_the_verbs_of_the_shell():
    assert set(READERS) == {"arrive", "view", "theme", "keys"}


def test_every_hotkey_is_listed(client, screen):
    assert screen.perform(ShowKeys())
    assert "<kbd>H</kbd>Hotkeys" in client.page() and "<kbd>L</kbd>Dark or light" in client.page()
