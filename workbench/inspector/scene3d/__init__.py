"""The 3D scene: table, objects with their gizmo, camera, candidates as small grippers, and the replayed gripper."""

from __future__ import annotations

from workbench.bridge import Bridge
from workbench.inspector.scene3d.bodies import Bodies
from workbench.inspector.scene3d.marks import Marks
from workbench.inspector.scene3d.stage import Stage
from workbench.inspector.state import State


class Scene3d:
    """The scene of one browser; `update` brings it from one state to the next."""

    def __init__(self, bridge: Bridge) -> None:
        self._parts = (Stage(bridge), Bodies(bridge), Marks(bridge))

    def update(self, old: State | None, new: State) -> None:
        """Show `new`; only what differs from `old` is sent."""
        for part in self._parts:
            part.update(old, new)
