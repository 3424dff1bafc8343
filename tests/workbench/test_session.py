import threading
import time

import pytest

from workbench import actions as a
from workbench import session as module
from workbench.session import Session, Sessions

TOKEN = "0" * 32


class Screen:
    def __init__(self):
        self.updates = []
        self.notices = []

    def update(self, old, new):
        self.updates.append((old, new))

    def perform(self, effect):
        if isinstance(effect, a.Notice):
            self.notices.append(effect)
            return True
        return False


def step(session, now):
    """What the app does on each tick."""
    found = session.step(now)
    session.show()
    return found


@pytest.fixture
def session(shell):
    return Session(TOKEN, shell, shell.first({}), lambda: None)


def test_actions_wait_for_the_step(session, count, ring):
    screen, before = Screen(), session.state
    session.attach(screen)
    session.post(count(10))
    assert session.state is before
    effects, _ = step(session, 0.0)
    assert session.state.of["count"] == 10
    assert effects == (ring(True),)
    assert len(screen.updates) == 1 and screen.updates[0][0] is None


def test_a_step_without_news_sends_nothing(session):
    screen = Screen()
    session.attach(screen)
    step(session, 0.0)
    step(session, 1.0)
    assert len(screen.updates) == 1


def test_a_new_screen_gets_everything(session, count):
    session.attach(Screen())
    step(session, 0.0)
    session.attach(None)
    session.post(count(20))
    step(session, 1.0)
    screen = Screen()
    session.attach(screen)
    step(session, 2.0)
    old, new = screen.updates[0]
    assert old is None and new.of["count"] == 20, "what happened meanwhile is there after a reload"


def test_notices_go_to_the_screen_or_to_others_when_nobody_looks(session):
    session.post(a.Notice("info", "a", "b"))
    assert step(session, 0.0)[0] == (a.Notice("info", "a", "b"),)
    screen = Screen()
    session.attach(screen)
    session.post(a.Notice("info", "c", "d"))
    assert step(session, 1.0)[0] == ()
    assert screen.notices == [a.Notice("info", "c", "d")]


def test_ticks_come_on_absolute_deadlines(session, count):
    session.post(count(1))
    now = 100.0
    _, due = step(session, now)
    first = due
    for _count in range(2):
        _, due = step(session, due + 0.004)  # each wake is a little late
    assert due == pytest.approx(first + 2 * module.FRAME)
    assert session.state.of["count"] == 4
    _, due = step(session, due)
    assert session.state.of["count"] == 5
    assert step(session, now + 60)[1] is None, "the view wants no more ticks"


def test_posting_wakes(shell):
    woken = []
    session = Session(TOKEN, shell, shell.first({}), lambda: woken.append(1))
    session.post(a.ToggleTheme())
    assert woken == [1]


@pytest.fixture
def sessions(shell):
    return Sessions(shell, lambda: None)


def test_what_a_browser_kept_is_taken_up(sessions):
    session, _ = sessions.claim(None, {"count": {"value": 4}, "dark": False})
    assert session.state.of["count"] == 4 and not session.state.dark


def test_a_browser_that_comes_back_finds_its_session(sessions):
    first, new = sessions.claim(None, {})
    assert new
    first.attach(None)
    again, new = sessions.claim(first.token, {})
    assert again is first and not new


def test_a_second_tab_gets_its_own(sessions):
    first, _ = sessions.claim(None, {})
    other, new = sessions.claim(first.token, {})
    assert new and other is not first


@pytest.mark.parametrize("token", ["", "x" * 32, "../../etc", "0" * 5000, TOKEN])
def test_unknown_tokens_get_a_new_session(sessions, token):
    session, new = sessions.claim(token, {})
    assert new and session.token != token


def test_browsers_that_left_are_forgotten(sessions, monkeypatch):
    first, _ = sessions.claim(None, {})
    first.attach(None)
    monkeypatch.setattr(module, "KEEP", -1.0)
    sessions.claim(None, {})
    assert first not in sessions.all()


def test_not_all_browsers_that_left_are_remembered(sessions, monkeypatch):
    monkeypatch.setattr(module, "MOST", 3)
    for _ in range(6):
        session, _ = sessions.claim(None, {})
        session.attach(None)
        time.sleep(0.002)
    sessions.claim(None, {})
    assert len(sessions.all()) == 4


def test_claims_from_many_threads_are_distinct(sessions):
    found = []
    threads = [threading.Thread(target=lambda: found.append(sessions.claim(TOKEN, {})[0])) for _ in range(20)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len({session.token for session in found}) == 20
