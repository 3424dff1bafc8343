"""How alike two objects are, whatever their pose: a descriptor of the mesh and a distance, for honest splits."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from grasp_core.objects.asset import ObjectAsset

NEAR = 0.10
"""Objects closer than this are near-duplicates: about a tenth in size, or the same shape with small changes."""

_BINS = 32
_POINTS = 1024


def descriptor(asset: ObjectAsset) -> NDArray[np.float64]:
    """(42,) numbers that neither rotation nor the mesh's triangles change.

    Logarithms of the sides of the principal box (3), of the cube roots of the parts' volume and of the hull's volume
    (2), of the root of the hull's area (1), of the radii of gyration (3), the share of the hull that is filled (1),
    and 32 quantiles of the distance between two random points of the surface (D2, Osada et al. 2002) over its mean.
    """
    points, _ = trimesh.sample.sample_surface(asset.mesh, 2 * _POINTS, seed=0)
    points = np.asarray(points)
    _, axes = np.linalg.eigh(np.cov(points.T))
    sides = np.sort(np.ptp(points @ axes, axis=0))[::-1]
    gyration = np.sqrt(np.sort(np.linalg.eigvalsh(asset.unit_inertia)) / asset.volume)
    hull = asset.hull
    sizes = np.log([*sides, asset.volume ** (1 / 3), hull.volume ** (1 / 3), hull.area**0.5, *gyration])
    lengths = np.linalg.norm(points[:, None, :] - points[None, ::7, :], axis=2).ravel()
    quantiles = np.quantile(lengths, (np.arange(_BINS) + 0.5) / _BINS) / lengths.mean()
    return np.concatenate([sizes, [asset.volume / hull.volume], quantiles])


def distances(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, M) distances between descriptors (N, 42) and (M, 42).

    The largest of three: the mean difference of the log sizes, of the filled shares, and of the D2 quantiles.
    """
    a, b = np.atleast_2d(first), np.atleast_2d(second)
    sizes = cdist(a[:, :9], b[:, :9], "cityblock") / 9
    filled = cdist(a[:, 9:10], b[:, 9:10], "cityblock")
    spread = cdist(a[:, 10:], b[:, 10:], "cityblock") / _BINS
    return np.maximum(np.maximum(sizes, filled), 2.0 * spread)


def distance(first: ObjectAsset, second: ObjectAsset) -> float:
    """Distance of two objects: 0 for the same in any pose, about 0.1 for a tenth in size."""
    return float(distances(descriptor(first), descriptor(second))[0, 0])


def near_duplicates(
    first: Sequence[ObjectAsset], second: Sequence[ObjectAsset], below: float = NEAR
) -> list[tuple[str, str, float]]:
    """Pairs (name of first, name of second, distance) closer than `below`, nearest first."""
    if not first or not second:
        return []
    table = distances(np.array([descriptor(a) for a in first]), np.array([descriptor(b) for b in second]))
    pairs = [(first[i].name, second[j].name, float(table[i, j])) for i, j in np.argwhere(table < below)]
    return sorted(pairs, key=lambda pair: pair[2])
