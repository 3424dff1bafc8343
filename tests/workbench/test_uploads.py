from types import SimpleNamespace

import pytest

from workbench.uploads import Limiter


class Gui:
    """viser's side of an upload, as far as a limiter touches it."""

    def __init__(self):
        self._websock_interface = self
        self._current_file_upload_states = {}
        self.replaced, self.finished, self.sent = [], [], []

    def unregister_handler(self, message):
        self.replaced.append(message)

    def register_handler(self, message, handler):
        pass

    def queue_message(self, message):
        self.sent.append(message)

    def _handle_file_transfer_start(self, client, message):
        self._current_file_upload_states[message.transfer_uuid] = {"left": message.part_count}

    def _handle_file_transfer_part(self, client, message):
        state = self._current_file_upload_states[message.transfer_uuid]
        state["left"] -= 1
        if not state["left"]:
            self._current_file_upload_states.pop(message.transfer_uuid)
            self.finished.append(message.transfer_uuid)


def start(size, parts, transfer="t", button="b"):
    return SimpleNamespace(
        source_component_uuid=button, transfer_uuid=transfer, filename="f", size_bytes=size, part_count=parts
    )


def part(content, transfer="t"):
    return SimpleNamespace(source_component_uuid="b", transfer_uuid=transfer, part_index=0, content=content)


@pytest.fixture
def gui():
    return Gui()


@pytest.fixture
def refused():
    return []


@pytest.fixture
def limiter(gui, refused):
    made = Limiter(SimpleNamespace(gui=gui))
    made.limit("b", 100, refused.append)
    return made


def test_a_file_within_the_limit_arrives(limiter, gui, refused):
    limiter.starts(0, start(6, 2))
    limiter.continues(0, part(b"abc"))
    limiter.continues(0, part(b"def"))
    assert gui.finished == ["t"] and refused == [] and len(gui.replaced) == 2


@pytest.mark.parametrize(("size", "parts"), [(101, 1), (-1, 1), (10, 10**9), ("10", 1), (10, None)])
def test_too_large_and_malformed_announcements_are_refused(limiter, gui, refused, size, parts):
    limiter.starts(0, start(size, parts))
    limiter.continues(0, part(b"x" * 1000))
    assert len(refused) == 1 and gui._current_file_upload_states == {}
    assert [ack.transferred_bytes for ack in gui.sent] == ([size] if size in (101, 10) else []), (
        "the button is free again"
    )


def test_parts_that_outgrow_the_announcement_end_the_transfer(limiter, gui):
    limiter.starts(0, start(10, 50))
    for _ in range(20):
        limiter.continues(0, part(b"x" * 9))
    assert gui._current_file_upload_states == {} and gui.finished == []


def test_unknown_buttons_and_transfers_are_ignored(limiter, gui):
    limiter.starts(0, start(10, 1, button="other"))
    limiter.continues(0, part(b"x", transfer="other"))
    assert gui._current_file_upload_states == {}


def test_one_file_at_a_time(limiter, gui, refused):
    limiter.starts(0, start(6, 2))
    limiter.starts(0, start(6, 2, transfer="u"))
    assert list(gui._current_file_upload_states) == ["t"] and len(refused) == 1
    limiter.continues(0, part(b"abc"))
    limiter.continues(0, part(b"def"))
    limiter.starts(0, start(6, 2, transfer="u"))
    assert list(gui._current_file_upload_states) == ["u"]
