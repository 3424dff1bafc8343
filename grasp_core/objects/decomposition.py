"""Convex decomposition, made once per mesh, and the making of assets.

Several ways are tried and the one whose parts stand least off the visible mesh is kept, in the user's cache folder,
under the content of the mesh, with its error.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import manifold3d
import numpy as np
import trimesh
from numpy.typing import NDArray

from grasp_core.errors import MeshError
from grasp_core.objects import parts_cache
from grasp_core.objects.asset import ObjectAsset, Part
from grasp_core.objects.coacd_process import CONCAVITY, SETTINGS, run_coacd
from grasp_core.objects.fidelity import Fidelity, fidelity
from grasp_core.objects.hulls import arrays, convex_part, mass_properties, solid
from grasp_core.objects.parts_cache import Decomposition
from grasp_core.objects.pieces import cut

VERSION = 4
"""Raise this when the parts of a mesh would come out differently: it is part of the cache's key."""

NEARLY_CONVEX = 0.985
"""A closed body that fills this share of its hull is one part."""

MOST_MERGED = 120
"""Up to so many convex bodies may be merged into fewer parts."""

MOST_PARTS = 32
"""Physics takes hardly longer for more parts; each stands closer to the mesh."""

GOOD = 0.012
"""Parts that stand off by less than this share of the longest side (2 mm for 17 cm) are kept without CoACD's try."""


@dataclass(frozen=True)
class _Body:
    mesh: trimesh.Trimesh
    solid: manifold3d.Manifold = field(repr=False)

    @property
    def closed(self) -> bool:
        return not self.solid.is_empty() and self.solid.volume() > 0

    @property
    def convex(self) -> bool:
        return self.closed and self.solid.volume() >= NEARLY_CONVEX * self.solid.hull().volume()


def decompose(
    mesh: trimesh.Trimesh, *, max_parts: int = MOST_PARTS, max_vertices: int = 24, timeout_s: float = 60.0
) -> Decomposition:
    """Split a mesh into at most `max_parts` closed convex parts of at most `max_vertices` vertices.

    Meshes whose few bodies are convex already keep them. Everything else is cut by what is visible of it (see
    `pieces`), and many convex bodies are also merged; where the best of these stands off the mesh by more than `GOOD`,
    CoACD tries too. The least error wins, and `method` says which way it was and why CoACD failed where it did.

    Args:
        mesh: any triangle mesh; it may be open, wound badly or of many bodies.
        max_parts: at most so many parts.
        max_vertices: at most so many vertices each.
        timeout_s: seconds of processor time that CoACD's runs may take together; they are killed after it.

    Raises:
        MeshError: no faces, or coordinates that are not finite.
    """
    mesh = cleaned(mesh)
    low, size = mesh.bounds[0], float(mesh.extents.max())
    unit = np.round((mesh.vertices - low) / size, 6)
    coacd = f"{importlib.metadata.version('coacd')} {SETTINGS} {CONCAVITY}"
    key = hashlib.sha256(
        f"{VERSION} {coacd} {max_parts} {max_vertices} {timeout_s:g}".encode()
        + unit.tobytes()
        + np.asarray(mesh.faces, np.int32).tobytes()
    ).hexdigest()[:32]
    found = parts_cache.read(key)
    if found is None:
        found = _decompose(trimesh.Trimesh(unit, mesh.faces, process=False), max_parts, max_vertices, timeout_s)
        parts_cache.write(key, found)
    parts = tuple(replace(part, vertices=part.vertices * size + low) for part in found.parts)
    off = found.fidelity
    return Decomposition(parts, found.method, Fidelity(off.error * size, off.missing * size, off.filled))


def cleaned(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """A copy with equal vertices merged and degenerate, repeated and unused elements removed.

    Raises:
        MeshError: nothing is left, or the coordinates are not finite.
    """
    vertices, faces = np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int64)
    if len(faces) == 0:
        raise MeshError("the mesh has no faces (a point cloud or an empty file); export it with its triangles")
    if not np.isfinite(vertices[np.unique(faces)]).all():
        raise MeshError("the mesh has coordinates that are not finite numbers; export it again")
    clean = trimesh.Trimesh(vertices, faces, process=False)
    clean.merge_vertices(merge_tex=True, merge_norm=True)
    clean.update_faces(clean.nondegenerate_faces())
    clean.update_faces(clean.unique_faces())
    clean.remove_unreferenced_vertices()
    if len(clean.faces) == 0 or float(clean.extents.max()) <= 0:
        raise MeshError("the mesh has only degenerate faces; export it again")
    return clean


def _decompose(mesh: trimesh.Trimesh, max_parts: int, max_vertices: int, timeout_s: float) -> Decomposition:
    bodies = _bodies(mesh)
    tried: list[Decomposition] = []

    def offer(parts: Sequence[Part], method: str) -> None:
        tried.append(Decomposition(tuple(parts), method, fidelity(mesh, parts)))

    if all(body.convex for body in bodies) and len(bodies) <= MOST_MERGED:
        if len(bodies) <= max_parts:
            parts = [convex_part(body.mesh.vertices, max_vertices) for body in bodies]
            offer(parts, "exact: " + ("convex" if len(parts) == 1 else f"{len(parts)} convex bodies"))
            return tried[0]
        parts = merged([body.mesh.vertices for body in bodies], max_parts, max_vertices)
        offer(parts, f"merged: {len(bodies)} convex bodies into {len(parts)} parts")
    parts = cut(mesh, max_parts, max_vertices)
    if parts:
        offer(parts, f"cut: {len(parts)} parts")
    why = ""
    if not tried or min(one.fidelity.error for one in tried) > GOOD:
        parts, name, why = _by_coacd(mesh, bodies, max_parts, max_vertices, timeout_s)
        if parts:
            offer(parts, f"{name}: {len(parts)} parts")
    if not tried:
        offer([convex_part(mesh.vertices, max_vertices)], "hull: of the whole")
    best = min(tried, key=lambda one: one.fidelity.error)
    return replace(best, method=f"{best.method}; {why}") if why else best


def _by_coacd(
    mesh: trimesh.Trimesh, bodies: Sequence[_Body], max_parts: int, max_vertices: int, timeout_s: float
) -> tuple[list[Part], str, str]:
    """CoACD's parts and settings, or nothing and why it failed."""
    if all(body.closed for body in bodies):
        union = manifold3d.Manifold.batch_boolean([body.solid for body in bodies], manifold3d.OpType.Add)
        vertices, faces = arrays(union)
        preprocess = "off"
    else:
        vertices, faces, preprocess = np.asarray(mesh.vertices), np.asarray(mesh.faces, np.int32), "on"
    why = ""
    for name in SETTINGS:
        hulls, why = run_coacd(vertices, faces, preprocess, name, max_parts, timeout_s / len(SETTINGS))
        if hulls:
            return _solid_parts([convex_part(points, max_vertices) for points in hulls]), name, ""
        preprocess = "on"
    return [], "", why


def merged(pieces: Sequence[NDArray[np.float64]], max_parts: int, max_vertices: int = 24) -> list[Part]:
    """Convex pieces (N, 3) grown together, always the two whose hull adds the least space, until few are left."""
    points = list(pieces)
    volumes = [manifold3d.Manifold.hull_points(one).volume() for one in points]

    def cost(i: int, j: int) -> float:
        both = manifold3d.Manifold.hull_points(np.concatenate([points[i], points[j]])).volume()
        return both - volumes[i] - volumes[j]

    alive = list(range(len(points)))
    costs = {(i, j): cost(i, j) for i in alive for j in alive if j < i}
    while len(alive) > max_parts:
        i, j = min(costs, key=lambda pair: (costs[pair], pair))
        points.append(arrays(manifold3d.Manifold.hull_points(np.concatenate([points[i], points[j]])))[0])
        volumes.append(manifold3d.Manifold.hull_points(points[-1]).volume())
        alive = [k for k in alive if k not in (i, j)]
        costs = {pair: value for pair, value in costs.items() if not {i, j} & set(pair)}
        new = len(points) - 1
        costs |= {(new, k): cost(new, k) for k in alive}
        alive.append(new)
    return [convex_part(points[k], max_vertices) for k in alive]


def _bodies(mesh: trimesh.Trimesh) -> list[_Body]:
    """Connected bodies, each wound outward where it is closed."""
    pieces = mesh.split(only_watertight=False)
    bodies = []
    for piece in pieces if len(pieces) else [mesh]:
        body = solid(piece.vertices, piece.faces)
        if body.is_empty() and piece.is_watertight:
            trimesh.repair.fix_normals(piece)
            body = solid(piece.vertices, piece.faces)
        if not body.is_empty() and body.volume() < 0:
            body = solid(piece.vertices, np.asarray(piece.faces)[:, ::-1])
        bodies.append(_Body(piece, body))
    return bodies


def _solid_parts(parts: list[Part]) -> list[Part]:
    """The parts without slivers (under 1e-5 of the largest)."""
    volumes = np.array([abs(part.mesh.volume) for part in parts])
    return [part for part, volume in zip(parts, volumes, strict=True) if volume > 1e-5 * volumes.max()]


def build_asset(
    name: str,
    category: str,
    mesh: trimesh.Trimesh,
    *,
    parts: Sequence[NDArray[np.float64] | Part] | None = None,
    densities: Sequence[float] | None = None,
    mass: float | None = None,
    decomposition: str | None = None,
    source: str = "",
    meta: dict[str, str] | None = None,
    max_parts: int = MOST_PARTS,
    max_vertices: int = 24,
    timeout_s: float = 60.0,
) -> ObjectAsset:
    """An asset from a mesh in metres, moved so that its origin is the centre of mass of its parts.

    Args:
        name: unique name.
        category: family or class.
        mesh: what is seen; any axes.
        parts: convex parts in the mesh's frame, as parts or points (N, 3) whose hull is meant; None decomposes.
        densities: relative density of each given part; see `mass_properties`.
        mass: kg where the source states it.
        decomposition: how given parts came about; "exact" unless told otherwise.
        source: for people.
        meta: more for people; how far parts that had to be made stand off the mesh is added.
        max_parts: for `decompose`.
        max_vertices: for `decompose`, and per given part.
        timeout_s: for `decompose`.

    Raises:
        MeshError: a mesh without faces, with numbers that are not finite, or parts without volume.
    """
    if parts is None:
        result = decompose(mesh, max_parts=max_parts, max_vertices=max_vertices, timeout_s=timeout_s)
        solids, method = result.parts, result.method
        meta = {**(meta or {}), **result.fidelity.words}
    else:
        solids = tuple(one if isinstance(one, Part) else convex_part(one, max_vertices) for one in parts)
        method = decomposition or f"exact: {len(solids)} parts"
    properties = mass_properties(solids, densities)
    return ObjectAsset(
        name=name,
        category=category,
        vertices=np.asarray(mesh.vertices, np.float64) - properties.centre,
        faces=np.asarray(mesh.faces, np.int32),
        parts=tuple(Part(part.vertices - properties.centre, part.faces) for part in solids),
        volume=properties.volume,
        unit_inertia=properties.inertia,
        mass=mass,
        decomposition=method,
        source=source,
        meta=dict(meta or {}),
    )
