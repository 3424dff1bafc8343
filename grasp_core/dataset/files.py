"""The files beside the SQLite file: depth images as 16-bit PNG in 0.1 mm units, objects as npz; written to stay."""

from __future__ import annotations

import hashlib
import os
import re
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import Camera, DepthImage
from grasp_core.errors import StoreError

UNIT = 1e-4
"""Metres of one step of a stored depth image."""


def file_name(name: str, suffix: str) -> str:
    """A file name for any object or scene name: its readable part and a hash, so that no two names share a file."""
    readable = re.sub(r"[^A-Za-z0-9_.-]+", "-", name).strip("-.")[:60]
    return f"{readable}-{hashlib.sha256(name.encode()).hexdigest()[:8]}{suffix}"


def depth_units(image: DepthImage) -> NDArray[np.uint16]:
    """Metres → (H, W) uint16 in 0.1 mm units; invalid pixels are 0.

    Raises:
        StoreError: a depth beyond 6.5 m.
    """
    farthest = float(image.depth[image.valid].max(initial=0.0))
    if farthest > 65535 * UNIT:
        raise StoreError(f"a depth of {farthest:.2f} m does not fit a stored image, which ends at 6.55 m")
    return np.where(image.valid, np.rint(image.depth.astype(np.float64) / UNIT), 0).astype(np.uint16)


def depth_image(units: NDArray[np.uint16], camera: Camera) -> DepthImage:
    """Inverse of `depth_units`, exact to half a unit."""
    return DepthImage((units * UNIT).astype(np.float32), camera, units > 0)


def png_bytes(units: NDArray[np.uint16]) -> bytes:
    """A 16-bit PNG of the units."""
    return cv2.imencode(".png", units)[1].tobytes()


def read_png(path: Path) -> NDArray[np.uint16]:
    """The units (H, W) of a stored image.

    Raises:
        StoreError: missing, or no 16-bit grey PNG.
    """
    data = read(path)
    units = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED) if data else None
    if units is None or units.dtype != np.uint16 or units.ndim != 2:
        raise StoreError(f"{path}: is no 16-bit depth PNG; restore it from a backup or generate the scene again")
    return np.asarray(units, np.uint16)


def pixels_digest(units: NDArray[np.uint16]) -> str:
    """SHA-256 of the pixels and their shape."""
    shape = np.array(units.shape, "<i8").tobytes()
    return hashlib.sha256(shape + np.ascontiguousarray(units, "<u2").tobytes()).hexdigest()


def read(path: Path) -> bytes:
    """The bytes of a file of the dataset.

    Raises:
        StoreError: missing or unreadable.
    """
    try:
        return path.read_bytes()
    except OSError as error:
        raise StoreError(
            f"{path}: cannot be read ({error.strerror}); restore it from a backup or generate it again"
        ) from error


def write_durably(path: Path, data: bytes) -> None:
    """Write a file so that it is wholly there, or not at all, whenever power or process end.

    Raises:
        StoreError: no room or no permission.
    """
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with part.open("wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        part.replace(path)
        sync_folder(path.parent)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise StoreError(
            f"{path}: cannot be written ({error.strerror}); make room or give write permission, then start again:"
            " what was finished is kept"
        ) from error


def sync_folder(folder: Path) -> None:
    """Make renames in a folder durable, where the system can."""
    if os.name == "nt":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
