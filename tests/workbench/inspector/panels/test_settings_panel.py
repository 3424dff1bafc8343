import asyncio
from dataclasses import replace
from types import SimpleNamespace

import msgspec

from workbench.inspector import actions as a
from workbench.inspector.panels.settings_panel import NONE, SettingsPanel
from workbench.inspector.setup import DEFAULT, FIELDS


def fire(handle, value):
    handle.value = value
    for handler in handle.handlers:
        asyncio.run(handler(SimpleNamespace(client_id=0)))


def test_every_setting_has_a_widget_with_its_unit(bridge, client, state):
    SettingsPanel(bridge, state)
    widgets = [handle for handle in client.made if handle.kind in ("slider", "dropdown")]
    assert len(widgets) == len(FIELDS)
    assert client.only("slider", "σ_d mm").value == 1.0 and client.only("slider", "Tilt °").max == 50


def test_widgets_change_settings_in_their_own_units(bridge, client, state, posted):
    SettingsPanel(bridge, state)
    fire(client.only("slider", "σ_p mm"), 4.0)
    fire(client.only("slider", "m pixels"), 12.0)
    fire(client.only("dropdown", "Beside it"), "random")
    fire(client.only("dropdown", "Beside it"), NONE)
    assert posted == [
        a.Change("sigma_p", 0.004),
        a.Change("pixels", 12),
        a.Change("beside", "random"),
        a.Change("beside", ""),
    ]


def test_what_is_changed_is_told(bridge, client, state):
    panel = SettingsPanel(bridge, state)
    panel.update(None, state)
    assert "all as shipped" in client.page()
    other = replace(state, setup=msgspec.structs.replace(DEFAULT, threshold=0.25))
    panel.update(state, other)
    assert "changed: t least" in client.page() and client.only("slider", "t least").value == 0.25
