"""DatasetStore: scenes with their depth, grasps and attempts, and everything that people decide about them.

One folder: an SQLite file, PNG depth images and object files (see `schema`). Everything written is durable when the
call returns; several programs may read while one writes.
"""

from __future__ import annotations

import hashlib
from importlib import metadata
from pathlib import Path
from typing import Any, Self

import msgspec
import platformdirs

from grasp_core import config
from grasp_core.dataset.database import FILE
from grasp_core.dataset.lists import Lists
from grasp_core.dataset.rows import Meta
from grasp_core.errors import MismatchError, StoreError
from grasp_core.gripper import Gripper


def code_version() -> str:
    """The installed version of this project."""
    try:
        return metadata.version("grasp-workbench")
    except metadata.PackageNotFoundError:
        return "unknown"


def datasets_folder() -> Path:
    """Where datasets live unless another folder is given: in the user's data folder."""
    return Path(platformdirs.user_data_dir("grasp-workbench")) / "datasets"


class DatasetStore(Lists):
    """A dataset; make one with `create`, open one with `open`, close it or use it as a context manager."""

    @classmethod
    def create(
        cls,
        path: str | Path,
        *,
        name: str,
        gripper: Gripper,
        physics: msgspec.Struct,
        recipe: msgspec.Struct,
    ) -> Self:
        """Make an empty dataset.

        Args:
            path: folder, made when missing; it must hold no dataset yet.
            name: for people.
            gripper: that all attempts are made with.
            physics: settings of the engine, likewise.
            recipe: settings that the dataset follows.

        Raises:
            StoreError: a dataset is there already, or the folder cannot be written.
        """
        folder = Path(path).expanduser()
        if (folder / FILE).exists():
            raise StoreError(f"{folder}: holds a dataset already; open it, or give another folder")
        try:
            for part in ("depth", "objects"):
                (folder / part).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise StoreError(
                f"{folder}: cannot be made ({error.strerror}); give a folder that may be written"
            ) from error
        plain = msgspec.structs.replace(gripper, urdf=None)
        meta = Meta(
            name=name,
            gripper=msgspec.to_builtins(plain),
            gripper_digest=gripper.digest,
            physics=msgspec.to_builtins(physics),
            physics_digest=config.digest(physics),
            recipe=msgspec.to_builtins(recipe),
            recipe_digest=config.digest(recipe),
            code_version=code_version(),
        )
        store = cls(folder, create=True)
        try:
            with store.transaction() as db:
                for key, value in msgspec.structs.asdict(meta).items():
                    if value is not None:
                        text = msgspec.json.encode(value, order="sorted").decode()
                        db.execute("INSERT INTO meta (key, value) VALUES (?, ?)", (key, text))
        except BaseException:
            store.close()
            raise
        return store

    @classmethod
    def open(cls, path: str | Path, *, readonly: bool = False) -> Self:
        """Open a dataset by its folder (or the SQLite file in it); an older format is brought up, with a backup first.

        Raises:
            StoreError: missing, foreign, damaged, newer, locked or unreadable.
        """
        folder = Path(path).expanduser()
        if folder.name == FILE:
            folder = folder.parent
        store = cls(folder, readonly=readonly)
        try:
            store.meta  # noqa: B018 (reads, so that damage shows now)
        except BaseException:
            store.close()
            raise
        return store

    @property
    def meta(self) -> Meta:
        """What the dataset was made with.

        Raises:
            StoreError: the entry is damaged.
        """
        found: dict[str, Any] = {}
        try:
            for row in self.rows("SELECT key, value FROM meta"):
                found[row["key"]] = msgspec.json.decode(row["value"])
            return msgspec.convert(found, Meta)
        except msgspec.DecodeError as error:
            raise StoreError(f"{self.file}: its head is damaged ({error}); restore a backup") from error

    def gripper(self) -> Gripper:
        """The gripper that all attempts were made with."""
        return config.convert(self.meta.gripper, Gripper, str(self.file))

    def check(self, *, gripper: Gripper | None = None, physics: msgspec.Struct | None = None) -> None:
        """Refuse to be used with another gripper or physics than the dataset was made with.

        Raises:
            MismatchError: they differ.
        """
        meta = self.meta
        if gripper is not None and gripper.digest != meta.gripper_digest:
            raise MismatchError(
                f"{self.path}: was made with the gripper '{meta.gripper.get('name', '')}' ({meta.gripper_digest}), not"
                f" with '{gripper.name}' ({gripper.digest}); use that gripper or generate another dataset"
            )
        if physics is not None and config.digest(physics) != meta.physics_digest:
            theirs = msgspec.json.decode(msgspec.json.encode(physics))
            differ = sorted(k for k in {*theirs, *meta.physics} if theirs.get(k) != meta.physics.get(k))
            raise MismatchError(
                f"{self.path}: was made with other physics ({', '.join(differ)} differ); use its settings or generate"
                " another dataset"
            )

    def content_digest(self) -> str:
        """A hash of all objects, scenes, grasps, attempts and images as they were generated.

        Computed from the rows and the image pixels' hashes; ids, times, and the order of insertion do not matter, nor
        does what people added since.
        """
        h = hashlib.sha256()
        meta = self.meta
        h.update(f"{meta.gripper_digest} {meta.physics_digest} {meta.recipe_digest}\n".encode())
        for row in self.objects():
            poses = msgspec.json.encode(self.poses(row.name))
            h.update(f"{row.name}\t{row.split}\t{row.digest}\t".encode() + poses + b"\n")
        for scene in self.rows("SELECT id, name FROM scenes ORDER BY name"):
            h.update(f"{scene['name']}\t{self.scene_digest(scene['id'])}\n".encode())
        return h.hexdigest()

    def labels_digest(self) -> str:
        """A hash of every generated attempt's outcome and seed, by the names of scenes and numbers of grasps.

        Equal for a dataset and what `restore` rebuilds from its archive.
        """
        h = hashlib.sha256()
        for scene in self.rows("SELECT id, name FROM scenes ORDER BY name"):
            found = self.rows(
                """SELECT grasps.number, attempts.number, outcome, seed FROM grasps
                   JOIN attempts ON attempts.grasp = grasps.id
                   WHERE scene = ? AND origin = 'grid' AND event IS NULL ORDER BY 1, 2""",
                (scene["id"],),
            )
            h.update(scene["name"].encode() + b"\t" + msgspec.json.encode([tuple(row) for row in found]) + b"\n")
        return h.hexdigest()
