"""A mesh, open or closed, as the space that no view from outside reaches: what a camera takes for solid.

Volume from winding fails on open, doubled and badly wound meshes. Here a cell is outside when a straight line from it
leaves the grid in one of 26 directions; all else is solid: walls, closed insides, and sheets one cell thick. Openings
of pots and lamps stay open, cracks of up to two cells do not let the outside in.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy import ndimage

MARGIN = 3
"""Free cells around the mesh."""

MOST_SAMPLES = 400_000
"""At most so many points stand for a surface."""

DENSITY = 6.0
"""Points for each cell's face that the surface fills."""


@dataclass(frozen=True)
class Voxels:
    """A grid of cubic cells.

    Attributes:
        origin: (3,) corner of the first cell.
        cell: side of a cell, in the mesh's units.
        solid: (X, Y, Z) whether a cell is solid.
        points: (N, 3) points of the surface, its vertices among them.
        owners: (N, 3) cell that each point lies in.
        visible: (N,) whether a point is seen from outside: the cells next to it are not all solid.
    """

    origin: NDArray[np.float64]
    cell: float
    solid: NDArray[np.bool_]
    points: NDArray[np.float64]
    owners: NDArray[np.int64]
    visible: NDArray[np.bool_]


def voxelize(mesh: trimesh.Trimesh, cells: int) -> Voxels:
    """Cells and surface points of a mesh, the same for the same mesh on every machine.

    Args:
        mesh: any triangle mesh with an area.
        cells: along the longest side.
    """
    low, side = np.asarray(mesh.bounds[0]), float(mesh.extents.max())
    cell = side / cells
    origin = low - (MARGIN + 0.5 * (1 - np.mod(mesh.extents / cell, 1))) * cell
    shape = np.ceil(mesh.extents / cell).astype(int) + 2 * MARGIN + 1
    points = surface_points(mesh, DENSITY / cell**2)
    owners = np.clip(((points - origin) / cell).astype(np.int64), 0, shape - 1)
    wall = np.zeros(shape, bool)
    wall[tuple(owners.T)] = True
    solid = ~_outside(wall)
    near = ndimage.binary_dilation(~solid, np.ones((3, 3, 3), bool))
    return Voxels(origin, cell, solid, points, owners, near[tuple(owners.T)])


def surface_points(mesh: trimesh.Trimesh, density: float) -> NDArray[np.float64]:
    """Vertices and evenly random points of a mesh's surface, (N, 3), always the same for the same mesh.

    Args:
        mesh: with an area.
        density: points for a unit of area; fewer where that would be more than `MOST_SAMPLES`.
    """
    count = int(np.clip(mesh.area * density, 2000, MOST_SAMPLES))
    points, _ = trimesh.sample.sample_surface(mesh, count, seed=0)
    return np.concatenate([np.asarray(mesh.vertices), np.asarray(points)])


def _outside(wall: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Cells from which one of 26 directions leads out past the walls, cracks in these closed."""
    thick = ndimage.binary_dilation(wall)
    seen = np.zeros_like(wall)
    for direction in itertools.product((-1, 0, 1), repeat=3):
        if any(direction):
            seen |= _swept(thick, direction)
    return ndimage.binary_dilation(seen, np.ones((3, 3, 3), bool)) & ~wall


def _swept(wall: NDArray[np.bool_], direction: tuple[int, ...]) -> NDArray[np.bool_]:
    """Cells that light along `direction` (steps of -1, 0, 1) reaches from outside the grid."""
    axis = next(i for i, step in enumerate(direction) if step)
    wall = np.moveaxis(wall, axis, 0)
    across = [step for i, step in enumerate(direction) if i != axis]
    lit = np.zeros_like(wall)
    order = range(len(wall)) if direction[axis] > 0 else range(len(wall) - 1, -1, -1)
    front = np.ones(wall.shape[1:], bool)
    for i in order:
        lit[i] = front & ~wall[i]
        front = _shifted(lit[i], across)
    return np.moveaxis(lit, 0, axis)


def _shifted(plane: NDArray[np.bool_], steps: list[int]) -> NDArray[np.bool_]:
    """A plane moved by whole cells; what comes in at its border is lit."""
    for axis, step in enumerate(steps):
        if step:
            plane = np.roll(plane, step, axis)
            border = [slice(None), slice(None)]
            border[axis] = slice(0, 1) if step > 0 else slice(-1, None)
            plane[tuple(border)] = True
    return plane
