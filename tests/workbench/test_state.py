import pytest

from workbench.actions import Action, Arrive, Notice, ShowView, Tick, ToggleTheme
from workbench.state import Shell


def test_a_view_reduces_its_own_actions(shell, count, ring):
    state, effects = shell.reduce(shell.first({}), count(9))
    assert state.of == {"count": 9, "other": 0} and effects == (ring(True),)


def test_the_first_view_is_shown_unless_told_otherwise(shell):
    state = shell.first({})
    assert state.view == "count" and state.dark
    assert shell.reduce(state, ShowView("other"))[0].view == "other"
    assert shell.reduce(state, ShowView("none"))[0] is state


def test_what_a_browser_claims_to_have_kept_may_be_anything(shell):
    for kept in ({"dark": "no"}, {"count": 5}, {"count": None}, {"count": [1]}):
        assert shell.first(kept).of["count"] == 0 and shell.first(kept).dark


def test_a_link_chooses_view_and_state(shell, ring):
    state, effects = shell.reduce(shell.first({}), Arrive("view=other&value=3&fixedDpr=1"))
    assert state.view == "other" and state.of == {"count": 3, "other": 3}
    assert effects == (ring(False), ring(True))
    assert shell.link(state) == "view=other&value=3"


def test_a_reload_of_what_is_shown_changes_nothing(shell, count):
    state, _ = shell.reduce(shell.first({}), Arrive(""))
    state, _ = shell.reduce(state, count(2))
    again, effects = shell.reduce(state, Arrive("view=count&value=2&fixedDpr=1"))
    assert again.of is state.of and effects == ()


def test_a_link_to_an_unknown_view_is_told(shell):
    state, effects = shell.reduce(shell.first({}), Arrive("view=%3Cb%3E"))
    assert state.view == "count" and effects[0].tone == "warning" and "<b>" in effects[0].body


@pytest.mark.parametrize("query", ["x" * 9000, "=&&=%%%", "view=" + "&value" * 60])
def test_nonsense_in_the_address_is_no_error(shell, query):
    assert shell.reduce(shell.first({}), Arrive(query))[0].view == "count"


def test_themes_notices_and_ticks(shell):
    state = shell.first({})
    assert not shell.reduce(state, ToggleTheme())[0].dark
    notice = Notice("info", "a", "b")
    assert shell.reduce(state, notice) == (state, (notice,))
    assert shell.reduce(state, Tick(1.0))[0].of["count"] == 1


def test_an_action_of_no_view_is_an_error(shell):
    with pytest.raises(TypeError, match="Action"):
        shell.reduce(shell.first({}), Action())


def test_views_have_names_of_their_own(counter):
    assert list(Shell([counter]).views) == ["count"]
