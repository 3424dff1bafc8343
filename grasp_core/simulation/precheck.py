"""What a height map settles without dynamics: grasps that collide on the way in, and grasps that close on nothing.

The gripper comes straight down, so a finger, the rod or the base meets whatever stands higher under its footprint than
its own lower end. Between the fingers, nothing higher than their lower ends means nothing to grasp.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from grasp_core.gripper import Box, Gripper
from grasp_core.simulation.physics import Physics

_BLOCK = 256
"""Grasps looked up at once: keeps the tables of footprint cells small."""


class Verdict(IntEnum):
    """What the height map says about a grasp."""

    OPEN = 0
    COLLISION = 1
    MISSED = 2


BODIES = ("left_finger", "right_finger", "rod", "base")
TABLE = -1
"""Stands for the table where the index of an object is expected."""


@dataclass(frozen=True)
class HeightMap:
    """Top of the objects' parts, seen from straight above.

    Attributes:
        corner: world x, y of the centre of cell (0, 0), metres.
        cell: metres.
        heights: (X, Y) float32, 0 where there is only table.
        owners: (X, Y) int16, index of the highest object, −1 for the table.
    """

    corner: NDArray[np.float64]
    cell: float
    heights: NDArray[np.float32]
    owners: NDArray[np.int16]

    @classmethod
    def of(cls, parts: Sequence[Sequence[NDArray[np.float64]]], cell: float) -> HeightMap:
        """Rasterise convex parts: per object, the vertices (V, 3) of each part in the world, metres."""
        points = np.concatenate([vertices for item in parts for vertices in item])
        low = np.floor(points[:, :2].min(axis=0) / cell).astype(int) - 2
        high = np.ceil(points[:, :2].max(axis=0) / cell).astype(int) + 2
        heights = np.zeros(tuple(high - low + 1), np.float32)
        owners = np.full(heights.shape, TABLE, np.int16)
        for index, item in enumerate(parts):
            for vertices in item:
                _draw(heights, owners, low, cell, vertices, index)
        return cls(low * cell, cell, heights, owners)

    def at(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """Flat cell indices and heights at world positions of one shape; the map's border is table, as all beyond."""
        rows, columns = self.heights.shape
        i = np.clip((x - self.corner[0]) * (1 / self.cell) + 0.5, 0, rows - 1).astype(np.int32)
        j = np.clip((y - self.corner[1]) * (1 / self.cell) + 0.5, 0, columns - 1).astype(np.int32)
        flat = i * np.int32(columns) + j
        return flat, self.heights.ravel()[flat]

    @cached_property
    def coarse(self) -> HeightMap:
        """The same in cells eight times as large, each as high as anything within one such cell around it."""
        size = 8
        rows, columns = (-(-n // size) for n in self.heights.shape)
        padded = np.zeros((rows * size, columns * size), np.float32)
        padded[: self.heights.shape[0], : self.heights.shape[1]] = self.heights
        blocks = np.pad(padded.reshape(rows, size, columns, size).max(axis=(1, 3)), 2)
        spread = np.asarray(cv2.dilate(blocks, np.ones((3, 3), np.uint8)), np.float32)
        cell = self.cell * size
        corner = self.corner + (size - 1) / 2 * self.cell - 2 * cell
        return HeightMap(corner, cell, spread, np.full(spread.shape, TABLE, np.int16))


def _draw(
    heights: NDArray[np.float32],
    owners: NDArray[np.int16],
    low: NDArray[np.intp],
    cell: float,
    vertices: NDArray[np.float64],
    owner: int,
) -> None:
    """Raise the map to the top of one convex part: the lowest of its upper planes, within its shadow."""
    hull = ConvexHull(vertices)
    a = np.floor(vertices[:, :2].min(axis=0) / cell).astype(int)
    b = np.ceil(vertices[:, :2].max(axis=0) / cell).astype(int)
    xy = np.meshgrid(np.arange(a[0], b[0] + 1) * cell, np.arange(a[1], b[1] + 1) * cell, indexing="ij")
    planes = np.unique(hull.equations.round(9), axis=0)
    shadow = ConvexHull(vertices[:, :2])
    inside = np.ones(xy[0].shape, bool)
    for nx, ny, offset in np.unique(shadow.equations.round(9), axis=0):
        inside &= nx * xy[0] + ny * xy[1] + offset <= 1e-9
    top = np.full(xy[0].shape, np.inf)
    for nx, ny, nz, offset in planes[planes[:, 2] > 1e-6]:
        np.minimum(top, -(nx * xy[0] + ny * xy[1] + offset) / nz, out=top)
    window = tuple(slice(start, end + 1) for start, end in zip(a - low, b - low, strict=True))
    higher = inside & (top > heights[window])
    heights[window][higher] = top[higher]
    owners[window][higher] = owner


@dataclass(frozen=True)
class Prechecked:
    """Verdicts on N grasps.

    Attributes:
        verdict: (N,) values of `Verdict`.
        body: (N,) index into `BODIES` of what collides first on the way down, −1 without collision.
        obstacle: (N,) index of the object that it meets, −1 for the table.
        place: (N, 3) where, world metres; nan without collision.
        gaps: (N, 2) free way of the left and right finger from opening w to the first contact, metres; inf if it meets
            nothing on its side or beyond.
    """

    verdict: NDArray[np.int8]
    body: NDArray[np.int8]
    obstacle: NDArray[np.int16]
    place: NDArray[np.float64]
    gaps: NDArray[np.float64]


def _cells(x: tuple[float, float], y: tuple[float, float], step: float) -> NDArray[np.float64]:
    """(K, 2) sample points that fill a rectangle, no farther apart than `step`, its edges included."""
    axes = [np.linspace(a, b, max(2, int(np.ceil((b - a) / step)) + 1)) for a, b in (x, y)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)


def _cover(box: Box, step: float) -> NDArray[np.float64]:
    return _cells((-box.x / 2, box.x / 2), (-box.y / 2, box.y / 2), step)


class Precheck:
    """The height map of one scene and what follows from it for grasps by one gripper.

    Attributes:
        map: the height map.
    """

    def __init__(self, parts: Sequence[Sequence[NDArray[np.float64]]], gripper: Gripper, physics: Physics) -> None:
        """Rasterise the scene.

        Args:
            parts: per object the vertices (V, 3) of its convex parts in the world, metres.
            gripper: what comes down.
            physics: its `cell` is the resolution.
        """
        self.map = HeightMap.of(parts, physics.cell)
        self._gripper = gripper
        self._highest = float(self.map.heights.max())
        g = gripper
        # Samples every second cell: nothing of an object is thinner than that.
        step = 2 * physics.cell
        self._finger = _cells((0.0, g.finger.x), (-g.finger.y / 2, g.finger.y / 2), step)
        self._blocks = {
            "rod": (_cover(g.rod, step), _cover(g.rod, 8 * physics.cell), g.finger.z),
            "base": (_cover(g.base, step), _cover(g.base, 8 * physics.cell), g.finger.z + g.rod.z),
        }

    def check(self, grasps: NDArray[np.float64]) -> Prechecked:
        """Judge grasps.

        Args:
            grasps: (N, 5): x, y, z of p, φ, w; as executed, noise included.
        """
        n = len(grasps)
        result = Prechecked(
            np.zeros(n, np.int8),
            np.full(n, -1, np.int8),
            np.full(n, TABLE, np.int16),
            np.full((n, 3), np.nan),
            np.full((n, 2), np.inf),
        )
        for start in range(0, n, _BLOCK):
            rows = np.arange(start, min(n, start + _BLOCK))
            self._collide(grasps, rows, result)
            self._between(grasps, rows[result.verdict[rows] == Verdict.OPEN], result)
        return result

    def _look(
        self, grasps: NDArray[np.float64], local: NDArray[np.float64], map_: HeightMap | None = None
    ) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
        """Cells and heights (N, K) under points of the gripper frame, (K, 2) or (N, K, 2)."""
        c, s = np.cos(grasps[:, 3, None]), np.sin(grasps[:, 3, None])
        x, y = local[..., 0], local[..., 1]
        return (map_ or self.map).at(grasps[:, 0, None] + c * x - s * y, grasps[:, 1, None] + s * x + c * y)

    def _collide(self, grasps: NDArray[np.float64], rows: NDArray[np.intp], result: Prechecked) -> None:
        """Mark the grasps whose gripper meets something; the body that meets first, seen from above, is named."""
        chosen = grasps[rows]
        depth = np.zeros(len(rows))
        for body, name in enumerate(BODIES):
            if name in self._blocks:
                points, rough, bottom = self._blocks[name]
                near = np.flatnonzero(self._highest > chosen[:, 2] + bottom)
                if len(near):  # the coarse map spares most of them the fine one
                    most = self._look(chosen[near], rough, self.map.coarse)[1].max(axis=1)
                    near = near[most > chosen[near, 2] + bottom]
            else:
                side = -1.0 if name == "left_finger" else 1.0
                near, bottom = np.arange(len(rows)), 0.0
                points = np.stack(
                    [
                        side * (chosen[:, 4, None] / 2 + self._finger[:, 0]),
                        np.broadcast_to(self._finger[:, 1], (len(rows), len(self._finger))),
                    ],
                    axis=-1,
                )
            if not len(near):
                continue
            flat, heights = self._look(chosen[near], points)
            best = heights.argmax(axis=1)
            pick = np.arange(len(near)), best
            into = heights[pick] - (chosen[near, 2] + bottom)
            hit = into > depth[near]
            at = near[hit]
            depth[at] = into[hit]
            result.verdict[rows[at]] = Verdict.COLLISION
            result.body[rows[at]] = body
            cells = flat[pick][hit]
            owners = self.map.owners.ravel()[cells]
            result.obstacle[rows[at]] = owners
            i, j = np.divmod(cells, self.map.heights.shape[1])
            xy = np.stack([i, j], axis=1) * self.map.cell + self.map.corner
            xy[owners == TABLE] = chosen[at[owners == TABLE], :2]
            result.place[rows[at]] = np.concatenate([xy, heights[pick][hit][:, None]], axis=1)

    def _between(self, grasps: NDArray[np.float64], rows: NDArray[np.intp], result: Prechecked) -> None:
        """Mark the grasps with nothing between the fingers; measure the others' gaps."""
        if not len(rows):
            return
        chosen = grasps[rows]
        half = self._gripper.finger.y / 2
        step = 2 * self.map.cell
        count = int(np.ceil(self._gripper.opening / step)) + 1
        across = np.linspace(-half, half, int(np.ceil(2 * half / step)) + 1)
        local = np.stack(np.broadcast_arrays(np.linspace(-0.5, 0.5, count)[:, None], across), axis=-1).reshape(-1, 2)
        points = np.stack([chosen[:, 4, None] * local[:, 0], np.broadcast_to(local[:, 1], (len(rows), len(local)))], -1)
        _, heights = self._look(chosen, points)
        above: NDArray[np.bool_] = heights.reshape(len(rows), count, -1) > chosen[:, 2, None, None]
        solid = np.any(above, axis=2)
        something = np.any(solid, axis=1)
        result.verdict[rows[~something]] = Verdict.MISSED
        ways = chosen[:, 4] / (count - 1)
        left = solid.argmax(axis=1) * ways
        right = solid[:, ::-1].argmax(axis=1) * ways
        result.gaps[rows[something]] = np.stack([left, right], axis=1)[something]
