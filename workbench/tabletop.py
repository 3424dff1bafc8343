"""Light, table, grid and shadows: what every view stands on, cheap enough for browsers that draw in software.

Shadow maps and shader grids are computed for every pixel of the table, which costs three quarters of a frame without a
GPU. Here the grid is a mesh of thin strips, and a shadow is the convex pieces of a body, flattened along the light.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import cv2
import numpy as np
import viser
from numpy.typing import NDArray

from workbench import colours
from workbench.bridge import Bridge
from workbench.casting import plain, put

_SUN = (-0.42, -0.3, 1.0)
"""Where the light comes from, seen from the table's middle."""
_HALF = 0.45
"""Half of the table's side, metres."""
_CELL, _LINE = 0.05, 0.0009
_HEIGHTS = {"table": -0.0004, "shadow": 0.0, "grid": 0.0003}
"""Metres; apart, so that none of them flickers through another."""
_FLAT: dict[str, Any] = {"material": "toon3", "cast_shadow": False, "receive_shadow": False}
"""Of what is flat: the cheapest material that viser has, which looks the same there."""
_NOTHING = (np.zeros((3, 3), np.float32), np.array([[0, 1, 2]], np.uint32))

Body = tuple[Any, Sequence[NDArray[np.floating[Any]]]]
"""A scene node, and the corners (K, 3) of the convex pieces of what it shows, in the node's frame."""


def furnish(bridge: Bridge) -> viser.MeshHandle:
    """Put light, table and grid into a scene; gives the grid, which may be hidden."""
    scene, node = bridge.client.scene, bridge.node
    scene.add_light_ambient(node("/light/all"), color=(255, 255, 255), intensity=0.75)
    scene.add_light_directional(
        node("/light/sun"), color=(255, 250, 240), intensity=1.9, cast_shadow=False, position=_SUN
    )
    scene.add_light_hemisphere(node("/light/sky"), sky_color=(225, 235, 255), ground_color=(70, 66, 60), intensity=0.8)
    side, depth = 2 * _HALF, 0.02
    place = (0, 0, _HEIGHTS["table"] - depth / 2)
    table = scene.add_box(
        node("/table"), color=colours.TABLE.dark, dimensions=(side, side, depth), position=place, **_FLAT
    )
    grid = scene.add_mesh_simple(node("/grid"), *strips(), color=colours.GRID.dark, **_FLAT)
    bridge.themed(table, colours.TABLE)
    bridge.themed(grid, colours.GRID)
    return grid


def strips() -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """The lines of the grid as strips: vertices (N, 3), metres, and faces (M, 3)."""
    places = np.arange(-_HALF + _CELL, _HALF - _CELL / 2, _CELL)
    along = [(p - _LINE / 2, -_HALF, p + _LINE / 2, _HALF) for p in places]
    bounds = np.array(along + [(y0, x0, y1, x1) for x0, y0, x1, y1 in along])
    corners = bounds[:, [[0, 1], [2, 1], [2, 3], [0, 3]]]
    vertices = np.concatenate([corners, np.full((*corners.shape[:2], 1), _HEIGHTS["grid"])], axis=2)
    faces = 4 * np.arange(len(bounds))[:, None, None] + np.array([[0, 1, 2], [0, 2, 3]])
    return vertices.reshape(-1, 3).astype(np.float32), faces.reshape(-1, 3).astype(np.uint32)


def box_corners(size: Sequence[float]) -> NDArray[np.float64]:
    """(8, 3) of a box about its frame's origin."""
    return np.array(np.meshgrid(*([-side / 2, side / 2] for side in size))).reshape(3, -1).T


def outline(corners: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
    """Corners (K, 3) of a convex piece, world, metres → the outline (M, 2) of its shadow, counter-clockwise."""
    flat = corners[:, :2] - corners[:, 2:] * (np.array(_SUN[:2]) / _SUN[2])
    return np.asarray(cv2.convexHull(np.clip(flat, -_HALF, _HALF).astype(np.float32)), np.float32)[:, 0]


class Shadows:
    """The shadows that some bodies cast on the table, as one flat mesh."""

    def __init__(self, bridge: Bridge) -> None:
        scene = bridge.client.scene
        self._mesh = scene.add_mesh_simple(
            bridge.node("/shadows"), *_NOTHING, color=colours.SHADE.dark, visible=False, **_FLAT
        )
        bridge.themed(self._mesh, colours.SHADE)
        self._cast: tuple[object, ...] = ()

    def cast(self, bodies: Sequence[Body]) -> None:
        """Draw them where the bodies are now; hidden ones cast none. Nothing is sent where nothing moved."""
        seen = [(handle, pieces) for handle, pieces in bodies if handle.visible]
        now = tuple((id(pieces), *plain(tuple(handle.wxyz)), *plain(tuple(handle.position))) for handle, pieces in seen)
        if now == self._cast:
            return
        self._cast = now
        vertices, faces, count = [], [], 0
        for handle, pieces in seen:
            turn = viser.transforms.SO3(np.asarray(handle.wxyz, float)).as_matrix()
            for corners in pieces:
                edge = outline(corners @ turn.T + np.asarray(handle.position, float))
                fan = np.arange(1, len(edge) - 1)
                vertices.append(np.column_stack([edge, np.full(len(edge), _HEIGHTS["shadow"])]))
                faces.append(count + np.column_stack([np.zeros_like(fan), fan, fan + 1]))
                count += len(edge)
        put(self._mesh, visible=count > 0)
        if count:
            put(
                self._mesh,
                vertices=np.concatenate(vertices).astype(np.float32),
                faces=np.concatenate(faces).astype(np.uint32),
            )
