"""Convex decomposition of what a camera sees: cells are cut until every piece is nearly convex, then grown together.

Cutting alone cannot take a ring apart well (its halves are no more convex than the whole), growing together can: always
the two neighbours whose common hull takes the least space that is free, each free cell weighed by how far it is from
the surface. A filled slit costs next to nothing, a filled bowl much. Parts are then the hulls of the mesh's own points
in each piece, so that flat sides and corners are exact; thin sheets get a small solid thickness.
"""

from __future__ import annotations

import heapq
import itertools
from dataclasses import dataclass

import manifold3d
import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy import ndimage

from grasp_core.objects.asset import Part
from grasp_core.objects.hulls import arrays, convex_part, planes
from grasp_core.objects.voxels import Voxels, voxelize

CELLS = 64
"""Along the longest side."""

HARMLESS = 1.3
"""Free cells this near to solid ones (cells, centre to centre) may be filled for nothing."""

SHEET = 0.012
"""Least thickness of a part as a share of the longest side: 2 mm for 17 cm."""

MOST_PIECES = 220
"""No piece is cut when there are so many."""

SMALLEST = 12
"""Pieces of fewer cells are not cut."""

_NORMALS = np.array(
    [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, -1, 0], [1, 0, 1], [1, 0, -1], [0, 1, 1], [0, 1, -1]]
)


@dataclass
class _Piece:
    cells: NDArray[np.int64]
    corners: NDArray[np.float64]
    volume: float
    cost: float


def cut(mesh: trimesh.Trimesh, max_parts: int, max_vertices: int = 24) -> list[Part]:
    """Closed convex parts for the visible surface of any mesh.

    Args:
        mesh: open or closed, of any winding.
        max_parts: at most so many; fewer where that costs nothing.
        max_vertices: at most so many vertices each.
    """
    voxels = voxelize(mesh, CELLS)
    costs = np.maximum(ndimage.distance_transform_edt(~voxels.solid) - HARMLESS, 0.0)
    pieces = _grown(_cut_up(np.argwhere(voxels.solid), costs), costs, max_parts)
    return _hulls(voxels, pieces, float(mesh.extents.max()), max_vertices)


def _piece(cells: NDArray[np.int64], costs: NDArray[np.float64], corners: NDArray[np.float64] | None = None) -> _Piece:
    hull = manifold3d.Manifold.hull_points(_extremes(cells) if corners is None else corners)
    vertices, faces = arrays(hull)
    return _Piece(cells, vertices, hull.volume(), _filled(vertices, faces, costs))


def _extremes(cells: NDArray[np.int64]) -> NDArray[np.float64]:
    """Corners of those cells that can touch the hull: those without neighbours on both sides."""
    low = cells.min(axis=0)
    shape = cells.max(axis=0) - low + 1
    at = (cells - low) @ [shape[1] * shape[2], shape[2], 1]
    grid = np.zeros(int(shape.prod()), bool)
    grid[at] = True
    grid = grid.reshape(shape)
    end = grid.copy()
    end[:, :, 1:-1] &= ~(grid[:, :, :-2] & grid[:, :, 2:])
    corners = np.zeros(shape + 1, bool)
    for i, j, k in itertools.product((0, 1), repeat=3):
        corners[i : i + shape[0], j : j + shape[1], k : k + shape[2]] |= end
    return np.argwhere(corners) + low.astype(float)


def _filled(vertices: NDArray[np.float64], faces: NDArray[np.int32], costs: NDArray[np.float64]) -> float:
    """What the free cells in a hull cost."""
    low = np.floor(vertices.min(axis=0)).astype(int)
    high = np.ceil(vertices.max(axis=0)).astype(int)
    box = costs[low[0] : high[0], low[1] : high[1], low[2] : high[2]]
    free = np.argwhere(box > 0)
    if len(free) == 0:
        return 0.0
    normals, heights = planes(vertices, faces)
    centres = free + low + 0.5
    inside = np.ones(len(free), bool)
    for start in range(0, len(normals), 16):
        at = np.flatnonzero(inside)
        inside[at] = (centres[at] @ normals[start : start + 16].T <= heights[start : start + 16] + 1e-9).all(axis=1)
    return float(box[tuple(free[inside].T)].sum())


def _cut_up(cells: NDArray[np.int64], costs: NDArray[np.float64]) -> list[_Piece]:
    """Pieces that are nearly convex, always cutting the one that fills most."""
    heap: list[tuple[float, int, _Piece]] = []
    done: list[_Piece] = []
    count = 0

    def add(some: NDArray[np.int64]) -> None:
        nonlocal count
        for body in _connected(some):
            piece = _piece(body, costs)
            count += 1
            if piece.cost > 0 and len(body) >= SMALLEST:
                heapq.heappush(heap, (-piece.cost, count, piece))
            else:
                done.append(piece)

    add(cells)
    while heap and len(heap) + len(done) < MOST_PIECES:
        piece = heapq.heappop(heap)[2]
        side = _best_cut(piece)
        add(piece.cells[side])
        add(piece.cells[~side])
    return done + [piece for _, _, piece in sorted(heap, key=lambda one: one[1])]


def _connected(cells: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    low = cells.min(axis=0)
    grid = np.zeros(cells.max(axis=0) - low + 1, bool)
    grid[tuple((cells - low).T)] = True
    labels, count = ndimage.label(grid, np.ones((3, 3, 3)))
    if count == 1:
        return [cells]
    mine = labels[tuple((cells - low).T)]
    order = np.argsort(mine, kind="stable")
    return np.split(cells[order], np.cumsum(np.bincount(mine)[1:])[:-1])


def _best_cut(piece: _Piece) -> NDArray[np.bool_]:
    """On which side of the best plane each cell lies: the smallest hulls, and cuts near the middle among equals."""
    best, chosen = np.inf, np.zeros(0, bool)
    for normal in _NORMALS:
        along = piece.cells @ normal
        low, high = int(along.min()), int(along.max())
        if high == low:
            continue
        for share in (0.5, 0.25, 0.75, 0.375, 0.625, 0.125, 0.875):
            side = along <= low + int(share * (high - low))
            if side.all() or not side.any():
                continue
            volume = sum(
                manifold3d.Manifold.hull_points(_extremes(piece.cells[half])).volume() for half in (side, ~side)
            )
            score = volume / piece.volume + 0.1 * abs(share - 0.5)
            if score < best - 1e-12:
                best, chosen = score, side
    return chosen


def _grown(pieces: list[_Piece], costs: NDArray[np.float64], max_parts: int) -> list[_Piece]:
    """Pieces merged while that costs nothing, or there are too many."""
    alive = dict(enumerate(pieces))
    owner = np.full(costs.shape, -1)
    for i, piece in alive.items():
        owner[tuple(piece.cells.T)] = i
    heap: list[tuple[float, int, int, _Piece]] = []
    near = {i: _neighbours(piece, owner) - {i} for i, piece in alive.items()}

    def offer(i: int, j: int) -> None:
        a, b = alive[i], alive[j]
        both = _piece(np.concatenate([a.cells, b.cells]), costs, np.concatenate([a.corners, b.corners]))
        extra = both.cost - a.cost - b.cost + 1e-3 * max(both.volume - a.volume - b.volume, 0.0)
        heapq.heappush(heap, (extra, i, j, both))

    for i in alive:
        for j in sorted(near[i]):
            if j > i:
                offer(i, j)
    spread = False
    while len(alive) > 1:
        while heap and (heap[0][1] not in alive or heap[0][2] not in alive):
            heapq.heappop(heap)
        if not heap:
            if spread or len(alive) <= max_parts:
                break
            spread = True
            for i in alive:
                near[i] = set(alive) - {i}
                for j in sorted(near[i]):
                    if j > i:
                        offer(i, j)
            continue
        _, i, j, both = heapq.heappop(heap)
        if len(alive) <= max_parts and both.cost > max(alive[i].cost, alive[j].cost):
            continue
        new = max(alive) + 1
        near[new] = (near[i] | near[j]) - {i, j}
        del alive[i], alive[j]
        alive[new] = both
        for k in sorted(near[new]):
            if k in alive:
                near[k].add(new)
                offer(k, new)
    return list(alive.values())


def _neighbours(piece: _Piece, owner: NDArray[np.int64]) -> set[int]:
    """Pieces with a cell at most two cells away."""
    low = np.maximum(piece.cells.min(axis=0) - 2, 0)
    high = piece.cells.max(axis=0) + 3
    box = tuple(slice(a, b) for a, b in zip(low, high, strict=True))
    grid = np.zeros(owner[box].shape, bool)
    grid[tuple((piece.cells - low).T)] = True
    around = ndimage.binary_dilation(grid, np.ones((3, 3, 3)), iterations=2)
    return set(np.unique(owner[box][around]).tolist()) - {-1}


def _hulls(voxels: Voxels, pieces: list[_Piece], side: float, max_vertices: int) -> list[Part]:
    """Hulls of the mesh's points in each piece; pieces without three points are none."""
    owner = np.full(voxels.solid.shape, -1)
    for i, piece in enumerate(pieces):
        owner[tuple(piece.cells.T)] = i
    mine = owner[tuple(voxels.owners.T)]
    parts = []
    for i in range(len(pieces)):
        points = voxels.points[mine == i]
        if len(np.unique(points, axis=0)) >= 3:
            parts.append(convex_part(thickened(points, SHEET * side), max_vertices))
    return parts


def thickened(points: NDArray[np.float64], least: float) -> NDArray[np.float64]:
    """Points (N, 3), widened along the normal of their plane where they are thinner than `least`."""
    centred = points - points.mean(axis=0)
    _, axes = np.linalg.eigh(centred.T @ centred)
    for axis in axes.T:
        thickness = float(np.ptp(points @ axis))
        if thickness < least:
            step = axis * (least - thickness) / 2
            points = np.concatenate([points - step, points + step])
    return points
