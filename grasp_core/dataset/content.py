"""Objects, poses, scenes and depth of a dataset: writing them whole and reading them back."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Sequence
from dataclasses import dataclass

import msgspec

from grasp_core.camera import DepthImage
from grasp_core.dataset import files
from grasp_core.dataset.grasps import GraspTables
from grasp_core.dataset.rows import (
    AttemptRow,
    ObjectRow,
    SceneRow,
    Split,
    StoredPose,
    camera_from_json,
    camera_json,
    pose_from_json,
    pose_json,
)
from grasp_core.errors import MeshError, StoreError
from grasp_core.grasp import Grasp
from grasp_core.objects.asset import ObjectAsset
from grasp_core.scene import PlacedObject, Scene


@dataclass(frozen=True)
class SceneRecord:
    """Everything that is made with one scene, ready to be stored in one go.

    Attributes:
        name: unique; the same wherever the scene is made.
        object: name of the object that the scene is about.
        pose: number of its stable pose.
        seed: that yaw and attempts were drawn from.
        scene: the placed objects and the camera; their assets are stored already.
        depth: the clean image of that camera.
        grasps: numbered in this order from 0.
        attempts: those of each grasp, in order.
        seconds: of computing.
    """

    name: str
    object: str
    pose: int
    seed: int
    scene: Scene
    depth: DepthImage
    grasps: Sequence[Grasp]
    attempts: Sequence[Sequence[AttemptRow]]
    seconds: float = 0.0


def now_ms() -> int:
    """Unix time, ms."""
    return time.time_ns() // 1_000_000


class Content(GraspTables):
    """The part of a store that generation writes and training reads."""

    # objects

    def add_object(self, asset: ObjectAsset, split: Split, poses: Sequence[StoredPose]) -> bool:
        """Store an object with its stable poses; False when it is there already.

        Raises:
            StoreError: another object has this name, or it cannot be written.
        """
        found = self.row("SELECT digest, split FROM objects WHERE name = ?", (asset.name,))
        if found is not None:
            if (found["digest"], found["split"]) != (asset.digest, split):
                raise StoreError(f"{self.path}: holds another object called '{asset.name}'; rename one of them")
            return False
        data = asset.to_bytes()
        file = files.file_name(asset.name, ".npz")
        files.write_durably(self.path / "objects" / file, data)
        with self.transaction() as db:
            row = (
                asset.name,
                asset.category,
                split,
                asset.digest,
                file,
                hashlib.sha256(data).hexdigest(),
                asset.source,
            )
            new = db.execute(
                "INSERT INTO objects (name, category, split, digest, file, sha256, source) VALUES (?,?,?,?,?,?,?)", row
            ).lastrowid
            values = [(new, number, pose_json(pose.matrix), pose.probability) for number, pose in enumerate(poses)]
            db.executemany("INSERT INTO poses (object, number, pose, probability) VALUES (?,?,?,?)", values)
        return True

    def objects(self, split: Split | None = None) -> list[ObjectRow]:
        """The objects, by name."""
        where, values = ("WHERE split = ?", [split]) if split else ("", [])
        query = f"SELECT id, name, category, split, digest, file, source FROM objects {where} ORDER BY name"
        return [ObjectRow(**dict(row)) for row in self.rows(query, values)]

    def object(self, name: str) -> ObjectAsset:
        """The asset of an object.

        Raises:
            StoreError: no object has this name, or its file is missing or damaged.
        """
        row = self.row("SELECT file, sha256, digest FROM objects WHERE name = ?", (name,))
        if row is None:
            raise StoreError(f"{self.path}: holds no object called '{name}'; `grasp-core dataset info` lists them")
        path = self.path / "objects" / row["file"]
        data = files.read(path)
        if hashlib.sha256(data).hexdigest() != row["sha256"]:
            raise StoreError(f"{path}: is damaged (its checksum differs); restore it from a backup")
        try:
            return ObjectAsset.from_bytes(data)
        except MeshError as error:
            raise StoreError(f"{path}: {error}") from error

    def poses(self, name: str) -> list[StoredPose]:
        """The stable poses of an object, the most probable first."""
        query = """SELECT pose, probability FROM poses JOIN objects ON objects.id = poses.object
                   WHERE name = ? ORDER BY number"""
        return [
            StoredPose(tuple(pose_from_json(row["pose"]).reshape(-1).tolist()), row["probability"])
            for row in self.rows(query, (name,))
        ]

    def refuse(self, name: str, reason: str) -> None:
        """Remember that an object of the recipe cannot be used, and why."""
        with self.transaction() as db:
            text = msgspec.json.encode({**self.refused(), name: reason}, order="sorted").decode()
            db.execute("INSERT OR REPLACE INTO meta (key, value) VALUES ('refused', ?)", (text,))

    def refused(self) -> dict[str, str]:
        """Objects of the recipe that cannot be used → why."""
        row = self.row("SELECT value FROM meta WHERE key = 'refused'")
        return {} if row is None else msgspec.json.decode(row["value"], type=dict[str, str])

    # scenes

    def add_scene(self, record: SceneRecord) -> bool:
        """Store one scene with its image, grasps and attempts, all or nothing; False when it is there already.

        Raises:
            StoreError: its object is not stored, numbers that are not finite, or it cannot be written.
        """
        if self.row("SELECT 1 FROM scenes WHERE name = ?", (record.name,)) is not None:
            return False
        if len(record.grasps) != len(record.attempts):
            raise StoreError(
                f"scene '{record.name}' has {len(record.grasps)} grasps but attempts for {len(record.attempts)}"
            )
        units = files.depth_units(record.depth)
        data = files.png_bytes(units)
        file = files.file_name(record.name, ".png")
        files.write_durably(self.path / "depth" / file, data)
        with self.transaction() as db:
            subject = self._object_id(record.object)
            camera = camera_json(record.scene.camera)
            digest = hashlib.sha256(camera.encode()).hexdigest()[:12]
            db.execute("INSERT OR IGNORE INTO cameras (digest, settings) VALUES (?, ?)", (digest, camera))
            found = db.execute("SELECT id FROM cameras WHERE digest = ?", (digest,)).fetchone()
            split = db.execute("SELECT split FROM objects WHERE id = ?", (subject,)).fetchone()[0]
            scene = db.execute(
                "INSERT INTO scenes (name, object, split, pose, seed, camera, file, sha256, pixels, digest, seconds,"
                " added) VALUES (?,?,?,?,?,?,?,?,?,'',?,?)",
                (
                    record.name,
                    subject,
                    split,
                    record.pose,
                    record.seed,
                    found[0],
                    file,
                    hashlib.sha256(data).hexdigest(),
                    files.pixels_digest(units),
                    record.seconds,
                    now_ms(),
                ),
            ).lastrowid
            assert scene is not None
            for slot, placed in enumerate(record.scene.objects):
                db.execute(
                    "INSERT INTO placements (scene, slot, object, pose) VALUES (?,?,?,?)",
                    (scene, slot, self._object_id(placed.asset.name), pose_json(placed.world_from_object)),
                )
            first = db.execute("SELECT coalesce(max(id), 0) + 1 FROM grasps").fetchone()[0]
            db.executemany(
                "INSERT INTO grasps (id, scene, number, x, y, z, angle, width, origin) VALUES (?,?,?,?,?,?,?,?,'grid')",
                (
                    (first + number, scene, number, *grasp.position, grasp.angle, grasp.width)
                    for number, grasp in enumerate(record.grasps)
                ),
            )
            for number, attempts in enumerate(record.attempts):
                self._insert_attempts(first + number, 0, attempts)
            self._fill_samples("grasps.scene = ?", (scene,))
            db.execute("UPDATE scenes SET digest = ? WHERE id = ?", (self.scene_digest(scene), scene))
        return True

    def _object_id(self, name: str) -> int:
        row = self.row("SELECT id FROM objects WHERE name = ?", (name,))
        if row is None:
            raise StoreError(f"{self.path}: holds no object called '{name}'; add the object before its scenes")
        return int(row["id"])

    def scenes(self, split: Split | None = None) -> list[SceneRow]:
        """The scenes, by name."""
        where, values = ("WHERE scenes.split = ?", [split]) if split else ("", [])
        query = f"""SELECT scenes.id, scenes.name, objects.name AS object, category, scenes.split AS split, pose, seed,
                        (SELECT count(*) FROM samples WHERE scene = scenes.id) AS grasps,
                        (SELECT max(quality) FROM samples WHERE scene = scenes.id) AS best
                    FROM scenes JOIN objects ON objects.id = scenes.object {where} ORDER BY scenes.name"""
        return [SceneRow(**dict(row)) for row in self.rows(query, values)]

    def scene_id(self, name: str) -> int:
        """The id of the scene with this name.

        Raises:
            StoreError: there is none.
        """
        row = self.row("SELECT id FROM scenes WHERE name = ?", (name,))
        if row is None:
            raise StoreError(f"{self.path}: holds no scene called '{name}'")
        return int(row["id"])

    def scene(self, scene_id: int) -> Scene:
        """The placed objects and the camera of a scene.

        Raises:
            StoreError: no such scene, or a damaged file.
        """
        placed = self.rows(
            "SELECT name, pose FROM placements JOIN objects ON objects.id = placements.object WHERE scene = ?"
            " ORDER BY slot",
            (scene_id,),
        )
        camera = self._scene_field(scene_id, "cameras.settings")
        objects = tuple(PlacedObject(self.object(row["name"]), pose_from_json(row["pose"])) for row in placed)
        return Scene(objects, camera_from_json(camera))

    def _scene_field(self, scene_id: int, field: str) -> str:
        query = f"SELECT {field} FROM scenes JOIN cameras ON cameras.id = scenes.camera WHERE scenes.id = ?"
        row = self.row(query, (scene_id,))
        if row is None:
            raise StoreError(f"{self.path}: holds no scene with the id {scene_id}; `scenes()` lists them")
        return str(row[0])

    def depth(self, scene_id: int) -> DepthImage:
        """The clean depth image of a scene, exact to 0.05 mm.

        Raises:
            StoreError: no such scene, or its file is missing or damaged.
        """
        camera = camera_from_json(self._scene_field(scene_id, "cameras.settings"))
        units = files.read_png(self.path / "depth" / self._scene_field(scene_id, "scenes.file"))
        k = camera.intrinsics
        if units.shape != (k.height, k.width):
            raise StoreError(f"{self.path}: the image of scene {scene_id} has not its camera's size; restore a backup")
        return files.depth_image(units, camera)
