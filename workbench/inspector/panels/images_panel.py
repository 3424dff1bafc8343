"""The panel of what the planner sees: depth image with candidates, and quality map."""

from __future__ import annotations

from grasp_core.gripper import Gripper
from workbench.bridge import Bridge
from workbench.casting import put
from workbench.inspector.image_view import depth_view, quality_view
from workbench.inspector.state import State


class ImagesPanel:
    """The two views of the selected scene."""

    def __init__(self, bridge: Bridge, gripper: Gripper) -> None:
        self._bridge = bridge
        self._gripper = gripper
        self._views = bridge.html()

    def update(self, old: State | None, new: State) -> None:
        """Show `new`; the pictures are sent when the scene changed only."""
        if old is not None and old.scene is new.scene:
            return
        if new.scene is None:
            inner = '<div class="gw-empty">The depth image and the quality map come with the first plan.</div>'
        else:
            shown = depth_view(new.scene, self._gripper, self._bridge.onclick) + quality_view(new.scene)
            inner = f'<div class="gw-views">{shown}</div>'
        put(self._views, content=f'<div class="gw"><h3>What the planner sees</h3>{inner}</div>')
