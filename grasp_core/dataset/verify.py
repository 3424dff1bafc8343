"""Verification of a dataset: every row against every file, every hash computed anew, every label against the rule."""

from __future__ import annotations

import hashlib
import sqlite3
from collections.abc import Callable, Iterator

import msgspec

from grasp_core import config
from grasp_core.dataset import files
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import GraspError, StoreError
from grasp_core.gripper import Gripper
from grasp_core.objects.asset import ObjectAsset
from grasp_core.simulation.physics import Physics


class Finding(msgspec.Struct, frozen=True):
    """Something that is wrong.

    Attributes:
        where: a file, an object, a scene or a table.
        problem: what is wrong, and the way out.
    """

    where: str
    problem: str


def verify(
    store: DatasetStore,
    *,
    gripper: Gripper | None = None,
    physics: Physics | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> list[Finding]:
    """Everything that is wrong with a dataset; an empty list means that nothing is.

    Args:
        store: the dataset.
        gripper: the one that it should have been made with, if that matters.
        physics: likewise.
        progress: called with (done, total) objects and scenes.
    """
    findings: list[Finding] = []
    try:
        findings += _database(store)
        findings += _settings(store, gripper, physics)
        objects = store.rows("SELECT name, file, sha256, digest FROM objects ORDER BY name")
        scenes = store.rows("SELECT id, name, file, sha256, pixels, digest FROM scenes ORDER BY name")
        total = len(objects) + len(scenes)
        for number, row in enumerate(objects):
            findings += _object(store, row)
            if progress:
                progress(number + 1, total)
        for number, row in enumerate(scenes):
            findings += _scene(store, row)
            if progress:
                progress(len(objects) + number + 1, total)
        findings += _labels(store)
        findings += _strays(store, {row["file"] for row in objects}, {row["file"] for row in scenes})
    except StoreError as error:  # so damaged that reading ends here
        findings.append(Finding(str(store.file), str(error)))
    return findings


def _database(store: DatasetStore) -> Iterator[Finding]:
    for row in store.rows("PRAGMA integrity_check"):
        if row[0] != "ok":
            yield Finding(str(store.file), f"{row[0]}; restore a backup")
    for row in store.rows("PRAGMA foreign_key_check"):
        yield Finding(str(store.file), f"a row of {row['table']} points to no row of {row['parent']}; restore a backup")


def _settings(store: DatasetStore, gripper: Gripper | None, physics: Physics | None) -> Iterator[Finding]:
    meta = store.meta
    try:
        if store.gripper().digest != meta.gripper_digest:
            yield Finding("meta", "the gripper's settings and their digest differ; restore a backup")
        if config.convert(meta.physics, Physics, "physics").digest != meta.physics_digest:
            yield Finding("meta", "the physics' settings and their digest differ; restore a backup")
    except GraspError as error:
        yield Finding("meta", str(error))
    for check in ({"gripper": gripper}, {"physics": physics}):
        try:
            store.check(**check)  # type: ignore[arg-type]
        except GraspError as error:
            yield Finding("meta", str(error))


def _object(store: DatasetStore, row: sqlite3.Row) -> Iterator[Finding]:
    path = store.path / "objects" / row["file"]
    way_out = "restore a backup or generate the dataset again"
    try:
        data = files.read(path)
        if hashlib.sha256(data).hexdigest() != row["sha256"]:
            yield Finding(str(path), f"its checksum differs from the stored one; {way_out}")
        elif ObjectAsset.from_bytes(data).digest != row["digest"]:
            yield Finding(row["name"], f"its geometry differs from the stored digest; {way_out}")
    except GraspError as error:
        yield Finding(str(path), str(error))


def _scene(store: DatasetStore, row: sqlite3.Row) -> Iterator[Finding]:
    path = store.path / "depth" / row["file"]
    try:
        if hashlib.sha256(files.read(path)).hexdigest() != row["sha256"]:
            yield Finding(str(path), "its checksum differs from the stored one; restore a backup")
        elif files.pixels_digest(files.read_png(path)) != row["pixels"]:
            yield Finding(str(path), "its pixels differ from the stored digest; restore a backup")
    except GraspError as error:
        yield Finding(str(path), str(error))
    if store.scene_digest(row["id"]) != row["digest"]:
        yield Finding(row["name"], "its grasps or attempts were changed after they were generated; restore a backup")


def _labels(store: DatasetStore) -> Iterator[Finding]:
    lonely = store.row("SELECT count(*) FROM grasps WHERE id NOT IN (SELECT grasp FROM samples)")
    if lonely is not None and lonely[0]:
        yield Finding("samples", f"{lonely[0]} grasps have no row; run `grasp-core dataset verify --mend`")
    differ = store.differing_labels()
    if differ:
        yield Finding(
            "samples",
            f"{len(differ)} labels differ from the rule (first: grasp {differ[0]}); run"
            " `grasp-core dataset verify --mend`",
        )


def _strays(store: DatasetStore, objects: set[str], images: set[str]) -> Iterator[Finding]:
    """Files that no row names: harmless leftovers of a killed run, or of a row that is gone."""
    for folder, known in (("objects", objects), ("depth", images)):
        for path in sorted((store.path / folder).iterdir()):
            if path.name not in known and not path.name.endswith(".part"):
                yield Finding(str(path), "belongs to no row; generate again to use it, or delete it")
