"""What moves: objects with their gizmo, the gripper, contact forces, and the attempt that it is compared with."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grasp_core.grasp import Grasp
from grasp_core.gripper import Gripper, load_gripper
from workbench import colours
from workbench.bridge import Bridge
from workbench.casting import plain, pose, put
from workbench.inspector.actions import Drag, Grab
from workbench.inspector.drawing import body_at, force_lines, frame_at, shaded
from workbench.inspector.orders import MOST_THINGS, OpenedScene, Try
from workbench.inspector.poses import matrix, vector
from workbench.inspector.state import State
from workbench.tabletop import Body, Shadows, box_corners

_NOTHING = (np.zeros((3, 3), np.float32), np.array([[0, 1, 2]], np.uint32))
_BODIES = ("left_finger", "right_finger", "rod", "base")


class Cast:
    """One set of bodies: objects and a gripper, solid or pale."""

    def __init__(self, bridge: Bridge, root: str, pale: bool) -> None:
        scene = bridge.client.scene
        look: dict[str, Any] = {
            "opacity": 0.35 if pale else None, "visible": False, "cast_shadow": False, "receive_shadow": False,
        }  # fmt: skip
        self._bodies: dict[str, Body] = {}
        boxes = load_gripper().boxes()
        self.objects = [
            scene.add_mesh_simple(
                bridge.node(f"{root}/objects/{slot}"), *_NOTHING, color=colours.GHOST if pale else colours.OBJECT,
                side="double", **look,
            )
            for slot in range(MOST_THINGS)
        ]  # fmt: skip
        self.gripper = {
            name: scene.add_box(
                bridge.node(f"{root}/gripper/{name}"),
                color=colours.GHOST if pale else colours.FINGER if "finger" in name else colours.FRAME,
                dimensions=plain(boxes[name][0].size),
                **look,
            )
            for name in _BODIES
        }

    def dress(self, opened: OpenedScene) -> None:
        """Take the shapes of a scene's objects and gripper."""
        for slot, handle in enumerate(self.objects):
            if slot < len(opened.scene.objects):
                vertices, faces = shaded(opened.scene.objects[slot].asset.mesh)
                put(handle, vertices=vertices, faces=faces)
                self._bodies[f"object_{slot}"] = (
                    handle,
                    [part.vertices for part in opened.scene.objects[slot].asset.parts],
                )
        for name, (box, _) in opened.gripper.boxes().items():
            put(self.gripper[name], dimensions=plain(box.size))
            self._bodies[name] = self.gripper[name], [box_corners(box.size)]

    @property
    def solids(self) -> list[Body]:
        """What casts shadows."""
        return list(self._bodies.values())

    def play(self, attempt: Try, position: float) -> None:
        """Put all bodies where a recording has them at a time, seconds."""
        recording = attempt.recording
        assert recording is not None
        for body, name in enumerate(recording.names):
            handle = self._named(name)
            if handle is not None:
                turn, place = body_at(recording, body, position)
                put(handle, wxyz=turn, position=place, visible=True)

    def _named(self, name: str) -> Any | None:
        if name in self.gripper:
            return self.gripper[name]
        head, _, number = name.partition("_")
        fits = head == "object" and number.isdigit() and int(number) < len(self.objects)
        return self.objects[int(number)] if fits else None

    def stand(self, poses: list[NDArray[np.float64] | None]) -> None:
        """Put the objects where they rest; None hides one."""
        for handle, transform in zip(self.objects, poses, strict=True):
            put(handle, visible=transform is not None)
            if transform is not None:
                turn, place = pose(transform)
                put(handle, wxyz=np.array(turn), position=np.array(place))

    def hold(self, gripper: Gripper, grasp: Grasp | None) -> None:
        """Put the gripper at a grasp, open; None hides it."""
        boxes = gripper.boxes(None if grasp is None else grasp.width)
        for name, handle in self.gripper.items():
            put(handle, visible=grasp is not None)
            if grasp is not None:
                world = grasp.world_from_gripper.copy()
                world[:3, 3] += world[:3, :3] @ boxes[name][1]
                turn, place = pose(world)
                put(handle, wxyz=np.array(turn), position=np.array(place))

    def hide(self) -> None:
        """Show none of it."""
        for handle in (*self.objects, *self.gripper.values()):
            put(handle, visible=False)


class Bodies:
    """Objects, gripper and replay of one browser."""

    def __init__(self, bridge: Bridge) -> None:
        scene = bridge.client.scene
        self._cast = Cast(bridge, "", False)
        self._ghost = Cast(bridge, "/compared", True)
        self._shadows = Shadows(bridge)
        self._forces = scene.add_line_segments(
            bridge.node("/contacts"), points=np.zeros((1, 2, 3), np.float32), colors=colours.FORCE, thickness=0.0016,
            visible=False,
        )  # fmt: skip
        self._gizmo = scene.add_transform_controls(
            bridge.node("/gizmo"),
            scale=0.11,
            line_width=3.0,
            active_axes=(True, True, False),
            depth_test=False,
            opacity=0.85,
            visible=False,
        )
        self._gizmo_from_object = np.eye(3)
        bridge.draggable(self._gizmo, self._dragged)
        self._grabbable = [
            bridge.clickable(handle, lambda: 1, _grab(slot)) for slot, handle in enumerate(self._cast.objects)
        ]
        self._grabbed: int | None = None
        self._dressed: tuple[int, ...] = ()

    def update(self, old: State | None, new: State) -> None:
        """Show `new`."""
        opened = new.scene
        if opened is not None:
            key = (*(id(placed.asset) for placed in opened.scene.objects), hash(opened.gripper.digest))
            if old is None or key != self._dressed:
                self._dressed = key
                self._cast.dress(opened)
                self._ghost.dress(opened)
        self._replay(old, new)
        self._compare(new)
        self._hold(new)
        self._shadows.cast(self._cast.solids)

    def _replay(self, old: State | None, new: State) -> None:
        playback, opened = new.playback, new.scene
        points = None
        if playback is not None and playback.attempt.recording is not None:
            self._cast.play(playback.attempt, playback.position)
            if "contacts" in new.shown:
                before, after, part = frame_at(playback.attempt.recording, playback.position)
                points = force_lines(playback.attempt.recording, after if part >= 0.5 else before)
        elif old is None or _rest(old) != _rest(new):
            self._cast.stand([_pose(new, slot) for slot in range(MOST_THINGS)])
            candidate = new.candidate
            if opened is not None:
                self._cast.hold(opened.gripper, None if candidate is None or new.dragging else candidate.grasp)
        put(self._forces, visible=points is not None)
        if points is not None:
            put(self._forces, points=points)

    def _compare(self, state: State) -> None:
        pinned, playback = state.pinned, state.playback
        if pinned is None or playback is None or playback.attempt is pinned.attempt:
            self._ghost.hide()
        else:
            self._ghost.play(pinned.attempt, playback.position)

    def _dragged(self, turn: Sequence[float], place: Sequence[float], ended: bool) -> Drag:
        world = matrix((*place, *turn))  # type: ignore[arg-type]
        world[:3, :3] @= self._gizmo_from_object
        return Drag(vector(world), ended, time.monotonic())

    def _hold(self, state: State) -> None:
        """The gizmo at the grabbed object; while it is dragged the page itself moves it.

        Where objects slide, its axes are those of the table; where they move freely, those of the object.
        """
        known = state.scene is not None and state.request.things and state.failure is None
        transform = state.pose(state.grabbed) if known else None
        put(self._gizmo, visible=transform is not None and state.playback is None)
        if state.grabbed != self._grabbed:
            self._grabbed = state.grabbed
            for slot, switch in enumerate(self._grabbable):
                switch(slot != state.grabbed)
        free = state.mode == "free"
        put(self._gizmo, active_axes=(True, True, free))
        if transform is None or state.dragging:
            return
        (turn, place), upright = pose(transform), (1.0, 0.0, 0.0, 0.0)
        gizmo = matrix((*self._gizmo.position, *self._gizmo.wxyz))[:3, :3]
        fits = np.allclose(self._gizmo_from_object, np.eye(3)) if free else gizmo[2, 2] > 1 - 1e-6
        if not fits or not np.allclose(gizmo @ self._gizmo_from_object, transform[:3, :3], atol=1e-4):
            self._gizmo_from_object = np.eye(3) if free else transform[:3, :3]
            put(self._gizmo, wxyz=np.array(turn if free else upright))
        if not np.allclose(self._gizmo.position, place, atol=1e-6):
            put(self._gizmo, position=np.array(place))


def _grab(slot: int) -> Callable[[int], Grab]:
    return lambda _: Grab(slot)


def _pose(state: State, slot: int) -> NDArray[np.float64] | None:
    """Where an object stands: as wanted, or where no scene could be made of that, in the one before."""
    if state.scene is None or slot >= len(state.scene.scene.objects):
        return None
    return state.pose(slot) if state.failure is None else state.scene.scene.objects[slot].world_from_object


def _rest(state: State) -> tuple[object, ...]:
    return id(state.scene), state.request.things, state.failure, state.choice, state.playback is None, state.dragging
