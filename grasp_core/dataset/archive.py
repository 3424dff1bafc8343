"""A dataset's labels as one small file, and the way back: physics is dear, rendering is cheap.

The archive keeps what physics decided (every attempt's outcome; comfort and a few quantised numbers of those that took
dynamics) and what cannot be made again elsewhere bit for bit (meshes, convex parts, poses, grasps). Depth is rendered
anew, seeds and executed poses are derived from the scene's seed. The file is an xz-compressed npz.
"""

from __future__ import annotations

import io
import lzma
import zipfile
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from grasp_core import config
from grasp_core.dataset import files
from grasp_core.dataset.recipe import Recipe
from grasp_core.dataset.rows import (
    AttemptRow,
    Split,
    StoredPose,
    camera_json,
)
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import StoreError
from grasp_core.grasp import Grasp
from grasp_core.objects.asset import ObjectAsset, Part
from grasp_core.simulation.trial import GraspNoise, child_seed

FORMAT = 1
"""Version of the archive's format."""
OUTCOMES = ("SUCCESS", "COLLISION", "MISSED", "SLIPPED", "UNSTABLE")
"""Outcomes by their number in the archive."""
ABSENT = 65535
"""Stands for a number that an attempt does not have."""
STEPS = {
    "comfort_m": 1e-4,
    "comfort_rad": 1e-3,
    "left": 1e-4,
    "right": 1e-4,
    "lift": 1e-3,
    "time": 1e-2,
    "clearance": 1e-4,
}
"""Quantised numbers of dynamic attempts and the size of one step: metres, rad, s."""


class ObjectHead(msgspec.Struct, frozen=True):
    """An object without its arrays; `sizes` and `parts` count vertices and faces."""

    name: str
    category: str
    split: Split
    volume: float
    unit_inertia: list[float]
    mass: float | None
    decomposition: str
    source: str
    meta: dict[str, str]
    poses: list[StoredPose]
    sizes: tuple[int, int]
    parts: list[tuple[int, int]]


class SceneHead(msgspec.Struct, frozen=True):
    """A scene without its columns; `grasps` and `attempts` count their rows."""

    name: str
    object: str
    pose: int
    seed: int
    camera: int
    world_from_object: list[float]
    grasps: int
    attempts: int


class Head(msgspec.Struct, frozen=True):
    """What is no column: settings, cameras, objects and scenes."""

    format: int
    name: str
    gripper: dict
    physics: dict
    recipe: dict
    labels: str
    refused: dict[str, str]
    cameras: list[str]
    objects: list[ObjectHead]
    scenes: list[SceneHead]


@dataclass(frozen=True)
class Archive:
    """A read archive: its head and its columns."""

    head: Head
    columns: dict[str, NDArray]

    @property
    def scenes(self) -> list[str]:
        """Names of its scenes."""
        return [scene.name for scene in self.head.scenes]


def write_archive(store: DatasetStore, file: str | Path) -> int:
    """Write a dataset's archive; its size in bytes.

    Raises:
        StoreError: the dataset's attempts were not made by generation, or the file cannot be written.
    """
    meta = store.meta
    recipe = config.convert(meta.recipe, Recipe, str(store.file))
    objects, object_columns = _pack_objects(store)
    cameras: dict[str, int] = {}
    scenes: list[SceneHead] = []
    parts: list[dict[str, NDArray]] = []
    for row in store.scenes():
        scene = store.scene(row.id)
        if len(scene.objects) != 1:
            raise StoreError(
                f"{store.path}: scene '{row.name}' has {len(scene.objects)} objects; archives take one each"
            )
        camera = cameras.setdefault(camera_json(scene.camera), len(cameras))
        columns = _pack_scene(store, row.id, row.seed, recipe.noise)
        pose = scene.objects[0].world_from_object.reshape(-1).tolist()
        counts = (len(columns["x"]), len(columns["outcome"]))
        scenes.append(SceneHead(row.name, row.object, row.pose, row.seed, camera, pose, *counts))
        parts.append(columns)
    joined = {name: np.concatenate([part[name] for part in parts]) for name in (parts[0] if parts else {})}
    head = Head(
        FORMAT,
        meta.name,
        meta.gripper,
        meta.physics,
        meta.recipe,
        store.labels_digest(),
        store.refused(),
        list(cameras),
        objects,
        scenes,
    )
    buffer = io.BytesIO()
    arrays: dict[str, Any] = {"head": np.frombuffer(msgspec.json.encode(head), np.uint8), **object_columns, **joined}
    np.savez(buffer, **arrays)
    data = lzma.compress(buffer.getvalue(), preset=9)
    files.write_durably(Path(file), data)
    return len(data)


def _pack_objects(store: DatasetStore) -> tuple[list[ObjectHead], dict[str, NDArray]]:
    heads: list[ObjectHead] = []
    columns: dict[str, list[NDArray]] = {"vertices": [], "faces": [], "part_vertices": [], "part_faces": []}
    for row in store.objects():
        asset = store.object(row.name)
        columns["vertices"].append(asset.vertices)
        columns["faces"].append(asset.faces)
        columns["part_vertices"] += [part.vertices for part in asset.parts]
        columns["part_faces"] += [part.faces for part in asset.parts]
        heads.append(
            ObjectHead(
                asset.name,
                asset.category,
                row.split,
                asset.volume,
                asset.unit_inertia.reshape(-1).tolist(),
                asset.mass,
                asset.decomposition,
                asset.source,
                asset.meta,
                store.poses(row.name),
                (len(asset.vertices), len(asset.faces)),
                [(len(part.vertices), len(part.faces)) for part in asset.parts],
            )
        )
    return heads, {name: np.concatenate(arrays) for name, arrays in columns.items() if arrays}


def _pack_scene(store: DatasetStore, scene_id: int, seed: int, noise: GraspNoise) -> dict[str, NDArray]:
    table = store.grasps(scene_id)
    grid = [i for i in range(len(table)) if table.number[i] < 1 << 32]
    counts, rows = [], []
    for i in grid:
        attempts = [row for row in store.attempts(int(table.id[i])) if row.event is None]
        trial = child_seed(seed, int(table.number[i]))
        first = attempts[0] if attempts else None
        if first and (
            first.seed != child_seed(trial, 0) or first.executed != executed_pose(table.grasp(i), first, noise)
        ):
            raise StoreError(f"{store.path}: attempts of grasp {table.id[i]} do not follow from its scene's seed")
        counts.append(len(attempts))
        rows += attempts
    numbers = [_numbers(row) for row in rows if row.dynamic]
    made: dict[str, NDArray] = {
        "x": table.position[grid, 0],
        "y": table.position[grid, 1],
        "z": table.position[grid, 2],
        "angle": table.angle[grid],
        "width": table.width[grid],
        "count": np.array(counts, np.uint8),
        "outcome": np.array([OUTCOMES.index(row.outcome) for row in rows], np.uint8),
        "dynamic": np.array([row.dynamic for row in rows], np.uint8),
        "redraws": np.array([row.redraws for row in rows], np.uint8),
    }
    for name in STEPS:
        made[name] = np.array([_quantised(number[name], STEPS[name]) for number in numbers], np.uint16)
    return made


def _numbers(row: AttemptRow) -> dict[str, float | None]:
    evidence = msgspec.json.decode(row.evidence) if row.evidence else {}
    left, right = evidence.get("travel", (None, None))
    comfort = row.comfort or (None, None)
    return {
        "comfort_m": comfort[0],
        "comfort_rad": comfort[1],
        "left": left,
        "right": right,
        **{name: evidence.get(name) for name in ("lift", "time", "clearance")},
    }


def _quantised(value: float | None, step: float) -> int:
    return ABSENT if value is None else int(np.clip(round(value / step), 0, ABSENT - 1))


def executed_pose(grasp: Grasp, row: AttemptRow, noise: GraspNoise) -> tuple[float, float, float, float]:
    """The pose that an attempt really executed, from its seed (as the trial draws it)."""
    drawn = noise.draw(grasp, np.random.default_rng(np.random.SeedSequence([row.seed, row.redraws])))
    return (*drawn.position, drawn.angle)


def shipped_archives() -> dict[str, Path]:
    """Name → file of the archives that come with the package."""
    folder = Path(str(resources.files("grasp_core"))) / "dataset" / "archives"
    return {path.name.removesuffix(".npz.xz"): path for path in sorted(folder.glob("*.npz.xz"))}


def locate_archive(name: str | Path) -> Path:
    """The file of an archive: a shipped name, or a path that ends in .xz.

    Raises:
        StoreError: no such archive; the message lists the shipped ones.
    """
    if str(name).endswith(".xz"):
        path = Path(name).expanduser()
        if not path.is_file():
            raise StoreError(f"{path}: no such archive")
        return path
    shipped = shipped_archives()
    if str(name) not in shipped:
        raise StoreError(
            f"no shipped archive is called '{name}'; choose one of: {', '.join(shipped) or 'none'}, or give a path that"
            " ends in .xz"
        )
    return shipped[str(name)]


def read_archive(name: str | Path) -> Archive:
    """Read an archive.

    Raises:
        StoreError: missing, damaged or of a newer format.
    """
    path = locate_archive(name)
    try:
        with np.load(io.BytesIO(lzma.decompress(files.read(path))), allow_pickle=False) as arrays:
            columns = {key: arrays[key] for key in arrays.files}
        version = msgspec.json.decode(columns["head"].tobytes())["format"]
        if version > FORMAT:
            raise StoreError(f"{path}: was written by a newer version; update with `pip install -U grasp-workbench`")
        head = msgspec.json.decode(columns.pop("head").tobytes(), type=Head)
    except (lzma.LZMAError, zipfile.BadZipFile, EOFError, ValueError, KeyError, OSError, msgspec.DecodeError) as error:
        raise StoreError(f"{path}: is damaged or no archive ({error}); install or download it again") from error
    return Archive(head, columns)


def unpack_objects(archive: Archive) -> list[tuple[ObjectAsset, ObjectHead]]:
    """The assets of an archive, exact, each with its head."""
    columns = archive.columns
    at = dict.fromkeys(("vertices", "faces", "part_vertices", "part_faces"), 0)

    def take(name: str, count: int) -> NDArray:
        at[name] += count
        return columns[name][at[name] - count : at[name]]

    made = []
    for item in archive.head.objects:
        vertices, faces = take("vertices", item.sizes[0]), take("faces", item.sizes[1])
        parts = tuple(Part(take("part_vertices", v), take("part_faces", f)) for v, f in item.parts)
        asset = ObjectAsset(
            item.name,
            item.category,
            vertices,
            faces,
            parts,
            item.volume,
            np.array(item.unit_inertia).reshape(3, 3),
            item.mass,
            item.decomposition,
            item.source,
            item.meta,
        )
        made.append((asset, item))
    return made
