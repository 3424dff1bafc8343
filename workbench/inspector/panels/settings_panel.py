"""The panel of the settings: each with its unit and a hint."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from workbench.actions import Action
from workbench.bridge import Bridge, Reader
from workbench.casting import put, text
from workbench.inspector import actions as a
from workbench.inspector.setup import FIELDS, Choice, Number, Setup, differences
from workbench.inspector.state import State

READERS: dict[str, Reader] = {
    "reset": lambda argument: a.ResetSetup(),
}
NONE = "(none)"
_GROUPS = {
    "planner": "Planner",
    "gripper, camera": "Gripper and camera",
    "image noise": "Image noise",
    "trial": "Trials in DART",
}


def _label(field: Number | Choice) -> str:
    unit = f" {field.unit}" if isinstance(field, Number) and field.unit else ""
    return field.label + unit


class SettingsPanel:
    """A widget for every setting."""

    def __init__(self, bridge: Bridge, state: State) -> None:
        self._bridge = bridge
        self._widgets: dict[str, Any] = {}
        self._top = bridge.html()
        group = ""
        for name, field in FIELDS.items():
            if field.group != group:
                group = field.group
                bridge.html(f'<div class="gw"><h3>{_GROUPS[group]}</h3></div>')
            self._widgets[name] = self._widget(name, field, state.setup)
        bridge.command("All settings as shipped", None, a.ResetSetup, "Forget what was changed")

    def _widget(self, name: str, field: Number | Choice, setup: Setup) -> Any:
        if isinstance(field, Choice):
            options = (NONE, *field.options) if name == "beside" else field.options
            return self._bridge.dropdown(_label(field), options, _shown(name, setup), _chosen(name), field.hint)
        value = _shown(name, setup)
        low, high = field.low * field.scale, field.high * field.scale
        return self._bridge.slider(
            _label(field), low, high, field.step, value, _moved(name, field), f"{field.hint} ({low:g} to {high:g})"
        )

    def update(self, old: State | None, new: State) -> None:
        """Show `new`."""
        if old is not None and old.setup == new.setup:
            return
        for name, widget in self._widgets.items():
            put(widget, value=_shown(name, new.setup))
        other = differences(new.setup)
        told = "changed: " + ", ".join(_label(FIELDS[name]) for name in other) if other else "all as shipped"
        buttons = (
            self._bridge.button("As shipped", "reset:", hint="forget what was changed", off=not other),
            self._bridge.button("Light or dark", "theme:", hint="the theme (L)"),
            self._bridge.button("Keys", "keys:", hint="every hotkey (H)"),
        )
        row = f'<div class="gw-bar gw-small">{"".join(buttons)}</div>'
        put(self._top, content=f'<div class="gw">{row}<small>{text(told)}</small></div>')


def _shown(name: str, setup: Setup) -> Any:
    value, field = getattr(setup, name), FIELDS[name]
    if isinstance(field, Choice):
        return value or NONE
    return round(float(value * field.scale), 6)


def _chosen(name: str) -> Callable[[str], Action]:
    return lambda value: a.Change(name, "" if value == NONE else value)


def _moved(name: str, field: Number) -> Callable[[float], Action]:
    whole = field.step >= 1 and field.scale == 1
    return lambda value: a.Change(name, round(value) if whole else round(value / field.scale, 7))
