"""Objects by name, file or folder, each with its convex parts: the one door through which objects come in."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable
from pathlib import Path
from typing import Literal

import numpy as np
import trimesh

from grasp_core.errors import MeshError
from grasp_core.objects.asset import ObjectAsset
from grasp_core.objects.decomposition import build_asset
from grasp_core.objects.fidelity import fidelity
from grasp_core.objects.meshes import FORMATS, read_mesh
from grasp_core.objects.parametric import make
from grasp_core.objects.urdf import read_urdf

Scale = Literal["keep", "paper"] | float
PAPER_SIDES = (0.10, 0.20)
"""Longest side of an object in the paper, metres."""
SMALLEST, LARGEST = 0.005, 2.0
"""Longest sides that can be meant, metres; anything else is a file in other units."""


def catalogue(name: str) -> ObjectAsset:
    """The object with a name of the catalogue: a family and a seed, e.g. "mug_003", or one of an installed set.

    Raises:
        MeshError: not such a name, or no such family (the message lists them).
    """
    from grasp_core.objects.sets import set_object, set_of  # which builds on this module

    if set_of(name) is not None:
        return set_object(name)
    found = re.fullmatch(r"([a-z][a-z0-9_]*?)_(\d{3,6})", name)
    if found is None:
        raise MeshError(f"'{name}' is no name of the catalogue; names are a family and a seed, such as mug_003")
    return make(found.group(1), int(found.group(2)))


def load_object(
    path: str | Path,
    *,
    scale: Scale = "keep",
    seed: int = 0,
    name: str | None = None,
    category: str | None = None,
    timeout_s: float = 60.0,
) -> ObjectAsset:
    """Read a mesh (OFF, OBJ, STL, PLY, glTF, GLB) or a URDF as an object with convex parts.

    Args:
        path: the file.
        scale: "keep" takes its numbers as metres, "paper" resizes its longest side to a length drawn from 10-20 cm, a
            number multiplies it.
        seed: of that draw, together with the file's content.
        name: the asset's name; the file's own without its ending by default.
        category: its class; the name without a number at its end by default.
        timeout_s: for the decomposition.

    Returns:
        The asset. `meta["parts_off_mm"]` tells how far the parts, which are simulated, stand off the visible mesh on
        average, `meta["parts_filled"]` which share of their surface lies far off it (filled concavities), and
        `meta["filled"]` the parts' volume over the mesh's where the mesh is closed. Large ones (lattices, cages) are
        poor likenesses and better left out of training.

    Raises:
        MeshError: unreadable, unusable or of an impossible size; the message names the file and the way out.
    """
    path = Path(path).expanduser()
    name = name or path.stem
    category = category or re.sub(r"[_\-]?\d+$", "", name.rpartition("/")[2]) or name
    meta = {"file": path.name}
    if path.suffix.lower() == ".urdf":
        found = read_urdf(path, timeout_s=timeout_s)
        factor = _factor(path, found.mesh, scale, seed)
        if found.notes:
            meta["notes"] = found.notes
        mesh, parts, mass, method = found.mesh, found.parts, found.mass, found.method
    else:
        mesh, parts, mass, method = read_mesh(path), None, None, None
        factor = _factor(path, mesh, scale, seed)
    meta["scale"] = f"{factor:.6g}"
    mesh = trimesh.Trimesh(np.asarray(mesh.vertices) * factor, mesh.faces, process=False)
    try:
        asset = build_asset(
            name,
            category,
            mesh,
            parts=None if parts is None else [part.vertices * factor for part in parts],
            mass=mass,
            decomposition=method,
            source=str(path.name),
            meta=meta,
            timeout_s=timeout_s,
        )
    except MeshError as error:
        raise MeshError(f"{path}: {error}") from error
    if parts is not None:
        asset.meta.update(fidelity(asset.mesh, asset.parts).words)
    if mesh.is_watertight and mesh.volume > 0:
        asset.meta["filled"] = f"{asset.volume / mesh.volume:.3f}"
    return asset


def _factor(path: Path, mesh: trimesh.Trimesh, scale: Scale, seed: int) -> float:
    side = float(mesh.extents.max())
    if scale == "paper":
        content = hashlib.sha256(np.ascontiguousarray(mesh.vertices, np.float64).tobytes()).digest()
        rng = np.random.default_rng(np.random.SeedSequence([seed, int.from_bytes(content[:8], "little")]))
        return float(rng.uniform(*PAPER_SIDES)) / side
    if isinstance(scale, str) and scale != "keep":
        raise MeshError(f"scale must be keep, paper or a number, not '{scale}'")
    factor = 1.0 if scale == "keep" else float(scale)
    if not np.isfinite(factor) or factor <= 0:
        raise MeshError(f"scale must be above 0, not {scale}")
    if not SMALLEST <= side * factor <= LARGEST:
        raise MeshError(
            f"{path}: its longest side would be {side * factor:.4g} m; if the file is not in metres give a factor "
            "(0.001 for millimetres), or scale 'paper' for 10-20 cm"
        )
    return factor


def load_folder(
    path: str | Path,
    scale: Scale = "keep",
    seed: int = 0,
    *,
    limit: int | None = None,
    timeout_s: float = 60.0,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[list[ObjectAsset], dict[Path, str]]:
    """Read every mesh and URDF below a folder; files that cannot be used are left out with a reason.

    Mesh files that a URDF there names are pieces of it and no objects of their own. Names are the files' own; where
    two are equal the folder's name comes before them.

    Args:
        path: the folder.
        scale: as in `load_object`.
        seed: as in `load_object`.
        limit: at most so many files, in the order of their names.
        timeout_s: for each decomposition.
        progress: called with files done and files in all.

    Returns:
        The assets, sorted by path, and file → why it was refused.

    Raises:
        MeshError: no such folder, or no mesh in it.
    """
    path = Path(path).expanduser()
    files = find_files(path)[:limit]
    stems = [file.stem for file in files]
    assets, refused = [], {}
    for done, file in enumerate(files):
        name = file.stem
        if stems.count(name) > 1:
            name = "_".join(file.relative_to(path).with_suffix("").parts)
        try:
            assets.append(load_object(file, scale=scale, seed=seed, name=name, timeout_s=timeout_s))
        except MeshError as error:
            refused[file] = str(error)
        except Exception as error:  # a file that breaks a reader must not stop the others
            refused[file] = f"{file}: {type(error).__name__}: {error}"
        if progress:
            progress(done + 1, len(files))
    return assets, refused


def find_files(path: Path) -> list[Path]:
    """Files below a folder that are objects, sorted.

    Raises:
        MeshError: no such folder, or no mesh in it.
    """
    if not path.is_dir():
        raise MeshError(f"{path}: no such folder")
    files = sorted(file for file in path.rglob("*") if file.is_file() and not file.name.startswith("."))
    urdfs = [file for file in files if file.suffix.lower() == ".urdf"]
    pieces = {piece.resolve() for file in urdfs for piece in _named_meshes(file)}
    meshes = [file for file in files if file.suffix.lower() in FORMATS and file.resolve() not in pieces]
    if not urdfs and not meshes:
        raise MeshError(f"{path}: holds no object; objects are files that end in {', '.join(FORMATS)} or .urdf")
    return sorted(urdfs + meshes)


def _named_meshes(urdf: Path) -> list[Path]:
    text = urdf.read_text(errors="replace")
    names = re.findall(r"""filename\s*=\s*["']([^"']+)["']""", text)
    return [urdf.parent / re.sub(r"^(package|file|model)://", "", name) for name in names]
