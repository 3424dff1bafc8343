"""What stands still: the table, axes of the world, and the camera with its image and what it measured."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from grasp_core.camera import Camera
from workbench import colours
from workbench.bridge import Bridge
from workbench.casting import pose, put
from workbench.inspector.orders import Sight
from workbench.inspector.state import State
from workbench.tabletop import furnish

_MOST_POINTS = 40_000
_AXES: dict[str, Any] = {"axes_length": 0.08, "axes_radius": 0.0015, "origin_radius": 0.003, "visible": False}


class Stage:
    """Table and camera."""

    def __init__(self, bridge: Bridge) -> None:
        scene, node = bridge.client.scene, bridge.node
        scene.set_up_direction("+z")
        scene.configure_environment_map(None)
        scene.configure_default_lights(enabled=False)
        self._grid = furnish(bridge)
        self._world = scene.add_frame(node("/frames/world"), **_AXES)
        self._lens = scene.add_frame(node("/frames/camera"), **_AXES)
        self._camera = scene.add_camera_frustum(
            node("/camera"), fov=0.55, aspect=1.0, scale=0.05, thickness=0.0012, color=(150, 160, 172), visible=False,
            image=np.zeros((2, 2, 3), np.uint8), cast_shadow=False, receive_shadow=False,
        )  # fmt: skip
        self._points = scene.add_point_cloud(
            node("/points"), points=np.zeros((1, 3), np.float32), colors=(255, 255, 255), point_size=0.0012,
            point_shape="circle", precision="float32", visible=False,
        )  # fmt: skip
        self._drawn: tuple[object, ...] = ()

    def update(self, old: State | None, new: State) -> None:
        """Show `new`."""
        opened = new.scene
        camera = None if opened is None else _seen_from(opened.sight)
        drawn = (opened, new.picture.colours, "points" in new.shown, new.dragging)
        if opened is not None and camera is not None and drawn != self._drawn:
            self._drawn = drawn
            self._show(new, opened.sight, camera)
        own = new.request.photo is not None
        put(self._grid, visible="grid" in new.shown)
        put(self._world, visible="frames" in new.shown)
        put(self._lens, visible="frames" in new.shown and camera is not None)
        put(self._camera, visible="camera" in new.shown and camera is not None)
        put(self._points, visible=camera is not None and (own or "points" in new.shown))

    def _show(self, state: State, sight: Sight, camera: Camera) -> None:
        image, k = sight.image, camera.intrinsics
        points = "points" in state.shown or state.request.photo is not None
        if not points and state.dragging:
            return  # the small picture in the camera follows when the object is let go
        near, far = colours.depth_range(image.depth, image.valid)
        picture = colours.depth(image.depth, image.valid, near, far, state.picture.colours)
        step = max(1, image.depth.shape[1] // 320)
        self._camera.image = np.ascontiguousarray(picture[::step, ::step])
        put(self._camera, fov=2 * math.atan(k.height / (2 * k.fy)), aspect=k.width / k.height)
        turn, place = pose(camera.pose)
        for handle in (self._camera, self._lens):
            put(handle, wxyz=np.array(turn), position=np.array(place))
        if points:
            # Of rows and columns alike: every n-th of all pixels would show as stripes.
            every = math.ceil(math.sqrt(image.depth.size / _MOST_POINTS))
            valid = image.valid[::every, ::every]
            put(
                self._points,
                points=np.asarray(image.with_camera(camera).points()[::every, ::every][valid], np.float32),
                colors=np.ascontiguousarray(picture[::every, ::every][valid]),
            )


def _seen_from(sight: Sight) -> Camera | None:
    """The camera with the pose that was given or found; None where none was found."""
    for plan in sight.plans:
        if plan is not None and plan.camera.world_from_camera is not None:
            return plan.camera
    return sight.image.camera if sight.image.camera.world_from_camera is not None else None
