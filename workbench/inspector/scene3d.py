"""The 3D scene: table, object, camera with its image, all candidates as small grippers, and the gripper itself."""

from __future__ import annotations

import math

import numpy as np
import trimesh
import viser
from numpy.typing import NDArray

from grasp_core.grasp import Grasp
from grasp_core.gripper import Gripper
from grasp_core.simulation.recording import Recording
from workbench import colours
from workbench.bridge import Bridge
from workbench.casting import plain, pose, put
from workbench.inspector.actions import Select
from workbench.inspector.orders import OpenedScene
from workbench.inspector.state import Playback, State

_GRIPPER_PARTS = ("left_finger", "right_finger", "rod", "base")
_MOST_OBJECTS = 8
_MOST_SMOOTHED = 50_000
_METRES_PER_NEWTON = 0.004
_FAR_AWAY = np.array([[0.0, 0.0, -10.0]])


def fork(gripper: Gripper) -> trimesh.Trimesh:
    """A small stand-in for a gripper, in the gripper frame at full opening: two prongs, a bar and a stem, metres."""
    half, up, thin = gripper.opening / 2, gripper.finger.z, 0.0022
    pieces = [
        ((-half, 0, up / 2), (thin, thin, up)),
        ((half, 0, up / 2), (thin, thin, up)),
        ((0, 0, up), (2 * half + thin, thin, thin)),
        ((0, 0, up * 1.3), (thin, thin, up * 0.6)),
    ]
    boxes = []
    for centre, size in pieces:
        box = trimesh.creation.box(size)
        box.apply_translation(centre)
        boxes.append(box)
    return trimesh.Trimesh(
        np.concatenate([box.vertices for box in boxes]),
        np.concatenate([box.faces + 8 * number for number, box in enumerate(boxes)]),
        process=False,
    )


def shaded(mesh: trimesh.Trimesh) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Vertices and faces to be shown: sharp edges are cut apart, so that light does not run round them."""
    if len(mesh.faces) > _MOST_SMOOTHED:
        return np.asarray(mesh.vertices, np.float32), np.asarray(mesh.faces, np.uint32)
    merged = trimesh.Trimesh(mesh.vertices, mesh.faces)  # joins equal corners, without which nothing is smooth
    cut = trimesh.graph.smooth_shade(merged, angle=math.radians(35))
    return np.asarray(cut.vertices, np.float32), np.asarray(cut.faces, np.uint32)


def batch(grasps: list[Grasp], hidden: int | None) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Orientations (N, 4) w x y z and positions (N, 3) of the forks; `hidden` (the selected one) is put far away."""
    if not grasps:
        return np.array([[1, 0, 0, 0]], np.float32), _FAR_AWAY.astype(np.float32)
    turns = np.array([[math.cos(g.angle / 2), 0, 0, math.sin(g.angle / 2)] for g in grasps], np.float32)
    places = np.array([g.position for g in grasps], np.float32)
    if hidden is not None:
        places[hidden] = _FAR_AWAY
    return turns, places


def frame_at(playback: Playback) -> tuple[int, int, float]:
    """The recorded frames before and after the playback's position, and how far between them, 0 to 1."""
    recording = playback.attempt.recording
    assert recording is not None
    times = np.asarray(recording.times, float) - float(recording.times[0])
    after = int(np.clip(np.searchsorted(times, playback.position), 1, max(len(times) - 1, 1)))
    if len(times) < 2:
        return 0, 0, 0.0
    before = after - 1
    span = times[after] - times[before]
    return before, after, float(np.clip((playback.position - times[before]) / span, 0, 1)) if span > 0 else 1.0


def forces(recording: Recording, frame: int) -> NDArray[np.float32] | None:
    """Contact forces on the object in one frame as lines (C, 2, 3), world metres; None without contact."""
    low, high = np.searchsorted(recording.contact_frames, [frame, frame + 1])
    if low == high:
        return None
    points, pushes = recording.contact_points[low:high], recording.contact_forces[low:high]
    return np.stack([points - _METRES_PER_NEWTON * pushes, points], axis=1).astype(np.float32)


class Scene3d:
    """The scene of one browser; `update` brings it from one state to the next."""

    def __init__(self, bridge: Bridge, gripper: Gripper) -> None:
        self._bridge = bridge
        self._gripper = gripper
        self._count = 0
        scene = bridge.client.scene
        scene.set_up_direction("+z")
        scene.configure_environment_map(None)
        scene.configure_default_lights(enabled=False)
        scene.add_light_ambient(bridge.node("/light/all"), color=(255, 255, 255), intensity=0.75)
        scene.add_light_directional(
            bridge.node("/light/sun"), color=(255, 250, 240), intensity=1.9, cast_shadow=True,
            wxyz=plain(tuple(viser.transforms.SO3.from_rpy_radians(0.45, 0.35, 0.0).wxyz)),
        )  # fmt: skip
        scene.add_light_hemisphere(
            bridge.node("/light/sky"), sky_color=(225, 235, 255), ground_color=(70, 66, 60), intensity=0.8
        )
        scene.add_box(
            bridge.node("/table"),
            color=colours.TABLE,
            dimensions=(0.9, 0.9, 0.02),
            position=(0, 0, -0.0105),
            cast_shadow=False,
        )
        scene.add_grid(
            bridge.node("/grid"), 0.9, 0.9, cell_size=0.05, section_size=0.1, cell_color=(74, 79, 86), section_color=(92, 98, 106),
            cell_thickness=0.6, section_thickness=1.0, position=(0, 0, 0.0003), fade_distance=100.0,
        )  # fmt: skip
        nothing = (np.zeros((3, 3), np.float32), np.array([[0, 1, 2]], np.uint32))
        self._objects = [
            scene.add_mesh_simple(
                bridge.node(f"/objects/{slot}"), *nothing, color=colours.OBJECT, visible=False, side="double"
            )
            for slot in range(_MOST_OBJECTS)
        ]
        self._parts = {}
        for name, (box, centre) in gripper.boxes().items():
            colour = colours.FINGER if "finger" in name else colours.FRAME
            self._parts[name] = scene.add_box(
                bridge.node(f"/gripper/{name}"),
                color=colour,
                dimensions=box.size,
                position=plain(tuple(centre)),
                visible=False,
            )
        small = fork(gripper)
        turns, places = batch([], None)
        self._forks = scene.add_batched_meshes_simple(
            bridge.node("/candidates"), np.asarray(small.vertices, np.float32), np.asarray(small.faces, np.uint32), turns, places,
            batched_colors=np.array([[255, 255, 255]], np.uint8), lod="off", cast_shadow=False, receive_shadow=False,
            flat_shading=True,
        )  # fmt: skip
        bridge.clickable(self._forks, lambda: self._count, Select)
        self._forces = scene.add_line_segments(
            bridge.node("/contacts"),
            points=np.zeros((1, 2, 3), np.float32),
            colors=colours.FORCE,
            thickness=0.0016,
            visible=False,
        )
        self._camera = scene.add_camera_frustum(
            bridge.node("/camera"), fov=0.55, aspect=1.0, scale=0.05, thickness=0.0012, color=(150, 160, 172), visible=False,
            image=np.zeros((2, 2, 3), np.uint8), cast_shadow=False, receive_shadow=False,
        )  # fmt: skip

    def update(self, old: State | None, new: State) -> None:
        """Show `new`; only what differs from `old` is sent."""
        fresh = old is None or old.scene is not new.scene
        if fresh and new.scene is not None:
            self._show_objects(new.scene)
            self._show_camera(new.scene)
        if fresh or old is None or old.selected != new.selected:
            self._show_candidates(new)
        put(self._forks, visible="candidates" in new.shown and bool(new.candidates))
        put(self._forks, opacity=None if new.playback is None else 0.35)
        put(self._camera, visible="camera" in new.shown and new.scene is not None)
        self._show_forces(new)
        if new.playback is not None and new.playback.attempt.recording is not None:
            self._show_frame(new.playback)
        elif old is None or old.playback is not new.playback or old.selected != new.selected or fresh:
            self._show_rest(new, moved=old is None or old.playback is not None)

    def _show_objects(self, opened: OpenedScene) -> None:
        for slot, handle in enumerate(self._objects):
            if slot >= len(opened.scene.objects):
                put(handle, visible=False)
                continue
            placed = opened.scene.objects[slot]
            vertices, faces = shaded(placed.asset.mesh)
            put(handle, vertices=vertices, faces=faces, visible=True)
            self._place(handle, placed.world_from_object)

    def _place(self, handle: object, transform: NDArray[np.float64]) -> None:
        turn, place = pose(transform)
        put(handle, wxyz=np.array(turn), position=np.array(place))

    def _show_camera(self, opened: OpenedScene) -> None:
        image = opened.image
        k = image.camera.intrinsics
        near, far = colours.depth_range(image.depth, image.valid)
        self._camera.image = colours.depth(image.depth, image.valid, near, far)
        put(self._camera, fov=2 * math.atan(k.height / (2 * k.fy)), aspect=k.width / k.height)
        self._place(self._camera, image.camera.pose)

    def _show_candidates(self, state: State) -> None:
        self._count = len(state.candidates)
        turns, places = batch([candidate.grasp for candidate in state.candidates], state.selected)
        scores = colours.lit(colours.score([candidate.score for candidate in state.candidates] or [0.0]))
        put(self._forks, batched_wxyzs=turns, batched_positions=places, batched_colors=scores)

    def _show_rest(self, state: State, moved: bool) -> None:
        if state.scene is not None and moved:
            for mesh, placed in zip(self._objects, state.scene.scene.objects, strict=False):
                self._place(mesh, placed.world_from_object)
        chosen = None if state.selected is None else state.candidates[state.selected].grasp
        for name, handle in self._parts.items():
            put(handle, visible=chosen is not None)
            if chosen is not None:
                _, centre = self._gripper.boxes(chosen.width)[name]
                world = chosen.world_from_gripper.copy()
                world[:3, 3] += world[:3, :3] @ centre
                self._place(handle, world)

    def _show_frame(self, playback: Playback) -> None:
        recording = playback.attempt.recording
        assert recording is not None
        before, after, part = frame_at(playback)
        for body, name in enumerate(recording.names):
            handle = self._handle(name)
            if handle is None:
                continue
            start, end = recording.poses[before, body], recording.poses[after, body]
            turn_start, turn_end = start[3:7], end[3:7]
            if float(turn_start @ turn_end) < 0:
                turn_end = -turn_end
            turn = turn_start * (1 - part) + turn_end * part
            put(
                handle,
                position=np.asarray(start[:3] * (1 - part) + end[:3] * part, float),
                wxyz=np.asarray(turn / np.linalg.norm(turn), float),
                visible=True,
            )

    def _show_forces(self, state: State) -> None:
        points = None
        if "contacts" in state.shown and state.playback is not None and state.playback.attempt.recording is not None:
            before, after, part = frame_at(state.playback)
            points = forces(state.playback.attempt.recording, after if part >= 0.5 else before)
        put(self._forces, visible=points is not None)
        if points is not None:
            put(self._forces, points=points)

    def _handle(self, name: str) -> object | None:
        if name in self._parts:
            return self._parts[name]
        head, _, number = name.partition("_")
        if head == "object" and number.isdigit() and int(number) < len(self._objects):
            return self._objects[int(number)]
        return None
