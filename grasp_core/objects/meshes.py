"""Reading and repairing mesh files: OFF, OBJ, STL, PLY, glTF and GLB become one clean triangle mesh."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import manifold3d
import numpy as np
import trimesh
from numpy.typing import NDArray

from grasp_core.errors import MeshError
from grasp_core.objects.decomposition import cleaned
from grasp_core.objects.hulls import arrays, solid
from grasp_core.objects.off import read_off

FORMATS = (".off", ".obj", ".stl", ".ply", ".gltf", ".glb")
"""Endings of mesh files that are read."""

MOST_FACES = 60_000
"""Meshes with more faces are thinned: vertices closer than a fraction of a millimetre fall together."""


def read_mesh(path: str | Path) -> trimesh.Trimesh:
    """Read a mesh file in its own units, cleaned, wound outward where it is closed, thinned where it is huge.

    Raises:
        MeshError: missing, of another format, unreadable, or without usable faces; the message names the file.
    """
    path = Path(path).expanduser()
    if not path.is_file():
        raise MeshError(f"{path}: no such file")
    if path.suffix.lower() not in FORMATS:
        raise MeshError(f"{path}: meshes are read from {', '.join(FORMATS)} (and .urdf), not '{path.suffix}'")
    if path.stat().st_size == 0:
        raise MeshError(f"{path}: is empty; copy it again")
    mesh = read_off(path) if path.suffix.lower() == ".off" else _by_trimesh(path)
    try:
        return thinned(outward(cleaned(mesh)), MOST_FACES)
    except MeshError as error:
        raise MeshError(f"{path}: {error}") from error


def _by_trimesh(path: Path) -> trimesh.Trimesh:
    options: dict[str, Any] = {"skip_materials": True} if path.suffix.lower() == ".obj" else {}
    try:
        scene = trimesh.load_scene(path, process=False, **options)
        meshes = [one for one in scene.dump() if isinstance(one, trimesh.Trimesh) and len(one.faces)]
    except Exception as error:
        reason = str(error) or type(error).__name__
        raise MeshError(f"{path}: is no readable {path.suffix[1:].upper()} file ({reason}); export it again") from error
    if not meshes:
        raise MeshError(f"{path}: holds no triangles (a point cloud, lines or an empty scene); export the surface")
    vertices = np.concatenate([np.asarray(one.vertices, float) for one in meshes])
    starts = np.cumsum([0, *[len(one.vertices) for one in meshes[:-1]]])
    faces = np.concatenate([np.asarray(one.faces) + start for one, start in zip(meshes, starts, strict=True)])
    return trimesh.Trimesh(vertices, faces, process=False)


def outward(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """The mesh with consistent winding, outward where it encloses a volume."""
    if not mesh.is_winding_consistent and len(mesh.faces) < 100_000:
        trimesh.repair.fix_winding(mesh)
    if mesh.is_watertight and mesh.is_winding_consistent:
        trimesh.repair.fix_inversion(mesh, multibody=True)
    return mesh


def thinned(mesh: trimesh.Trimesh, most_faces: int) -> trimesh.Trimesh:
    """The mesh with vertices merged on a grid, as fine as possible, until it has at most `most_faces` faces."""
    cell = float(mesh.extents.max()) / 1500
    while len(mesh.faces) > most_faces:
        keys = np.round((mesh.vertices - mesh.bounds[0]) / cell).astype(np.int64)
        _, first, index = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        faces: NDArray[np.int64] = index.reshape(-1)[mesh.faces]
        mesh = cleaned(trimesh.Trimesh(mesh.vertices[first], faces, process=False))
        cell *= 1.5
    return mesh


def united(mesh: trimesh.Trimesh) -> trimesh.Trimesh:
    """Overlapping closed bodies as one skin; the mesh as it is where a body is open."""
    bodies = [solid(one.vertices, one.faces) for one in mesh.split(only_watertight=False)]
    if len(bodies) < 2 or any(body.is_empty() or body.volume() <= 0 for body in bodies):
        return mesh
    vertices, faces = arrays(manifold3d.Manifold.batch_boolean(bodies, manifold3d.OpType.Add))
    return trimesh.Trimesh(vertices, faces, process=False)
