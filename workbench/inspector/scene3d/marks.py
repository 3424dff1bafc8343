"""What is drawn about grasps: all candidates as small grippers, the axes of the selected one, the place asked about."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grasp_core.gripper import load_gripper
from workbench import colours
from workbench.bridge import Bridge
from workbench.casting import put
from workbench.inspector.actions import Select
from workbench.inspector.drawing import batch, fork
from workbench.inspector.orders import Choice
from workbench.inspector.state import State


class Marks:
    """Candidates of one browser."""

    def __init__(self, bridge: Bridge) -> None:
        scene = bridge.client.scene
        self._count = 0
        self._side = 0
        small = fork(load_gripper())
        turns, places = batch([], ())
        self._forks = scene.add_batched_meshes_simple(
            bridge.node("/candidates"), np.asarray(small.vertices, np.float32), np.asarray(small.faces, np.uint32),
            turns, places, batched_colors=np.array([[255, 255, 255]], np.uint8), lod="off", cast_shadow=False,
            receive_shadow=False, flat_shading=True,
        )  # fmt: skip
        bridge.clickable(self._forks, lambda: self._count, lambda index: Select(Choice(self._side, index)))
        self._axes = scene.add_frame(
            bridge.node("/frames/grasp"), axes_length=0.05, axes_radius=0.0012, origin_radius=0.0025, visible=False
        )
        self._asked = scene.add_icosphere(
            bridge.node("/asked"), radius=0.004, color=(255, 255, 255), visible=False, cast_shadow=False
        )

    def update(self, old: State | None, new: State) -> None:
        """Show `new`."""
        if old is None or _drawn(old) != _drawn(new):
            self._show(new)
        put(self._forks, visible="candidates" in new.shown and bool(new.candidates))
        # Never None: between opaque and transparent the page compiles another shader, which delays the first frame.
        put(self._forks, opacity=1.0 if new.playback is None else 0.35)
        candidate = new.candidate
        put(self._axes, visible="frames" in new.shown and candidate is not None)
        if candidate is not None:
            half = candidate.grasp.angle / 2
            put(
                self._axes,
                wxyz=np.array([math.cos(half), 0.0, 0.0, math.sin(half)]),
                position=np.array(candidate.grasp.position, float),
            )
        place = None if new.place is None else new.place.scores
        put(self._asked, visible=place is not None)
        if place is not None:
            x, y, _ = place.candidates[0].grasp.position
            put(self._asked, position=np.array([x, y, place.height]))

    def _show(self, state: State) -> None:
        self._count, self._side = len(state.candidates), state.side
        visible = set(state.visible)
        hidden = [i for i in range(self._count) if i not in visible]
        if state.choice is not None and not state.dragging:
            hidden.append(state.choice.index)
        turns, places = batch([candidate.grasp for candidate in state.candidates], hidden)
        put(self._forks, batched_wxyzs=turns, batched_positions=places, batched_colors=tints(state))


def tints(state: State) -> NDArray[np.uint8]:
    """RGB (N, 3) of the candidates: of their score, or of their quality in physics."""
    found: list[Any] = []
    for index, candidate in enumerate(state.candidates):
        if not state.by_physics:
            found.append(colours.score(candidate.score))
            continue
        trial = state.trials.get(Choice(state.side, index))
        quality = None if trial is None else trial.quality
        found.append(np.array(colours.UNKNOWN, np.uint8) if quality is None else colours.score(quality))
    return colours.lit(np.array(found or [(255, 255, 255)], np.uint8))


def _drawn(state: State) -> tuple[object, ...]:
    physics = state.trials if state.by_physics else None
    return id(state.scene), state.choice, state.least, state.dragging, state.by_physics, physics
