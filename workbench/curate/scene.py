"""The sample in 3D: table, objects, the gripper at the grasp, the edited one, and replays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from grasp_core.grasp import Grasp
from grasp_core.gripper import Gripper
from workbench import colours
from workbench.bridge import Bridge
from workbench.casting import plain, pose, put
from workbench.curate.state import Playing, State
from workbench.inspector.drawing import body_at, fork, shaded
from workbench.tabletop import Body, Shadows, box_corners, furnish

_MOST_OBJECTS = 8


class SampleScene:
    """The scene of one browser."""

    def __init__(self, bridge: Bridge, gripper: Gripper) -> None:
        self._gripper = gripper
        scene = bridge.client.scene
        furnish(bridge)
        self._shadows = Shadows(bridge)
        nothing = (np.zeros((3, 3), np.float32), np.array([[0, 1, 2]], np.uint32))
        self._objects = [
            scene.add_mesh_simple(
                bridge.node(f"/objects/{slot}"), *nothing, color=colours.OBJECT, visible=False, side="double"
            )
            for slot in range(_MOST_OBJECTS)
        ]
        self._parts = {
            name: scene.add_box(
                bridge.node(f"/gripper/{name}"),
                color=colours.FINGER if "finger" in name else colours.FRAME,
                dimensions=box.size,
                position=plain(tuple(centre)),
                visible=False,
            )
            for name, (box, centre) in gripper.boxes().items()
        }
        self._bodies: dict[str, Body] = {
            name: (self._parts[name], [box_corners(box.size)]) for name, (box, _) in gripper.boxes().items()
        }
        small = fork(gripper)
        self._before = scene.add_mesh_simple(
            bridge.node("/before"),
            np.asarray(small.vertices, np.float32),
            np.asarray(small.faces, np.uint32),
            color=colours.FRAME,
            visible=False,
        )

    def update(self, old: State | None, new: State) -> None:
        """Show `new`; only what differs from `old` is sent."""
        self._show(old, new)
        self._shadows.cast(list(self._bodies.values()))

    def _show(self, old: State | None, new: State) -> None:
        before = None if old is None else old.sample
        if new.sample is None:
            for handle in (*self._objects, *self._parts.values(), self._before):
                put(handle, visible=False)
            return
        if before is None or before.row.scene != new.sample.row.scene:
            for slot, handle in enumerate(self._objects):
                if slot < len(new.sample.scene.objects):
                    asset = new.sample.scene.objects[slot].asset
                    vertices, faces = shaded(asset.mesh)
                    put(handle, vertices=vertices, faces=faces)
                    self._bodies[f"object_{slot}"] = handle, [part.vertices for part in asset.parts]
                put(handle, visible=slot < len(new.sample.scene.objects))
        if new.playing is not None:
            self._show_frame(new.playing)
        elif old is None or old.playing is not None or before is not new.sample or old.edited != new.edited:
            for handle, placed in zip(self._objects, new.sample.scene.objects, strict=False):
                _place(handle, placed.world_from_object)
            self._show_gripper(new.edited or new.sample.row.grasp)
        put(self._before, visible=new.edited is not None)
        if new.edited is not None:
            _place(self._before, new.sample.row.grasp.world_from_gripper)

    def _show_gripper(self, grasp: Grasp) -> None:
        for name, handle in self._parts.items():
            _, centre = self._gripper.boxes(grasp.width)[name]
            world = grasp.world_from_gripper
            world[:3, 3] += world[:3, :3] @ centre
            put(handle, visible=True)
            _place(handle, world)

    def _show_frame(self, playing: Playing) -> None:
        recording = playing.played.recording
        handles = {**self._parts, **{f"object_{slot}": handle for slot, handle in enumerate(self._objects)}}
        for body, name in enumerate(recording.names):
            if name in handles:
                turn, place = body_at(recording, body, playing.position)
                put(handles[name], wxyz=turn, position=place)


def _place(handle: object, transform: NDArray[np.float64]) -> None:
    turn, place = pose(transform)
    put(handle, wxyz=np.array(turn), position=np.array(place))
