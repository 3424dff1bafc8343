"""Making scenes: objects, how they rest, where they stand, and the camera above them."""

from __future__ import annotations

import ctypes
import re
import sys
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec
import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import Camera, CameraIntrinsics, load_camera, look_down
from grasp_core.errors import GraspError
from grasp_core.gripper import Gripper, load_gripper
from grasp_core.objects.asset import ObjectAsset
from grasp_core.scene import PlacedObject, Scene, place
from grasp_core.simulation.physics import load_physics
from workbench.inspector.orders import Rest, SceneRequest, Thing
from workbench.inspector.poses import matrix, vector
from workbench.inspector.setup import Setup
from workbench.inspector.worker.words import reworded

if TYPE_CHECKING:
    from grasp_core.simulation.settling import StablePose

DROPS = 16
"""Random drops that find an object's stable poses: about a second, where a dataset takes its time."""
SPREAD = 0.04
"""Metres from the table's centre within which one object is placed, along x and y; several have more room."""
_ROOM = (0.06, 0.09, 0.12, 0.15, 0.2, 0.25)
_DRAWS = 60
_SCALES: dict[str, float | str] = {"m": "keep", "mm": 0.001, "cm": 0.01, "paper": "paper"}

Files = Mapping[str, str]
"""Key of an own file → its path."""


def prepare() -> None:
    """Import what is slow to import, so that the first scene does not wait for it alone."""
    import grasp_core.sensing.renderer
    import grasp_core.simulation.trial  # noqa: F401


def file_of(key: str, files: Files) -> Path:
    """Where an own file is.

    Raises:
        GraspError: it is not there any more.
    """
    path = files.get(key)
    if path is None or not Path(path).is_file():
        raise GraspError("this link or setting names an own file that this workbench no longer has; open it again")
    return Path(path)


def give_back() -> None:
    """Hand freed memory back to the system: settling leaves it in pieces, which glibc keeps (malloc_trim(3))."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None) if sys.platform == "linux" else None
    if trim is not None:
        trim(0)


@lru_cache(maxsize=24)
def asset_of(name: str, path: str | None) -> ObjectAsset:
    """An object of the catalogue, or of an own mesh file whose key ends in its unit."""
    from grasp_core.objects.library import catalogue, load_object

    if path is None:
        return catalogue(name)
    unit = name.rpartition("-")[2]
    stem = re.sub(r"^[0-9a-f]{12}--", "", Path(path).stem)  # uploads are kept under their digest
    label = re.sub(r"[^A-Za-z0-9_]+", "_", stem).strip("_").lower() or "own"
    scale = _SCALES.get(unit, "keep")
    try:
        return load_object(path, scale=scale, name=label)  # type: ignore[arg-type]
    except GraspError as error:
        raise GraspError(reworded(str(error), [path])) from error


@lru_cache(maxsize=24)
def _rests(name: str, path: str | None) -> tuple[StablePose, ...]:
    from grasp_core.simulation.settling import stable_poses

    found = tuple(stable_poses(asset_of(name, path), load_physics(), drops=DROPS))
    give_back()
    return found


def _path(thing: Thing, files: Files) -> str | None:
    return str(file_of(thing.name, files)) if thing.name.startswith("mesh-") else None


@lru_cache(maxsize=16)
def gripper_of(name: str) -> Gripper:
    """A shipped gripper; reading its file takes as long as rendering an image."""
    return load_gripper(name)


@lru_cache(maxsize=16)
def _intrinsics(name: str) -> CameraIntrinsics:
    return load_camera(name).intrinsics


def camera_of(setup: Setup) -> Camera:
    """The camera above a simulated scene, looking at the table's centre."""
    return Camera(_intrinsics(setup.camera), look_down(setup.height, tilt=np.radians(setup.tilt)))


def make_scene(request: SceneRequest, setup: Setup, files: Files) -> tuple[SceneRequest, Scene, tuple[Rest, ...]]:
    """The scene of a request, the request with poses wrapped into range, and how its objects may rest.

    Raises:
        GraspError: no such object, it does not come to rest, or the objects do not fit on the table.
    """
    things, rests, placed = [], [], []
    taken: list[tuple[float, float, float]] = []
    for index, thing in enumerate(request.things):
        path = _path(thing, files)
        asset = asset_of(thing.name, path)
        found = _rests(thing.name, path)
        pose = thing.pose % len(found)
        things.append(msgspec.structs.replace(thing, pose=pose))
        rest = Rest(tuple((rest.pose, rest.probability) for rest in found), pose)
        rests.append(rest if thing.at is None else rest.at(matrix(thing.at)))
        if thing.at is None:
            own = found[pose].pose
            radius = float(np.linalg.norm((asset.vertices @ own[:3, :3].T)[:, :2], axis=1).max())
            seed = np.random.SeedSequence([request.place, pose, index])
            x, y, yaw = _spot(np.random.default_rng(seed), radius, taken, len(request.things) == 1)
            world = place(own, x, y, yaw)
        else:
            world = matrix(thing.at)
            radius = float(np.linalg.norm(asset.vertices @ world[:3, :3].T, axis=1).max())
        taken.append((float(world[0, 3]), float(world[1, 3]), radius))
        placed.append(PlacedObject(asset, world))
    scene = Scene(tuple(placed), camera_of(setup))
    return msgspec.structs.replace(request, things=tuple(things)), scene, tuple(rests)


def _spot(
    rng: np.random.Generator, radius: float, taken: list[tuple[float, float, float]], alone: bool
) -> tuple[float, float, float]:
    """Where an object of this radius stands clear of those that are there, metres, and its yaw, rad."""
    if alone:
        x, y = rng.uniform(-SPREAD, SPREAD, 2)
        return float(x), float(y), float(rng.uniform(-np.pi, np.pi))
    for reach in _ROOM:
        for x, y in rng.uniform(-reach, reach, (_DRAWS, 2)):
            if all(np.hypot(x - u, y - v) > radius + other for u, v, other in taken):
                return float(x), float(y), float(rng.uniform(-np.pi, np.pi))
    raise GraspError("these objects do not fit on the table side by side; take fewer or smaller ones")


def settle_scene(request: SceneRequest, setup: Setup, files: Files) -> SceneRequest:
    """Let all objects of a scene go in DART; the request of the scene at rest.

    Raises:
        GraspError: they do not come to rest, or one falls off the table.
    """
    from grasp_core.simulation.settling import settle

    request, scene, _ = make_scene(request, setup, files)
    for index, placed in enumerate(scene.objects):
        lowest = float(placed.vertices[:, 2].min())
        if lowest < 0.0005:  # it may have been dragged into the table
            lifted: NDArray[np.float64] = placed.world_from_object.copy()
            lifted[2, 3] += 0.0005 - lowest
            scene = scene.moved(index, lifted)
    rested = settle(scene, load_physics())
    for index, placed in enumerate(rested.objects):
        thing = request.things[index]
        request = request.moved(index, msgspec.structs.replace(thing, at=vector(placed.world_from_object), loose=False))
    return request
