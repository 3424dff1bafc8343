"""Convex parts from points, and the volume and inertia of a set of parts, overlaps counted once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import manifold3d
import numpy as np
import trimesh
from numpy.typing import NDArray

from grasp_core.errors import MeshError
from grasp_core.objects.asset import Part

GROWTH = 1.04
"""Largest factor by which a hull with fewer vertices is grown to keep its volume."""


@dataclass(frozen=True)
class MassProperties:
    """Of a body with density 1 kg/m³: volume m³, centre (3,) m, inertia (3, 3) about the centre, kg·m²."""

    volume: float
    centre: NDArray[np.float64]
    inertia: NDArray[np.float64]


def solid(vertices: NDArray, faces: NDArray) -> manifold3d.Manifold:
    """A closed mesh as a manifold solid; empty where the mesh is not closed."""
    mesh = manifold3d.Mesh64(
        np.ascontiguousarray(vertices, np.float64), np.ascontiguousarray(faces, np.uint64).reshape(-1, 3)
    )
    return manifold3d.Manifold(mesh)


def arrays(body: manifold3d.Manifold) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Vertices (V, 3) float64 and faces (F, 3) int32 of a solid."""
    mesh = body.to_mesh64()
    return np.array(mesh.vert_properties[:, :3], np.float64), np.array(mesh.tri_verts, np.int32)


def convex_part(points: NDArray[np.float64], max_vertices: int = 24) -> Part:
    """The convex hull of points (N, 3) as a closed part with outward faces and at most `max_vertices` vertices.

    With too many vertices the ones that matter most are kept (greedily the one farthest outside the hull so far) and
    the hull grows about its centre by at most 4 % to keep its volume. Flat points become a plate of 1 % of their size.

    Raises:
        MeshError: fewer than three different points, or numbers that are not finite.
    """
    points = np.unique(np.asarray(points, np.float64).reshape(-1, 3), axis=0)
    if len(points) < 3 or not np.isfinite(points).all():
        raise MeshError("a convex part needs at least three different, finite points")
    points = _thick(points)
    hull = manifold3d.Manifold.hull_points(points)
    vertices, faces = arrays(hull)
    if len(vertices) > max_vertices:
        kept = _important(vertices, max_vertices)
        fewer = manifold3d.Manifold.hull_points(kept)
        centre = kept.mean(axis=0)
        grow = min((hull.volume() / max(fewer.volume(), 1e-30)) ** (1 / 3), GROWTH)
        vertices, faces = arrays(manifold3d.Manifold.hull_points(centre + (kept - centre) * grow))
    if len(faces) < 4:
        raise MeshError("the hull of a part is degenerate; its points lie on a line")
    return Part(vertices, faces)


def _thick(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points with a sheet's thickness added where all of them lie (nearly) in a plane."""
    centred = points - points.mean(axis=0)
    _, _, axes = np.linalg.svd(centred, full_matrices=len(centred) < 3)
    spread = np.ptp(centred @ axes.T, axis=0)
    if spread[2] > 2e-3 * spread[0]:
        return points
    offset = axes[2] * (5e-3 * spread[0])
    return np.concatenate([points - offset, points + offset])


def _important(vertices: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """`count` of a hull's vertices: the extremes of eight directions, then always the one farthest outside."""
    directions = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1], [1, -1, 1], [-1, 1, 1], [-1, -1, 1]], float)
    projections = vertices @ directions.T
    chosen = list(dict.fromkeys([*projections.argmax(axis=0)[:3], *projections.argmin(axis=0)[:3]]))
    for extreme in (*projections.argmax(axis=0)[3:], *projections.argmin(axis=0)[3:]):
        if extreme not in chosen and len(chosen) < min(8, count):
            chosen.append(extreme)
    while len(chosen) < count:
        corners, faces = arrays(manifold3d.Manifold.hull_points(vertices[chosen]))
        if len(faces) == 0:
            rest = [i for i in range(len(vertices)) if i not in chosen]
            chosen.append(rest[0])
            continue
        a, b, c = (corners[faces[:, k]] for k in range(3))
        normals = np.cross(b - a, c - a)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
        outside = (vertices @ normals.T - (normals * a).sum(axis=1)).max(axis=1)
        outside[chosen] = -np.inf
        chosen.append(int(outside.argmax()))
    return vertices[chosen]


def planes(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Outward unit normals (F, 3) of a convex body's sides and their distances (F,) from the origin.

    Slivers along flat sides, whose computed normals point anywhere, are left out: a side has no vertex in front.
    """
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    normals = normals[lengths > 0] / lengths[lengths > 0, None]
    heights = (normals * a[lengths > 0]).sum(axis=1)
    true = (vertices @ normals.T - heights).max(axis=0) <= 1e-6 * float(np.ptp(vertices, axis=0).max())
    return normals[true], heights[true]


def mass_properties(parts: Sequence[Part], densities: Sequence[float] | None = None) -> MassProperties:
    """Volume, centre of mass and inertia of parts; where parts overlap, the space counts once.

    Args:
        parts: closed convex parts.
        densities: relative density of each part (a hammer's head against its handle); scaled so that the mass of the
            whole is that of density 1. An overlap belongs to the earlier part.

    Raises:
        MeshError: parts without volume.
    """
    solids = [solid(part.vertices, part.faces) for part in parts]
    if densities is None or len(set(densities)) == 1:
        pieces = [(1.0, manifold3d.Manifold.batch_boolean(solids, manifold3d.OpType.Add))]
    else:
        pieces, before = [], manifold3d.Manifold()
        for weight, body in zip(densities, solids, strict=True):
            pieces.append((weight, body - before))
            before = before + body
    measured = [(weight, _measure(body)) for weight, body in pieces if not body.is_empty()]
    volume = sum(one.volume for _, one in measured)
    if volume <= 0:
        raise MeshError("the parts have no volume; the mesh is a sheet or turned inside out")
    mass = sum(weight * one.volume for weight, one in measured)
    centre = sum((weight * one.volume / mass * one.centre for weight, one in measured), np.zeros(3))
    inertia = np.zeros((3, 3))
    for weight, one in measured:
        arm = one.centre - centre
        inertia += weight * (one.inertia + one.volume * (arm @ arm * np.eye(3) - np.outer(arm, arm)))
    return MassProperties(float(volume), centre, inertia * (volume / mass))


def _measure(body: manifold3d.Manifold) -> MassProperties:
    vertices, faces = arrays(body)
    centre = vertices.mean(axis=0)
    got = trimesh.triangles.mass_properties((vertices - centre)[faces], density=1.0, skip_inertia=False)
    return MassProperties(float(got["volume"]), np.asarray(got["center_mass"]) + centre, np.asarray(got["inertia"]))
