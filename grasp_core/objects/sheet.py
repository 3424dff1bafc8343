"""A contact sheet: small shaded pictures of objects on one image, drawn back to front with OpenCV."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from grasp_core.objects.asset import ObjectAsset

_LIGHT = np.array([-0.4, 0.7, 0.6]) / np.linalg.norm([-0.4, 0.7, 0.6])
"""In the picture's axes: right, up, towards the viewer."""
_FONT = (cv2.FONT_HERSHEY_SIMPLEX, 0.36)
_CAPTION = 49
"""Pixels of the three lines below a picture."""
_COLOURS = [(214, 159, 94), (96, 164, 244), (120, 190, 120), (180, 130, 200), (90, 200, 210), (140, 140, 230)]


def picture(asset: ObjectAsset, size: int = 180, *, parts: bool = False, turn: float = 0.6) -> NDArray[np.uint8]:
    """One object seen from above at an angle, (size, size, 3) BGR.

    Args:
        asset: the object.
        size: pixels.
        parts: draw the convex parts in changing colours instead of the mesh.
        turn: rotation about the vertical, rad.
    """
    scale = 3 if size < 400 else 2
    canvas = np.full((size * scale, size * scale, 3), 255, np.uint8)
    if parts:
        bodies = [(part.vertices, part.faces, _COLOURS[i % 6]) for i, part in enumerate(asset.parts)]
    else:
        bodies = [(asset.vertices, asset.faces, (190, 170, 150))]
    c, s = np.cos(turn), np.sin(turn)
    tilt = np.radians(35)
    yaw = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
    lean = np.array([[1, 0, 0], [0, np.sin(tilt), np.cos(tilt)], [0, -np.cos(tilt), np.sin(tilt)]])
    view = lean @ yaw
    seen = asset.vertices @ view.T
    middle = (seen.max(axis=0) + seen.min(axis=0)) / 2
    zoom = 0.9 * size * scale / np.ptp(seen, axis=0)[:2].max()
    triangles, colours = [], []
    for vertices, faces, paint in bodies:
        corner = (vertices @ view.T - middle)[faces]
        normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
        front = normal[:, 2] > 0
        shade = np.clip(normal @ _LIGHT, 0, 1) * 0.6 + 0.4
        triangles.append(corner[front])
        colours.append((shade[:, None] * np.array(paint, float))[front])
    corners, tints = np.concatenate(triangles), np.concatenate(colours)
    pixels = corners[:, :, :2] * [zoom, -zoom] + size * scale / 2
    for i in np.argsort(corners[:, :, 2].mean(axis=1)):
        cv2.fillConvexPoly(canvas, np.round(pixels[i] * 16).astype(np.int32), tints[i].tolist(), cv2.LINE_AA, shift=4)
    return np.asarray(cv2.resize(canvas, (size, size), interpolation=cv2.INTER_AREA), np.uint8)


def sheet(
    assets: Sequence[ObjectAsset], columns: int = 10, size: int = 180, *, parts: bool = False
) -> NDArray[np.uint8]:
    """Pictures of objects in rows with name, sides (cm) and number of parts below, (H, W, 3) BGR."""
    rows = -(-len(assets) // columns)
    height = size + _CAPTION
    image = np.full((rows * height, columns * size, 3), 255, np.uint8)
    for i, asset in enumerate(assets):
        y, x = i // columns * height, i % columns * size
        image[y : y + size, x : x + size] = picture(asset, size, parts=parts)
        sides = " x ".join(f"{side * 100:.1f}" for side in asset.extents)
        number = f"{len(asset.parts)} part{'s' * (len(asset.parts) > 1)}"
        for line, text in enumerate((asset.name, f"{sides} cm", number)):
            fitting = _fitting(text, size - 8)
            cv2.putText(image, fitting, (x + 4, y + size + 12 + 15 * line), *_FONT, (60, 60, 60), 1, cv2.LINE_AA)
    return image


def _fitting(text: str, width: int) -> str:
    """The text, shortened in the middle until it is at most `width` pixels wide."""
    left = text
    while cv2.getTextSize(text, *_FONT, 1)[0][0] > width and len(left) > 4:
        middle = len(left) // 2
        left = left[:middle] + left[middle + 1 :]
        text = left[: len(left) // 2] + ".." + left[len(left) // 2 :]
    return text
