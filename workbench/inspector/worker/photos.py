"""Own depth images: reading them with their camera."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from grasp_core.camera import Camera, CameraIntrinsics, DepthImage, load_camera
from grasp_core.errors import GraspError, ImageError
from grasp_core.sensing.preprocess import read_depth
from workbench.inspector.orders import Photo
from workbench.inspector.worker.scenes import Files, file_of
from workbench.inspector.worker.words import reworded


def read_photo(photo: Photo, files: Files) -> DepthImage:
    """An own depth image with its camera.

    Raises:
        GraspError: a file is not there, damaged, or of another size than the camera's.
    """
    path = file_of(photo.key, files)
    try:
        return read_depth(path, _camera(photo, path, files), photo.scale or None)
    except GraspError as error:
        raise GraspError(reworded(str(error), (path, *files.values()))) from error


def check_camera(key: str, files: Files) -> None:
    """Read an own camera file, so that one of no use is told before an image needs it.

    Raises:
        GraspError: it is not there or no camera file.
    """
    path = file_of(key, files)
    try:
        load_camera(path)
    except GraspError as error:
        raise GraspError(reworded(str(error), [path])) from error


def _camera(photo: Photo, path: Path, files: Files) -> Camera:
    if photo.typed is not None:
        fx, fy, cx, cy = photo.typed
        height, width = _shape(path)
        return Camera(CameraIntrinsics(fx, fy, cx, cy, width, height))
    if photo.camera.startswith("camera-"):
        return load_camera(file_of(photo.camera, files))
    if not photo.camera:
        raise GraspError("this image has no camera; choose a camera file, a shipped camera, or type its intrinsics")
    # A shipped camera's pose is the canonical one or none: an own image brings its own table.
    return Camera(load_camera(photo.camera).intrinsics)


def _shape(path: Path) -> tuple[int, int]:
    """Rows and columns of an image file."""
    try:
        shape = np.load(path, mmap_mode="r").shape if path.suffix.lower() == ".npy" else None
    except (OSError, ValueError) as error:
        raise ImageError(f"{path}: cannot be read ({error})") from error
    if shape is None:
        read = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
        if read is None:
            raise ImageError(f"{path}: cannot be read as an image")
        shape = read.shape
    if len(shape) not in (2, 3):
        raise ImageError(f"{path}: holds an array of shape {shape}, no image")
    return int(shape[0]), int(shape[1])
