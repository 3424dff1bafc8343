"""The inspector as a view of the workbench."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import viser

from workbench.actions import Action, Effect, Notice
from workbench.bridge import Bridge, Reader
from workbench.inspector import actions as a
from workbench.inspector import links
from workbench.inspector.desk import Desk
from workbench.inspector.orders import Catalogue, SceneRequest
from workbench.inspector.panels import candidates_panel, images_panel, inputs_panel, scene_panel, settings_panel
from workbench.inspector.panels import trial_panel as trials
from workbench.inspector.panels.candidates_panel import CandidatesPanel
from workbench.inspector.panels.images_panel import ImagesPanel
from workbench.inspector.panels.inputs_panel import InputsPanel
from workbench.inspector.panels.scene_panel import ScenePanel
from workbench.inspector.panels.settings_panel import SettingsPanel
from workbench.inspector.panels.trial_panel import TrialPanel
from workbench.inspector.rules import reduce
from workbench.inspector.rules.scene import want
from workbench.inspector.scene3d import Scene3d
from workbench.inspector.state import State
from workbench.view import Part, Post

READERS: dict[str, Reader] = {
    **scene_panel.READERS,
    **images_panel.READERS,
    **candidates_panel.READERS,
    **trials.READERS,
    **settings_panel.READERS,
    **inputs_panel.READERS,
}
RIGHT = 360
"""Width of the right column, pixels."""


class Inspector:
    """See `View`."""

    name = "inspect"
    label = "Inspect"
    actions: type[Action] = a.InspectorAction
    readers: Mapping[str, Reader] = READERS

    def __init__(self, desk: Desk, catalogue: Catalogue, first: SceneRequest) -> None:
        self._desk = desk
        self._catalogue = catalogue
        self._first = first

    def first(self, kept: Mapping[str, Any]) -> State:
        """See `View`."""
        return links.take_up(State(self._catalogue, self._first), kept)

    def arrive(self, state: State, query: Mapping[str, str], shown: bool) -> tuple[State, tuple[Effect, ...]]:
        """See `View`."""
        if shown and links.is_link(query):
            found, refused = links.follow(state, query)
            state, effects = (state, ()) if found is state and state.scene is not None else want(found)
            told = (Notice("warning", "A part of this link was left out", "; ".join(refused)),) if refused else ()
            return state, (*effects, *told)
        if state.scene is not None or state.making is not None:
            return state, ()
        return want(replace(state))

    def reduce(self, state: State, action: Action) -> tuple[State, tuple[Effect, ...]]:
        """See `View`."""
        return reduce(state, action)

    def ticking(self, state: State) -> bool:
        """See `View`."""
        return state.playback is not None and state.playback.playing

    def moving(self, state: State) -> bool:
        """See `View`."""
        return state.dragging

    def link(self, state: State) -> Mapping[str, str]:
        """See `View`."""
        return links.to_query(state)

    def keep(self, state: State) -> Mapping[str, Any]:
        """See `View`."""
        return links.kept(state)

    def show(self, bridge: Bridge, state: State) -> Part:
        """See `View`."""
        return _Inspection(bridge, self._catalogue, state)

    def perform(self, post: Post, effect: Effect) -> bool:
        """See `View`."""
        return self._desk.perform(post, effect)


class _Inspection:
    """Both columns and the scene."""

    def __init__(self, bridge: Bridge, catalogue: Catalogue, state: State) -> None:
        self._parts: list[Part] = [ScenePanel(bridge, catalogue, state), ImagesPanel(bridge)]
        tabs = [("Grasps", viser.Icon.HAND_GRAB), ("Settings", viser.Icon.SETTINGS), ("Inputs", viser.Icon.UPLOAD)]
        with bridge.panel(tabs, RIGHT) as (grasps, settings, inputs):
            with grasps:
                self._parts += [CandidatesPanel(bridge), TrialPanel(bridge)]
            with settings:
                self._parts.append(SettingsPanel(bridge, state))
            with inputs:
                self._parts.append(InputsPanel(bridge, catalogue, state))
        self._parts.append(Scene3d(bridge))

    def update(self, old: State | None, new: State) -> None:
        for part in self._parts:
            part.update(old, new)
