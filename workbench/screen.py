"""All that one browser shows: the shell's own widgets and those of every view, updated together."""

from __future__ import annotations

import json
import secrets
from collections.abc import Callable

import viser

from workbench.actions import Action, Arrive, Download, Effect, Notice, ShowKeys, ShowView, ToggleTheme
from workbench.bridge import Bridge, Post, Reader
from workbench.casting import put, text
from workbench.page import asset, run, style
from workbench.state import Shell, State

LEFT = 366
"""Width of the left column, pixels."""
READERS: dict[str, Reader] = {
    "arrive": Arrive,
    "view": ShowView,
    "theme": lambda argument: ToggleTheme(),
    "keys": lambda argument: ShowKeys(),
}
_ARRIVED = "location.search.slice(1).replace(/[^A-Za-z0-9_.,;:=&%+~!*'()-]/g,c=>encodeURIComponent(c)).slice(0,4000)"
"""JavaScript: the query that the page was loaded with, in characters that messages may have."""


def arrival(key: str) -> str:
    """HTML that sends the query that the page was loaded with: once per `key`, however often it is put on the page."""
    script = f"if(window.gwCame!=='{key}'){{window.gwCame='{key}';gwSend('arrive:'+{_ARRIVED})}}"
    return run(script)


def address(query: str) -> str:
    """HTML that makes the page's address a link to what it shows; what others put into the address stays."""
    script = (
        "const old=new URLSearchParams(location.search),now=new URLSearchParams(this.dataset.query);"
        "for(const k of ['fixedDpr','websocket'])if(old.has(k))now.set(k,old.get(k));"
        "history.replaceState(null,'','?'+now.toString().replaceAll('%2C',',').replaceAll('%3A',':'))"
    )
    return run(script, query=query)


def pace(moving: bool) -> str:
    """HTML that tells the page whether things move: where there is no GPU, it then draws the scene coarser."""
    return run(f"gwPace({str(moving).lower()})")


class Screen:
    """The workbench in one browser; made once per connection, then updated in place."""

    def __init__(self, client: viser.ClientHandle, post: Post, shell: Shell, state: State) -> None:
        self._client = client
        self._shell = shell
        readers = dict(READERS)
        for view in shell.views.values():
            assert not readers.keys() & view.readers.keys(), f"verbs of {view.name} are taken"
            readers.update(view.readers)
        gui = client.gui
        with client.atomic():
            self._bridge = bridge = Bridge(client, post, readers)
            bridge.html(style())
            bridge.html(run(asset("pace.js")))
            self._pace = bridge.html()
            self._look = bridge.html()
            self._address = bridge.html()
            self._tabs = bridge.html() if len(shell.views) > 1 else None
            self._sections = {}
            self._parts = {}
            for name, view in shell.views.items():
                with bridge.section(f"/{name}") as section:
                    self._parts[name] = view.show(bridge, state.of[name])
                self._sections[name] = section
                bridge.command(f"View: {view.label}", None, _go(name), f"Change to the view {view.label}")
            bridge.command("Dark or light", "L", ToggleTheme, "Change the theme")
            bridge.command("Hotkeys", "H", ShowKeys, "List every hotkey")
            gui.main_panel.dock_left()
            gui.main_panel.set_width(LEFT)
            bridge.html(arrival(secrets.token_hex(4)))
        self._moved = False
        self._kept = ""
        self._arrivals = state.arrivals

    def update(self, old: State | None, new: State) -> None:
        """Bring what is shown from `old` to `new`."""
        with self._client.atomic():
            if old is None or old.dark != new.dark:
                self._theme(new.dark)
            moving = self._shell.moving(new) or self._shell.ticking(new)
            if moving != self._moved:
                self._moved = moving
                put(self._pace, content=pace(moving))
            if old is None or old.view != new.view:
                for name, section in self._sections.items():
                    section.show(name == new.view)
                if self._tabs is not None:
                    put(self._tabs, content=self._tab_row(new))
            same = old is not None and old.view == new.view
            before = old.of[new.view] if old is not None and same else None
            if before is not new.of[new.view]:
                self._parts[new.view].update(before, new.of[new.view])
            # Before a page has arrived, its address is still to be read; browsers take long to change it.
            if new.arrivals > self._arrivals and not self._shell.moving(new):
                put(self._address, content=address(self._shell.link(new)))
        kept = json.dumps(self._shell.keep(new))
        if kept != self._kept:
            self._kept = kept
            self._client.local_storage.set_item("kept", kept)

    def _tab_row(self, state: State) -> str:
        tabs = (
            self._bridge.button(
                text(view.label),
                f"view:{name}",
                look="gw-on" if name == state.view else "",
                more=f'role="tab" aria-selected="{str(name == state.view).lower()}"',
            )
            for name, view in self._shell.views.items()
        )
        return f'<div class="gw"><div class="gw-bar" role="tablist">{"".join(tabs)}</div></div>'

    def _theme(self, dark: bool) -> None:
        self._client.gui.configure_theme(
            dark_mode=dark, show_logo=False, show_share_button=False, brand_color=(56, 139, 213)
        )
        self._bridge.theme(dark)
        put(self._look, content=f'<i class="gw-theme" data-theme="{"dark" if dark else "light"}" hidden></i>')

    def _show_keys(self) -> None:
        rows = "".join(
            f'<div title="{text(told)}"><kbd>{text(key)}</kbd>{text(name)}</div>'
            for key, name, told in sorted(self._bridge.hotkeys, key=lambda row: row[1])
        )
        fly = "W A S D Q E and the arrows fly the camera; the mouse turns, pans, zooms it. Ctrl+K lists every command."
        rest = "Hotkeys rest while a text field or a dropdown has the focus, the arrows while a slider has it."
        modal = self._client.gui.add_modal("Hotkeys")
        with modal:
            self._client.gui.add_html(
                f'<div class="gw"><div class="gw-keylist">{rows}</div><p><small>{fly} {rest}</small></p></div>'
            )
            close = self._client.gui.add_button("Close")
            close.on_click(lambda _: modal.close())

    def perform(self, effect: Effect) -> bool:
        """Show notices and hand out files; other effects are for others."""
        match effect:
            case Notice(tone, title, body):
                self._bridge.notify(tone, title, body)
            case ShowKeys():
                self._show_keys()
            case Download(name, content):
                self._client.send_file_download(name, content, save_immediately=True)
            case _:
                return False
        return True


def _go(name: str) -> Callable[[], Action]:
    return lambda: ShowView(name)
