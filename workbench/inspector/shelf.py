"""Own files: uploads and folders of this machine, each under a key that requests name it by.

Uploads are written to a folder that goes with the app; nothing is parsed here, that is the worker's.
"""

from __future__ import annotations

import hashlib
import re
import shutil
import tempfile
import threading
from pathlib import Path
from typing import Literal

from grasp_core.errors import GraspError
from grasp_core.objects.meshes import FORMATS
from workbench.inspector.orders import Item

Kind = Literal["mesh", "image", "camera"]
KINDS: dict[Kind, tuple[str, ...]] = {
    "mesh": tuple(sorted(FORMATS)),
    "image": (".npy", ".png", ".tif", ".tiff"),
    "camera": (".yaml", ".yml"),
}
"""Endings of files of each kind."""
MOST: dict[Kind, int] = {"mesh": 50_000_000, "image": 50_000_000, "camera": 100_000}
"""Bytes of an upload."""
MOST_FILES = 500
"""In a folder."""
_ROOM = 1_000_000_000
"""Bytes of all uploads together; the oldest ones go first."""


class Shelf:
    """All own files of this run; `close` removes the uploads."""

    def __init__(self) -> None:
        self._folder = Path(tempfile.mkdtemp(prefix="grasp-workbench-"))
        self._lock = threading.Lock()
        self._items: dict[str, Item] = {}

    @property
    def files(self) -> dict[str, str]:
        """Key → path."""
        with self._lock:
            return {key: item.path for key, item in self._items.items()}

    def add(self, kind: Kind, name: str, content: bytes, unit: str = "") -> Item:
        """Keep an upload.

        Args:
            kind: what it holds.
            name: that the browser gave it; only its ending decides anything.
            content: of the file.
            unit: of a mesh: m, mm, cm, or paper for 10-20 cm.

        Raises:
            GraspError: an ending of another kind, or too large.
        """
        ending = Path(name).suffix.lower()
        if ending not in KINDS[kind]:
            raise GraspError(f"a {kind} is a file that ends in {', '.join(KINDS[kind])}")
        if len(content) > MOST[kind]:
            raise GraspError(f"a {kind} has at most {MOST[kind] / 1e6:g} MB")
        digest = hashlib.sha256(content).hexdigest()[:12]
        plain = re.sub(r"[^A-Za-z0-9._-]+", "_", Path(name).stem)[:50] + ending
        path = self._folder / f"{digest}--{plain}"
        if not path.exists():
            self._make_room(len(content))
            path.write_bytes(content)
        return self._keep(kind, digest, name, path, unit)

    def open_folder(self, kind: Kind, folder: str, unit: str = "") -> tuple[Item, ...]:
        """All files of a kind in a folder of this machine, in the order of their names.

        Raises:
            GraspError: no such folder, nothing of the kind in it, or too much.
        """
        place = Path(folder).expanduser()
        if not place.is_dir():
            raise GraspError(f"{folder}: no such folder on the machine that runs the workbench")
        paths = sorted(path for path in place.iterdir() if path.suffix.lower() in KINDS[kind] and path.is_file())
        if not paths:
            raise GraspError(f"{folder}: holds no {kind}; they end in {', '.join(KINDS[kind])}")
        if len(paths) > MOST_FILES:
            raise GraspError(f"{folder}: holds {len(paths)} files; open folders of at most {MOST_FILES}")
        made = []
        for path in paths:
            digest = hashlib.sha256(str(path.resolve()).encode()).hexdigest()[:12]
            made.append(self._keep(kind, digest, path.name, path, unit))
        return tuple(made)

    def _keep(self, kind: Kind, digest: str, name: str, path: Path, unit: str) -> Item:
        item = Item(f"{kind}-{digest}" + (f"-{unit}" if kind == "mesh" else ""), name, kind, str(path))
        with self._lock:
            self._items[item.key] = item
        return item

    def _make_room(self, wanted: int) -> None:
        kept = sorted(self._folder.iterdir(), key=lambda path: path.stat().st_mtime)
        room = _ROOM - sum(path.stat().st_size for path in kept)
        for path in kept:
            if room >= wanted:
                return
            room += path.stat().st_size
            path.unlink()

    def close(self) -> None:
        """Remove the uploads."""
        shutil.rmtree(self._folder, ignore_errors=True)
