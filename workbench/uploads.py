"""Limits on what a browser may upload; viser itself takes files of any size and keeps them in memory.

A transfer is watched from its announcement on, so that a file that is too large is refused before it arrives, and one
whose parts outgrow what it announced is dropped.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import viser
from viser import _messages

PARTS = 4096
"""A transfer has at most so many parts."""


class Limiter:
    """Stands in front of the uploads of one browser.

    Args:
        client: viser's handle.
    """

    def __init__(self, client: viser.ClientHandle) -> None:
        self._gui: Any = client.gui
        self._limits: dict[str, tuple[int, Callable[[str], None]]] = {}
        self._running: dict[str, list[int]] = {}
        link = client.gui._websock_interface
        for message, handler in (
            (_messages.FileTransferStartUpload, self.starts),
            (_messages.FileTransferPart, self.continues),
        ):
            link.unregister_handler(message)
            link.register_handler(message, handler)

    def limit(self, button: str, most: int, refused: Callable[[str], None]) -> None:
        """Take files of at most `most` bytes on the upload button of this id; `refused` is told why others are not."""
        self._limits[button] = (most, refused)

    def starts(self, client_id: Any, message: Any) -> None:
        """A browser announces a file."""
        if message.source_component_uuid not in self._limits:
            return
        most, refused = self._limits[message.source_component_uuid]
        size, parts = message.size_bytes, message.part_count
        if not (isinstance(size, int) and isinstance(parts, int) and 0 <= parts <= PARTS and 0 <= size <= most):
            refused(f"It is larger than {most / 1e6:g} MB. Give a smaller file.")
            self._release(message)
            return
        if self._running:
            refused("Another file is on its way; wait until it is there.")
            self._release(message)
            return
        self._running[message.transfer_uuid] = [size, 0]
        self._gui._handle_file_transfer_start(client_id, message)
        if parts == 0:
            self._running.pop(message.transfer_uuid, None)

    def _release(self, message: Any) -> None:
        """Let the page's upload button end its wait."""
        if isinstance(message.size_bytes, int) and message.size_bytes >= 0:
            ack = _messages.FileTransferPartAck(
                source_component_uuid=message.source_component_uuid,
                transfer_uuid=message.transfer_uuid,
                transferred_bytes=message.size_bytes,
                total_bytes=message.size_bytes,
            )
            self._gui._websock_interface.queue_message(ack)

    def continues(self, client_id: Any, message: Any) -> None:
        """A part of a file comes in."""
        running = self._running.get(message.transfer_uuid)
        if running is None:
            return
        running[1] += len(message.content)
        if running[1] > running[0]:
            self._running.pop(message.transfer_uuid)
            self._gui._current_file_upload_states.pop(message.transfer_uuid, None)
            return
        self._gui._handle_file_transfer_part(client_id, message)
        if message.transfer_uuid not in self._gui._current_file_upload_states:
            self._running.pop(message.transfer_uuid, None)
