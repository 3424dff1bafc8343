"""Reading depth images and masks from files, and filling their holes."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import Camera, DepthImage
from grasp_core.errors import ImageError

_NEAREST = 0.05
"""Metres: a median depth below it means a wrong scale."""

_STEP = 0.01
"""Metres: depths farther apart than this lie on different surfaces and are never averaged while filling."""


def read_depth(path: str | Path, camera: Camera, depth_scale: float | None = None) -> DepthImage:
    """Read a depth image: `.npy` with metres, or a 16-bit PNG or a TIFF.

    Args:
        path: the file.
        camera: of this image; its size must be the image's.
        depth_scale: metres per unit of the file, e.g. 0.001 for millimetres. Files of whole numbers need it; files of
            floating point are metres without it.

    Raises:
        ImageError: missing, damaged or wrong file, a size that is not the camera's, or values that cannot be metres;
            the message names the file.
    """
    path = Path(path)
    array = _read_array(path)
    try:
        if depth_scale is not None:
            if not (np.isfinite(depth_scale) and depth_scale > 0):
                raise ImageError(f"the depth scale is metres per unit and above 0, not {depth_scale}")
            if array.dtype.kind in "fiu":
                array = array.astype(np.float64) * depth_scale
        elif array.dtype.kind in "iu":
            raise ImageError(
                f"whole numbers ({array.dtype}) are no metres; say what a unit is, --depth-scale 0.001 for millimetres"
            )
        image = DepthImage.from_array(array, camera)
        median = float(np.median(image.depth[image.valid]))
        if median < _NEAREST:
            raise ImageError(
                f"the median depth is {median * 1000:.2f} mm: the depth scale is wrong; check --depth-scale"
            )
    except ImageError as error:
        raise ImageError(f"{path}: {error}") from error
    return image


def read_mask(path: str | Path, shape: tuple[int, int]) -> NDArray[np.bool_]:
    """Read a mask image of 8 or 16 bits: boolean (H, W), true where any colour channel is above 0.

    Raises:
        ImageError: missing or damaged file, or a size other than `shape` (H, W); the message names the file.
    """
    path = Path(path)
    if not path.is_file():
        raise ImageError(f"{path}: no such file")
    read = _read_array(path) if path.suffix.lower() == ".npy" else cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    if read is None:
        raise ImageError(f"{path}: cannot be read as an image; give a PNG whose white pixels may be grasped")
    array: NDArray[np.bool_] = np.asarray(read) > 0
    if array.ndim == 3:
        array = np.any(array[:, :, :3], axis=2)
    if array.shape != tuple(shape):
        raise ImageError(
            f"{path}: the mask is {array.shape[-1]}×{array.shape[0]} pixels but the image {shape[1]}×{shape[0]};"
            " give the mask of this image"
        )
    return np.asarray(array)


def _read_array(path: Path) -> NDArray:
    if not path.is_file():
        raise ImageError(f"{path}: no such file")
    suffix = path.suffix.lower()
    if suffix == ".npy":
        try:
            return np.asarray(np.load(path, allow_pickle=False))
        except (ValueError, OSError, EOFError) as error:
            raise ImageError(f"{path}: is not a NumPy array of numbers ({error})") from error
    if suffix not in (".png", ".tif", ".tiff"):
        raise ImageError(f"{path}: depth images are .npy (metres), .png (16 bits) or .tiff files, not '{suffix}'")
    array = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    if array is None:
        raise ImageError(f"{path}: cannot be read as an image; the file is damaged or something else")
    if array.dtype == np.uint8:
        raise ImageError(f"{path}: 8 bits hold no depth (a picture of it?); give the 16-bit or floating-point original")
    return np.asarray(array)


def fill_holes(image: DepthImage) -> tuple[DepthImage, float]:
    """Fill the invalid pixels, and only those, from around them.

    See `fill` for how. Returns the image, valid everywhere, and the share of pixels that was missing.

    Raises:
        ImageError: no pixel is valid.
    """
    if not image.valid.any():
        raise ImageError("the depth image has no valid pixel to fill the holes from")
    missing = 1 - float(image.valid.mean())
    filled = fill(image.depth, image.valid)
    return DepthImage(filled, image.camera, np.ones_like(image.valid)), missing


def fill(depth: NDArray[np.float32], valid: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Depth (H, W) with its invalid pixels filled; at least one pixel must be valid.

    A hole beside an edge is the shadow of the nearer thing. So each hole is filled from the farthest surface on its rim
    alone, and no slope grows between two surfaces. Several times faster than in-painting.
    """
    if valid.all():
        return depth.copy()
    count, labels = cv2.connectedComponents((~valid).view(np.uint8), connectivity=8, ltype=cv2.CV_32S)
    beside = cv2.dilate(labels.astype(np.float32), np.ones((3, 3), np.uint8)).astype(np.int32)
    rim = valid & (beside > 0)
    farthest = np.zeros(count, np.float32)
    np.maximum.at(farthest, beside[rim], depth[rim])
    rim[rim] = depth[rim] >= farthest[beside[rim]] - _STEP
    return np.where(valid, depth, _spread(depth, rim))


def _spread(depth: NDArray[np.float32], known: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Depth (H, W) with what is not known taken from the smallest block of 2ⁿ pixels that holds something known."""
    if known.all() or not known.any():
        return depth
    height, width = depth.shape
    even = ((0, height % 2), (0, width % 2))
    weight = np.pad(known.astype(np.float32), even)
    total = np.pad(np.where(known, depth, np.float32(0)), even)
    weight = weight[0::2, 0::2] + weight[0::2, 1::2] + weight[1::2, 0::2] + weight[1::2, 1::2]
    total = total[0::2, 0::2] + total[0::2, 1::2] + total[1::2, 0::2] + total[1::2, 1::2]
    coarse = _spread(total / np.maximum(weight, 1), weight > 0)
    return np.where(known, depth, cv2.resize(coarse, None, fx=2, fy=2, interpolation=cv2.INTER_LINEAR)[:height, :width])
