"""All that one browser shows: panels and scene, updated together."""

from __future__ import annotations

from typing import Protocol

import viser

from workbench.actions import Effect, Notice
from workbench.bridge import Bridge, Post, Reader
from workbench.orders import Catalogue
from workbench.panels import candidates_panel, scene_panel, trial_panel
from workbench.panels.candidates_panel import CandidatesPanel
from workbench.panels.images_panel import ImagesPanel
from workbench.panels.scene_panel import ScenePanel
from workbench.panels.trial_panel import TrialPanel
from workbench.state import State
from workbench.views.scene3d import Scene3d

READERS: dict[str, Reader] = {**scene_panel.READERS, **candidates_panel.READERS, **trial_panel.READERS}
LEFT = 322
RIGHT = 348
"""Widths of the two columns, pixels."""


class _Part(Protocol):
    def update(self, old: State | None, new: State) -> None: ...


class Screen:
    """The workbench in one browser; made once per connection, then updated in place."""

    def __init__(
        self, client: viser.ClientHandle, post: Post, catalogue: Catalogue, state: State, dataset: str
    ) -> None:
        self._client = client
        gui = client.gui
        with client.atomic():
            bridge = Bridge(client, post, READERS)
            bridge.html(scene_panel.style())
            self._parts: list[_Part] = [ScenePanel(bridge, catalogue, state), ImagesPanel(bridge, catalogue.gripper)]
            column = gui.add_panel()
            with column.add_tab("Grasps", viser.Icon.HAND_GRAB):
                self._parts += [CandidatesPanel(bridge), TrialPanel(bridge, catalogue.attempts, dataset)]
            self._parts.append(Scene3d(bridge, catalogue.gripper))
            gui.main_panel.dock_left()
            gui.main_panel.set_width(LEFT)
            column.dock_right()
            column.set_width(RIGHT)
        self._bridge = bridge

    def update(self, old: State | None, new: State) -> None:
        """Bring what is shown from `old` to `new`."""
        with self._client.atomic():
            for part in self._parts:
                part.update(old, new)

    def perform(self, effect: Effect) -> bool:
        """Show notices; other effects are for others."""
        if not isinstance(effect, Notice):
            return False
        self._bridge.notify(effect.tone, effect.title, effect.body)
        return True
