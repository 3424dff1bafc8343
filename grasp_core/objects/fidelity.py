"""How far convex parts, which physics knows, stand off the mesh, which cameras see."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from grasp_core.objects.asset import Part
from grasp_core.objects.hulls import planes
from grasp_core.objects.voxels import Voxels, voxelize

CELLS = 96
"""Of the grid that tells what is seen, along the longest side."""

SEEN = 6_000
"""Points of the visible surface, and of the parts' surface, that are measured."""

FAR = 0.03
"""Parts' points farther off the mesh than this share of its longest side are filled concavities."""


@dataclass(frozen=True)
class Fidelity:
    """How well parts stand for a mesh; lengths in the mesh's units.

    Attributes:
        error: mean distance, of the visible surface to the parts' and of the parts' to the mesh's.
        missing: mean distance of the visible surface to the parts', the part of it that the parts lack or bury.
        filled: share of the parts' surface that stands farther off the mesh than 3 % of its longest side.
    """

    error: float
    missing: float
    filled: float

    @property
    def words(self) -> dict[str, str]:
        """For an asset's `meta`, where lengths are metres: mean error in mm, and the share of filled surface."""
        return {"parts_off_mm": f"{1000 * self.error:.2f}", "parts_filled": f"{self.filled:.3f}"}


def fidelity(mesh: trimesh.Trimesh, parts: Sequence[Part], voxels: Voxels | None = None) -> Fidelity:
    """Measure parts against the surface that is visible from outside; the same on every machine.

    Args:
        mesh: what is seen, in the parts' frame.
        parts: closed convex parts.
        voxels: of the mesh, when they are at hand.
    """
    voxels = voxels or voxelize(mesh, CELLS)
    seen = voxels.points[voxels.visible] if voxels.visible.any() else voxels.points
    seen = seen[np.random.default_rng(0).permutation(len(seen))[:SEEN]]
    missing = np.abs(signed_distance(seen, parts))
    skin = _skin(parts)
    off, _ = cKDTree(voxels.points).query(skin)
    cells = np.floor((skin - voxels.origin) / voxels.cell).astype(np.int64)
    last = np.array(voxels.solid.shape) - 1
    inside = voxels.solid[tuple(np.clip(cells, 0, last).T)]
    off[inside] = 0.0  # a cut through the solid is not seen
    side = float(mesh.extents.max())
    return Fidelity(float((missing.mean() + off.mean()) / 2), float(missing.mean()), float((off > FAR * side).mean()))


def signed_distance(points: NDArray[np.float64], parts: Sequence[Part]) -> NDArray[np.float64]:
    """(N,) distance of points to the nearest face plane of the parts' union, negative inside; a lower bound."""
    nearest = np.full(len(points), np.inf)
    for part in parts:
        normals, heights = planes(part.vertices, part.faces)
        nearest = np.minimum(nearest, (points @ normals.T - heights).max(axis=1))
    return nearest


def _skin(parts: Sequence[Part]) -> NDArray[np.float64]:
    """Evenly random points (N, 3) of the surface of the parts' union."""
    areas = np.array([part.mesh.area for part in parts])
    points = []
    for i, part in enumerate(parts):
        count = max(20, int(2 * SEEN * areas[i] / areas.sum()))
        some, _ = trimesh.sample.sample_surface(part.mesh, count, seed=i)
        others = [other for other in parts if other is not part]
        some = np.asarray(some)
        points.append(some[signed_distance(some, others) >= 0] if others else some)
    found = np.concatenate(points)
    return found if len(found) else np.concatenate([part.vertices for part in parts])
