"""A thin typed layer between this app and viser.

viser disconnects every client when one property cannot be encoded, drops a widget's other handlers when one raises, and
hands through whatever a browser claims a value to be. So: values are cast to builtins on the way out, checked on the
way in, and handlers only enqueue; an exception in one becomes a notification.
"""

from __future__ import annotations

import html
import logging
import math
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, TypeVar

import numpy as np
import viser
from numpy.typing import NDArray

from grasp_core.errors import GraspError
from workbench.actions import Action, Notice

log = logging.getLogger("workbench")

T = TypeVar("T")
Post = Callable[[Action], None]
Reader = Callable[[str], Action]
Tone = Literal["info", "warning", "error"]
_TONES: dict[Tone, tuple[int, int, int]] = {"info": (56, 139, 213), "warning": (242, 177, 52), "error": (224, 82, 60)}


def plain(value: Any) -> Any:
    """`value` in types that viser can encode: builtins, tuples of them, or numeric arrays.

    Raises:
        GraspError: the value holds anything else, or a number that is not finite.
    """
    if isinstance(value, np.ndarray):
        if value.dtype.kind not in "fiub":
            raise GraspError(f"an array of type {value.dtype} cannot be shown")
        return value
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, bool | int | str | bytes):
        return value
    if isinstance(value, float):
        if not math.isfinite(value):
            raise GraspError("a number that is not finite cannot be shown")
        return value
    if isinstance(value, list | tuple):
        return tuple(plain(item) for item in value)
    raise GraspError(f"a {type(value).__name__} cannot be shown")


def put(handle: Any, **properties: Any) -> None:
    """Set properties of a viser handle, cast by `plain`; equal ones are left alone."""
    for name, value in properties.items():
        cast = plain(value)
        if not isinstance(cast, np.ndarray):
            current = getattr(handle, name)
            if not isinstance(current, np.ndarray) and type(current) is type(cast) and current == cast:
                continue
        setattr(handle, name, cast)


def text(value: object) -> str:
    """Any text made safe inside HTML: viser shows HTML unfiltered, and would run what a name smuggles in."""
    return html.escape(str(value), quote=True)


def sentence(words: str) -> str:
    """Words with a capital and a full stop."""
    words = words.strip()
    return words if not words else words[0].upper() + words[1:] + ("" if words[-1] in ".!?" else ".")


def pose(transform: NDArray[np.float64]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """4×4 → (w, x, y, z) and (x, y, z), as viser takes them."""
    rotation = viser.transforms.SO3.from_matrix(np.asarray(transform, float)[:3, :3])
    return plain(tuple(rotation.wxyz)), plain(tuple(np.asarray(transform, float)[:3, 3]))


_MESSAGE = re.compile(r"([a-z]{1,20}):([A-Za-z0-9_.+-]{0,60}):[0-9]{1,20}")


def read_message(value: str, readers: Mapping[str, Reader]) -> Action:
    """The action of one message `verb:argument:nonce` from the page.

    Raises:
        GraspError: malformed, unknown verb, or an argument that its reader refuses.
    """
    match = _MESSAGE.fullmatch(value)
    if match is None or match[1] not in readers:
        raise GraspError("the page sent a message that this workbench does not know; reload the page")
    try:
        return readers[match[1]](match[2])
    except ValueError as error:
        raise GraspError(f"the page sent '{match[1]}' with a bad value; reload the page") from error


class Bridge:
    """One browser: makes its widgets, and turns what happens to them into actions.

    Attributes:
        client: viser's handle.
    """

    def __init__(self, client: viser.ClientHandle, post: Post, readers: Mapping[str, Reader]) -> None:
        self.client = client
        self._post = post
        self._readers = readers
        self._inbox = client.gui.add_text("page-messages", "")
        self._uuid = str(self._inbox._impl.uuid)
        self._inbox.on_update(self._guard(lambda _: self._received(self._inbox.value)))
        style = f'<style>div:has(> div > div > p > label[for="{self._uuid}"]){{display:none}}</style>'
        client.gui.add_html(style)

    def _received(self, value: str) -> None:
        if value:
            self._post(read_message(value, self._readers))

    def _guard(self, handler: Callable[[Any], None]) -> Callable[[Any], Any]:
        async def guarded(event: Any) -> None:
            if getattr(event, "client_id", 0) is None:
                return  # set by this app, not by a person
            try:
                handler(event)
            except GraspError as error:
                self._post(Notice("warning", "That did not work", str(error)))
            except Exception as error:
                log.exception("a handler failed")
                self._post(Notice("error", "Something went wrong here", f"{type(error).__name__}: {error}"))

        return guarded

    def onclick(self, message: str) -> str:
        """An `onclick` attribute that sends `verb:argument` to this app; for HTML made by this app.

        Args:
            message: `verb:argument`, or `verb:` with the rest given by the element's `data-argument`.
        """
        if not re.fullmatch(r"[a-z]+:[A-Za-z0-9_.+-]*", message):
            raise ValueError(f"no page message: {message}")
        script = (
            f"event.stopPropagation();const i=document.querySelector('label[for=&quot;{self._uuid}&quot;]')"
            ".closest('.mantine-Flex-root').querySelector('input');"
            "Object.getOwnPropertyDescriptor(HTMLInputElement.prototype,'value').set.call(i,"
            f"'{message}:'+Math.floor(performance.timeOrigin+performance.now()));"
            "i.dispatchEvent(new Event('input',{bubbles:true}))"
        )
        return f'onclick="{script}"'

    def button(
        self,
        label: str,
        message: str,
        *,
        hint: str = "",
        look: str = "",
        off: bool = False,
        style: str = "",
        more: str = "",
    ) -> str:
        """A button as HTML that sends `message`.

        Args:
            label: HTML made by this app.
            message: as for `onclick`.
            hint: shown on hover, and read out where the label is a sign.
            look: CSS classes.
            off: it cannot be pressed.
            style: CSS.
            more: further attributes.
        """
        title = f' title="{text(hint)}" aria-label="{text(hint)}"' if hint and len(label) < 3 else ""
        if hint and not title:
            title = f' title="{text(hint)}"'
        look = f' class="{look}"' if look else ""
        style = f' style="{style}"' if style else ""
        return (
            f"<button{look}{style}{title} {more} {self.onclick(message)}{' disabled' if off else ''}>{label}</button>"
        )

    def html(self, content: str = "") -> viser.GuiHtmlHandle:
        """A piece of HTML made by this app; every foreign text in it must have gone through `text`."""
        return self.client.gui.add_html(content)

    def dropdown(
        self, label: str, options: Sequence[str], value: str, action: Callable[[str], Action], hint: str
    ) -> viser.GuiDropdownHandle:
        """A dropdown; values that are no option are refused."""
        handle = self.client.gui.add_dropdown(label, tuple(options), initial_value=value, hint=hint)

        def changed(_: Any) -> None:
            if handle.value not in handle.options:
                raise GraspError(f"'{str(handle.value)[:40]}' is none of the choices of {label}")
            self._post(action(str(handle.value)))

        handle.on_update(self._guard(changed))
        return handle

    def slider(
        self,
        label: str,
        low: float,
        high: float,
        step: float,
        value: float,
        action: Callable[[float], Action],
        hint: str,
    ) -> viser.GuiSliderHandle:
        """A slider of numbers; values outside its range are refused."""
        handle = self.client.gui.add_slider(
            label, min=float(low), max=float(high), step=float(step), initial_value=float(value), hint=hint
        )

        def changed(_: Any) -> None:
            number = float(handle.value)
            if not math.isfinite(number) or not handle.min - 1e-9 <= number <= handle.max + 1e-9:
                raise GraspError(f"{label} runs from {handle.min:g} to {handle.max:g}")
            self._post(action(number))

        handle.on_update(self._guard(changed))
        return handle

    def checkbox(self, label: str, value: bool, action: Callable[[bool], Action], hint: str) -> viser.GuiCheckboxHandle:
        """A checkbox."""
        handle = self.client.gui.add_checkbox(label, initial_value=value, hint=hint)
        handle.on_update(self._guard(lambda _: self._post(action(bool(handle.value)))))
        return handle

    def command(self, label: str, hotkey: str | None, action: Callable[[], Action], description: str) -> None:
        """An entry of the command palette (Ctrl+K), with a hotkey."""
        key: Any = hotkey
        command = self.client.gui.add_command(label, hotkey=key, description=description)
        command.on_trigger(self._guard(lambda _: self._post(action())))

    def clickable(self, handle: Any, count: Callable[[], int], action: Callable[[int], Action]) -> None:
        """Clicks on one instance of a batched mesh become actions; impossible instances are refused."""

        def clicked(event: Any) -> None:
            index = event.instance_index
            if not isinstance(index, int) or not 0 <= index < count():
                raise GraspError("that candidate is gone; click one that is shown")
            self._post(action(index))

        handle.on_click(self._guard(clicked))

    def notify(self, tone: Tone, title: str, body: str) -> None:
        """Show a notification; errors stay until they are closed."""
        self.client.add_notification(
            title, body, auto_close_seconds=None if tone == "error" else 6.0, color=_TONES[tone]
        )
