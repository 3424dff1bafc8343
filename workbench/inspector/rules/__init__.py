"""What each action does to the state: pure functions from state and action to the next state and effects."""

from __future__ import annotations

from workbench.inspector.rules import drag, files, image, replay, scene, trials
from workbench.inspector.rules.registry import Result, reduce

__all__ = ["Result", "drag", "files", "image", "reduce", "replay", "scene", "trials"]
