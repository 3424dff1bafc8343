"""Convex decomposition, made once per mesh, and the making of assets.

The result, or the fallback that was taken, is kept in the user's cache folder under the content of the mesh.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import uuid
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import manifold3d
import numpy as np
import platformdirs
import trimesh
from numpy.typing import NDArray

from grasp_core.errors import MeshError
from grasp_core.objects.asset import ObjectAsset, Part
from grasp_core.objects.coacd_process import SETTINGS, run_coacd
from grasp_core.objects.hulls import arrays, convex_part, mass_properties, solid

VERSION = 3
"""Raise this when the parts of a mesh would come out differently: it is part of the cache's key."""

NEARLY_CONVEX = 0.985
"""A closed body that fills this share of its hull is one part."""

MOST_MERGED = 120
"""Up to so many convex bodies are merged into fewer parts, if …"""

MERGED_VOLUME = 1.3
"""… these fill no more than so many times the bodies' own volume; CoACD is asked otherwise."""


@dataclass(frozen=True)
class Decomposition:
    """Convex parts in the frame of the mesh, and how they came about ("exact…", "merged…", "coacd…" or "hull…")."""

    parts: tuple[Part, ...]
    method: str


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
    mesh: trimesh.Trimesh, *, max_parts: int = 8, max_vertices: int = 24, timeout_s: float = 60.0
) -> Decomposition:
    """Split a mesh into at most `max_parts` closed convex parts of at most `max_vertices` vertices.

    Meshes whose few bodies are convex already keep them; many convex bodies are merged. Everything else goes to CoACD;
    when that fails or takes longer than `timeout_s`, it tries again coarsely; then each body becomes its hull (few
    bodies) or the whole mesh one hull, and `method` says so.

    Args:
        mesh: any triangle mesh; it may be open, wound badly or of many bodies.
        max_parts: at most so many parts.
        max_vertices: at most so many vertices each.
        timeout_s: seconds of processor time after which a run of CoACD is killed.

    Raises:
        MeshError: no faces, or coordinates that are not finite.
    """
    mesh = cleaned(mesh)
    low, size = mesh.bounds[0], float(mesh.extents.max())
    unit = np.round((mesh.vertices - low) / size, 6)
    key = hashlib.sha256(
        f"{VERSION} {importlib.metadata.version('coacd')} {max_parts} {max_vertices} {timeout_s:g} {SETTINGS}".encode()
        + unit.tobytes()
        + np.asarray(mesh.faces, np.int32).tobytes()
    ).hexdigest()[:32]
    file = Path(platformdirs.user_cache_dir("grasp-workbench")) / "parts" / f"{key}.npz"
    found = _read(file)
    if found is None:
        found = _decompose(trimesh.Trimesh(unit, mesh.faces, process=False), max_parts, max_vertices, timeout_s)
        _write(file, found)
    parts = tuple(replace(part, vertices=part.vertices * size + low) for part in found.parts)
    return Decomposition(parts, found.method)


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
    if len(bodies) <= max_parts and all(body.convex for body in bodies):
        parts = [convex_part(body.mesh.vertices, max_vertices) for body in bodies]
        return Decomposition(tuple(parts), "exact: " + ("convex" if len(parts) == 1 else f"{len(parts)} convex bodies"))
    if len(bodies) <= MOST_MERGED and all(body.convex for body in bodies):
        parts = merged([body.mesh.vertices for body in bodies], max_parts, max_vertices)
        union = manifold3d.Manifold.batch_boolean([body.solid for body in bodies], manifold3d.OpType.Add)
        if mass_properties(parts).volume <= MERGED_VOLUME * union.volume():
            return Decomposition(tuple(parts), f"merged: {len(bodies)} convex bodies into {len(parts)} parts")
    if all(body.closed for body in bodies):
        union = manifold3d.Manifold.batch_boolean([body.solid for body in bodies], manifold3d.OpType.Add)
        vertices, faces = arrays(union)
        preprocess = "off"
    else:
        vertices, faces, preprocess = np.asarray(mesh.vertices), np.asarray(mesh.faces, np.int32), "on"
    for name in SETTINGS:
        hulls, why = run_coacd(vertices, faces, preprocess, name, max_parts, timeout_s)
        if hulls:
            parts = _solid_parts([convex_part(points, max_vertices) for points in hulls])
            return Decomposition(tuple(parts), f"{name}: {len(parts)} parts")
        preprocess = "on"
    if 1 < len(bodies) <= max_parts:
        parts = [convex_part(body.mesh.vertices, max_vertices) for body in bodies]
        return Decomposition(tuple(parts), f"hull: of each body, {why}")
    return Decomposition((convex_part(mesh.vertices, max_vertices),), f"hull: of the whole, {why}")


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


def _read(file: Path) -> Decomposition | None:
    try:
        with np.load(file) as found:
            count = int(found["count"])
            parts = tuple(Part(found[f"v{i}"], found[f"f{i}"]) for i in range(count))
            return Decomposition(parts, str(found["method"]))
    except (OSError, KeyError, ValueError, EOFError):
        return None


def _write(file: Path, found: Decomposition) -> None:
    """Keep a result; a cache that cannot be written is no error."""
    content: dict[str, NDArray] = {"count": np.array(len(found.parts)), "method": np.array(found.method)}
    for i, part in enumerate(found.parts):
        content |= {f"v{i}": part.vertices, f"f{i}": part.faces}
    partial = file.with_name(f".{file.stem}-{uuid.uuid4().hex}.npz")
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        np.savez_compressed(partial, **content)  # type: ignore[arg-type]
        partial.replace(file)
    except OSError:
        partial.unlink(missing_ok=True)


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
    max_parts: int = 8,
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
        meta: more for people.
        max_parts: for `decompose`.
        max_vertices: for `decompose`, and per given part.
        timeout_s: for `decompose`.

    Raises:
        MeshError: a mesh without faces, with numbers that are not finite, or parts without volume.
    """
    if parts is None:
        result = decompose(mesh, max_parts=max_parts, max_vertices=max_vertices, timeout_s=timeout_s)
        solids, method = result.parts, result.method
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
