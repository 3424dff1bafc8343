"""A thin typed layer between this app and viser.

viser drops a widget's other handlers when one raises and hands through whatever a browser claims a value to be. So:
values are checked on the way in, handlers only enqueue, and an exception in one becomes a notification.
"""

from __future__ import annotations

import logging
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, Literal
from urllib.parse import unquote

import numpy as np
import viser

from grasp_core.errors import GraspError
from workbench.actions import Action, Notice
from workbench.casting import brief, plain, put, sentence, text
from workbench.colours import Themed
from workbench.page import asset, run
from workbench.uploads import Limiter

log = logging.getLogger("workbench")

Post = Callable[[Action], None]
Reader = Callable[[str], Action]
Tone = Literal["info", "warning", "error"]
_TONES: dict[Tone, tuple[int, int, int]] = {"info": (56, 139, 213), "warning": (242, 177, 52), "error": (224, 82, 60)}
_MESSAGE = re.compile(r"([a-z]{1,20}):([A-Za-z0-9_.,;:=&%+~!*'()-]{0,4000}):[0-9]{1,20}")


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


def read_value(argument: str) -> tuple[str, str]:
    """`key=value`, as `Bridge.onvalue` sends it → key and plain value.

    Raises:
        ValueError: anything else.
    """
    key, found, value = argument.partition("=")
    if not found:
        raise ValueError(argument)
    return key, unquote(value, errors="strict").strip()


class Section:
    """Widgets and scene nodes that are shown and hidden together.

    Attributes:
        root: name of the scene node that its nodes hang from.
    """

    def __init__(self, client: viser.ClientHandle, root: str) -> None:
        self.root = root
        self._frame = client.scene.add_frame(root, show_axes=False)
        self._shown = True
        self._handles: list[Any] = []
        self._hidden: list[Any] = []

    @property
    def shown(self) -> bool:
        """Whether the section is shown."""
        return self._shown

    def add(self, handle: Any) -> None:
        """Let a widget belong to this section."""
        self._handles.append(handle)

    def want(self, handle: Any, visible: bool) -> None:
        """Whether a widget is visible while its section is."""
        self._hidden = [other for other in self._hidden if other is not handle] + ([] if visible else [handle])
        put(handle, visible=visible and self._shown)

    def show(self, visible: bool) -> None:
        """Show or hide all of it."""
        self._shown = visible
        put(self._frame, visible=visible)
        for handle in self._handles:
            put(handle, visible=visible and not any(handle is other for other in self._hidden))


class Bridge:
    """One browser: makes its widgets, and turns what happens to them into actions.

    Attributes:
        client: viser's handle.
    """

    def __init__(self, client: viser.ClientHandle, post: Post, readers: Mapping[str, Reader]) -> None:
        self.client = client
        self._post = post
        self._readers = readers
        self._section: Section | None = None
        self._within: Section | None = None
        self._limiter = Limiter(client)
        self._themed: list[tuple[Any, Themed]] = []
        self._keys: list[tuple[str, str, str, Section | None]] = []
        self._inbox = client.gui.add_text("page-messages", "")
        uuid = str(self._inbox._impl.uuid)
        self._inbox.on_update(self._guard(lambda _: self._received(self._inbox.value)))
        client.gui.add_html(
            f'<style>div:has(> div > div > p > label[for="{uuid}"]){{display:none}}</style>'
            f"{run(asset('page.js'), inbox=uuid)}"
        )

    @property
    def hotkeys(self) -> list[tuple[str, str, str]]:
        """(key, name, description) of each command that has a key and works now."""
        return [(key, name, told) for key, name, told, within in self._keys if within is None or within.shown]

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

    @contextmanager
    def section(self, root: str) -> Iterator[Section]:
        """What is made inside belongs to one section; its scene nodes hang from `root`."""
        self._section = self._within = Section(self.client, root)
        try:
            yield self._section
        finally:
            self._section = self._within = None

    def node(self, name: str) -> str:
        """The full name of a scene node of this section."""
        return name if self._section is None else self._section.root + name

    def _own(self, handle: Any) -> Any:
        if self._section is not None:
            self._section.add(handle)
        return handle

    @contextmanager
    def panel(self, tabs: Sequence[tuple[str, Any]], width: int) -> Iterator[list[Any]]:
        """A column docked at the right; gives one tab per (label, icon), to be entered with `with`."""
        column = self._own(self.client.gui.add_panel())
        outer, self._section = self._section, None  # what is in the column hides with it
        try:
            yield [column.add_tab(label, icon) for label, icon in tabs]
        finally:
            self._section = outer
        column.dock_right()
        column.set_width(width)

    def script(self, message: str) -> str:
        """JavaScript that sends `verb:argument`; `{at}` in it stands for a pointer's place on an SVG."""
        if not re.fullmatch(r"[a-z]+:[A-Za-z0-9_.+,:-]*", message):
            raise ValueError(f"no page message: {message}")
        return f"gwSend('{message}')"

    def onclick(self, message: str) -> str:
        """An `onclick` attribute that sends `verb:argument` to this app; for HTML made by this app."""
        return f'onclick="event.stopPropagation();{self.script(message)}"'

    def onpoint(self, verb: str) -> str:
        """An `onclick` attribute for an SVG that sends `verb:u,v`, the place of the click in pixels of its view box."""
        return f"onclick=\"gwSend('{verb}:'+gwAt(this,event))\""

    def onslide(self, verb: str, live: str = "") -> str:
        """Attributes for a range input that sends `verb:value` when let go; `live` is JavaScript for each movement."""
        return f'oninput="{live}" onchange="gwSend(\'{verb}:\'+this.value)"'

    def onvalue(self, verb: str, key: str = "") -> str:
        """An `onchange` attribute for a field or choice that sends `verb:key=value`, to be read with `read_value`."""
        if not re.fullmatch(r"[a-z]+", verb) or not re.fullmatch(r"[a-z]*", key):
            raise ValueError(f"no page message: {verb}:{key}")
        return f"onchange=\"gwSend('{verb}:{key}='+encodeURIComponent(this.value).slice(0,3900))\""

    def onchoice(self, verb: str) -> str:
        """An attribute for a select that sends `verb:value` when another option is chosen."""
        return f"onchange=\"gwSend('{verb}:'+this.value)\""

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
        return self._own(self.client.gui.add_html(content))

    def dropdown(
        self, label: str, options: Sequence[str], value: str, action: Callable[[str], Action], hint: str
    ) -> viser.GuiDropdownHandle:
        """A dropdown; values that are no option are refused."""
        handle = self._own(self.client.gui.add_dropdown(label, tuple(options), initial_value=value, hint=hint))

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
        handle = self._own(
            self.client.gui.add_slider(
                label, min=float(low), max=float(high), step=float(step), initial_value=float(value), hint=hint
            )
        )

        def changed(_: Any) -> None:
            number = handle.value
            if isinstance(number, bool) or not isinstance(number, int | float):
                raise GraspError(f"{label} is a number")
            if not math.isfinite(number) or not handle.min - 1e-9 <= number <= handle.max + 1e-9:
                raise GraspError(f"{label} runs from {handle.min:g} to {handle.max:g}")
            self._post(action(float(number)))

        handle.on_update(self._guard(changed))
        return handle

    def field(self, label: str, value: str, action: Callable[[str], Action], hint: str) -> viser.GuiTextHandle:
        """A line of text, sent when it is left or Enter is pressed; at most 1000 characters."""
        handle = self._own(self.client.gui.add_text(label, value, hint=hint))

        def changed(_: Any) -> None:
            if not isinstance(handle.value, str) or len(handle.value) > 1000:
                raise GraspError(f"{label} is a text of at most 1000 characters")
            self._post(action(handle.value.strip()))

        handle.on_update(self._guard(changed))
        return handle

    def upload(
        self, label: str, kinds: Sequence[str], most: int, action: Callable[[str, bytes], Action], hint: str
    ) -> viser.GuiUploadButtonHandle:
        """A button that takes one file; too large ones, and those of other kinds, are refused.

        Args:
            label: on the button.
            kinds: endings that are taken, as ".stl".
            most: bytes.
            action: takes the file's name and content.
            hint: shown on hover.
        """
        handle = self._own(
            self.client.gui.add_upload_button(label, mime_type=",".join(kinds), hint=hint, icon=viser.Icon.UPLOAD)
        )

        def refused(why: str) -> None:
            self._post(Notice("warning", "The file was not taken", why))

        self._limiter.limit(str(handle._impl.uuid), most, refused)

        def received(_: Any) -> None:
            name, content = str(handle.value.name), handle.value.content
            if not name.lower().endswith(tuple(kinds)) or len(name) > 255:
                raise GraspError(f"'{name[:60]}' is no {' or '.join(kinds)} file")
            self._post(action(name, content))

        handle.on_upload(self._guard(received))
        return handle

    def command(self, label: str, hotkey: str | None, action: Callable[[], Action], description: str) -> None:
        """An entry of the command palette (Ctrl+K), with a hotkey; that of a section works while it is shown only."""
        key: Any = hotkey
        within = self._within
        if hotkey is not None:
            taken = [key for key, _, _, section in self._keys if section in (None, within) or within is None]
            assert hotkey not in taken, f"two commands have the key {hotkey}"
            self._keys.append((hotkey, label, description, within))
        command = self.client.gui.add_command(label, hotkey=key, description=description)

        def triggered(_: Any) -> None:
            if within is None or within.shown:
                self._post(action())

        command.on_trigger(self._guard(triggered))

    def clickable(
        self, handle: Any, count: Callable[[], int], action: Callable[[int], Action]
    ) -> Callable[[bool], None]:
        """Clicks on one instance of a batched mesh become actions; impossible instances are refused.

        A mesh that is not batched counts as instance 0.

        Returns:
            Switches it off and on again: a mesh that can be clicked keeps the pointer from a gizmo behind it.
        """

        def clicked(event: Any) -> None:
            index = 0 if event.instance_index is None else event.instance_index
            if not isinstance(index, int) or not 0 <= index < count():
                raise GraspError("that is gone; click one that is shown")
            self._post(action(index))

        guarded = self._guard(clicked)
        handle.on_click(guarded)

        def switch(on: bool) -> None:
            handle.remove_click_callback("all")
            if on:
                handle.on_click(guarded)

        return switch

    def draggable(self, handle: viser.TransformControlsHandle, action: Callable[[Any, Any, bool], Action]) -> None:
        """Movements of a gizmo become actions.

        Args:
            handle: the gizmo.
            action: takes orientation (w, x, y, z), position (x, y, z) in metres, and whether the drag has ended.
        """

        def moved(event: Any) -> None:
            wxyz, position = np.asarray(handle.wxyz, float), np.asarray(handle.position, float)
            numbers = np.concatenate([wxyz.reshape(-1), position.reshape(-1)])
            if numbers.shape != (7,) or not np.isfinite(numbers).all() or np.abs(numbers).max() > 10:
                raise GraspError("the page sent a pose that is none; reload the page")
            length = float(np.linalg.norm(wxyz))
            if not 0.5 < length < 2:
                raise GraspError("the page sent a turn that is none; reload the page")
            self._post(action(plain(tuple(wxyz / length)), plain(tuple(position)), event.phase == "end"))

        handle.on_update(self._guard(moved))

    def themed(self, handle: Any, colour: Themed) -> None:
        """Let the colour of a scene node follow the theme; it is made in the dark one."""
        self._themed.append((handle, colour))

    def theme(self, dark: bool) -> None:
        """Give what follows the theme its colour."""
        for handle, colour in self._themed:
            put(handle, color=colour.dark if dark else colour.light)

    def notify(self, tone: Tone, title: str, body: str) -> None:
        """Show a notification, of long texts the beginning; errors stay until they are closed."""
        seconds = {"error": None, "warning": 15.0}.get(tone, 6.0)
        self.client.add_notification(title, brief(sentence(body)), auto_close_seconds=seconds, color=_TONES[tone])
