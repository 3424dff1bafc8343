"""URDF objects: import with collision elements, scale and mass; export with parts, mass and inertia."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
import trimesh
from numpy.typing import NDArray

from grasp_core.errors import MeshError
from grasp_core.objects.asset import ObjectAsset, Part
from grasp_core.objects.decomposition import decompose
from grasp_core.objects.hulls import convex_part
from grasp_core.objects.meshes import read_mesh, united

DENSITY = 500.0
"""kg/m³ of exported objects whose mass nobody stated."""

MOST_CONVEX = 32
"""Collision pieces that are kept as they are; more of them are united and decomposed."""


@dataclass
class UrdfObject:
    """What a URDF says about one rigid object, in the frame of its root link, metres.

    Attributes:
        mesh: what is seen, overlapping pieces united.
        parts: convex parts of its collision elements.
        mass: kg, or None where no link states one.
        method: how the parts came about.
        files: mesh files that it names.
        notes: what was simplified.
    """

    mesh: trimesh.Trimesh
    parts: tuple[Part, ...]
    mass: float | None
    method: str
    files: list[Path] = field(default_factory=list)
    notes: str = ""


def read_urdf(path: str | Path, *, max_parts: int = MOST_CONVEX, timeout_s: float = 60.0) -> UrdfObject:
    """Read a URDF as one rigid object: all links in one piece, movable joints frozen at zero.

    Args:
        path: the `.urdf` file; mesh names are relative to it, or `package://`, looked for in the folders above.
        max_parts: for collision meshes that must be decomposed.
        timeout_s: for each decomposition.

    Raises:
        MeshError: unreadable, without links or shapes, or with a mesh that is missing or bad; names file and element.
    """
    path = Path(path).expanduser()
    root = _parse(path)
    poses, frozen = _link_poses(path, root)
    shapes: dict[str, list[trimesh.Trimesh]] = {"visual": [], "collision": []}
    files: list[Path] = []
    mass: float | None = None
    for link in root.findall("link"):
        world = poses[link.get("name", "")]
        stated = link.find("inertial/mass")
        if stated is not None:
            value = _numbers(path, stated.get("value", ""), 1, "mass value")[0]
            if value < 0:
                raise MeshError(f"{path}: the mass of link '{link.get('name')}' is {value}; it must be above 0")
            mass = (mass or 0.0) + value if value > 0 else mass
        for kind, found in shapes.items():
            for element in link.findall(kind):
                mesh = _shape(path, element, files)
                found.append(mesh.apply_transform(world @ _origin(path, element)))
    if not shapes["visual"] and not shapes["collision"]:
        raise MeshError(f"{path}: has neither visual nor collision shapes; add a <collision> with a <geometry>")
    seen = _together(shapes["visual"] or shapes["collision"])
    parts, method = _parts(shapes["collision"] or shapes["visual"], max_parts, timeout_s)
    notes = f"movable joints frozen at zero: {', '.join(frozen)}" if frozen else ""
    return UrdfObject(united(seen), parts, mass, method, files, notes)


def _together(meshes: list[trimesh.Trimesh]) -> trimesh.Trimesh:
    starts = np.cumsum([0, *[len(one.vertices) for one in meshes[:-1]]])
    faces = [np.asarray(one.faces) + start for one, start in zip(meshes, starts, strict=True)]
    return trimesh.Trimesh(np.concatenate([one.vertices for one in meshes]), np.concatenate(faces), process=False)


def _parse(path: Path) -> ElementTree.Element:
    try:
        root = ElementTree.parse(path).getroot()
    except OSError as error:
        raise MeshError(f"{path}: cannot be read ({error.strerror})") from error
    except ElementTree.ParseError as error:
        raise MeshError(f"{path}: is no XML ({error}); mend that line") from error
    if root.tag != "robot" or not root.findall("link"):
        raise MeshError(f"{path}: is no URDF object: it needs a <robot> with at least one <link>")
    return root


def _link_poses(path: Path, root: ElementTree.Element) -> tuple[dict[str, NDArray[np.float64]], list[str]]:
    """Link name → root_from_link (4×4) with all joints at zero; and the names of movable joints."""
    names = [link.get("name", "") for link in root.findall("link")]
    parents: dict[str, tuple[str, NDArray[np.float64]]] = {}
    frozen = []
    for joint in root.findall("joint"):
        parent, child = joint.find("parent"), joint.find("child")
        if parent is None or child is None:
            raise MeshError(f"{path}: joint '{joint.get('name')}' lacks its parent or child link")
        parents[child.get("link", "")] = (parent.get("link", ""), _origin(path, joint))
        if joint.get("type") != "fixed":
            frozen.append(joint.get("name", "?"))

    def pose(name: str, depth: int = 0) -> NDArray[np.float64]:
        if name not in names or depth > len(names):
            raise MeshError(f"{path}: the joints lead to link '{name}', which is missing or in a loop")
        if name not in parents:
            return np.eye(4)
        above, transform = parents[name]
        return pose(above, depth + 1) @ transform

    return {name: pose(name) for name in names}, frozen


def _numbers(path: Path, text: str, count: int, what: str) -> list[float]:
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        values = []
    if len(values) != count or not all(map(math.isfinite, values)):
        raise MeshError(f"{path}: {what} must be {count} number(s), not '{text}'")
    return values


def _origin(path: Path, element: ElementTree.Element) -> NDArray[np.float64]:
    origin = element.find("origin")
    if origin is None:
        return np.eye(4)
    roll, pitch, yaw = _numbers(path, origin.get("rpy", "0 0 0"), 3, "origin rpy")
    transform = trimesh.transformations.euler_matrix(roll, pitch, yaw, "sxyz")
    transform[:3, 3] = _numbers(path, origin.get("xyz", "0 0 0"), 3, "origin xyz")
    return np.asarray(transform)


def _shape(path: Path, element: ElementTree.Element, files: list[Path]) -> trimesh.Trimesh:
    for kind in ("mesh", "box", "cylinder", "sphere"):
        shape = element.find(f"geometry/{kind}")
        if shape is None:
            continue
        if kind == "mesh":
            file = _mesh_file(path, shape.get("filename", ""))
            files.append(file)
            scale = _numbers(path, shape.get("scale", "1 1 1"), 3, "mesh scale")
            try:
                mesh = read_mesh(file)
            except MeshError as error:
                raise MeshError(f"{path}: {error}") from error
            mesh.apply_transform(np.diag([*scale, 1.0]))
            return mesh
        if kind == "box":
            return trimesh.creation.box(_numbers(path, shape.get("size", ""), 3, "box size"))
        radius = _numbers(path, shape.get("radius", ""), 1, f"{kind} radius")[0]
        if kind == "sphere":
            return trimesh.creation.icosphere(subdivisions=2, radius=radius)
        length = _numbers(path, shape.get("length", ""), 1, "cylinder length")[0]
        return trimesh.creation.cylinder(radius=radius, height=length, sections=24)
    raise MeshError(f"{path}: a <{element.tag}> has no mesh, box, cylinder or sphere in its <geometry>")


def _mesh_file(path: Path, name: str) -> Path:
    plain = name.removeprefix("file://").removeprefix("model://")
    if name.startswith("package://"):
        plain = name.removeprefix("package://")
        inside = plain.split("/", 1)[-1]
        candidates = [above / tail for above in path.resolve().parents for tail in (plain, inside)]
    else:
        candidates = [path.parent / plain]
    for candidate in candidates:
        if name and candidate.is_file():
            return candidate
    raise MeshError(f"{path}: the mesh '{name}' is not there; paths are relative to the URDF's folder")


def _parts(meshes: list[trimesh.Trimesh], max_parts: int, timeout_s: float) -> tuple[tuple[Part, ...], str]:
    """Parts of collision shapes: convex pieces as they are, others decomposed."""
    parts: list[Part] = []
    methods: list[str] = []
    for mesh in meshes:
        bodies = mesh.split(only_watertight=False)
        if 1 <= len(bodies) <= MOST_CONVEX and all(_convex(body) for body in bodies):
            parts += [convex_part(body.vertices) for body in bodies]
            methods.append("exact")
        else:
            found = decompose(mesh, max_parts=max_parts, timeout_s=timeout_s)
            parts += found.parts
            methods.append(found.method)
    if len(parts) > MOST_CONVEX:
        found = decompose(_together(meshes), max_parts=max_parts, timeout_s=timeout_s)
        return found.parts, found.method
    if set(methods) == {"exact"}:
        return tuple(parts), f"exact: {len(parts)} collision pieces"
    return tuple(parts), "; ".join(dict.fromkeys(methods))


def _convex(body: trimesh.Trimesh) -> bool:
    if not body.is_watertight:
        return False
    hull = body.convex_hull.volume
    return hull > 0 and abs(body.volume) > 0.97 * hull


def write_urdf(asset: ObjectAsset, folder: str | Path, *, mass: float | None = None) -> Path:
    """Write an object as a URDF: visual mesh, one collision element a part, mass and inertia.

    Args:
        asset: the object; the link's frame is its own, origin at the centre of mass.
        folder: made when missing; gets `<name>.urdf` and its meshes in `meshes/`.
        mass: kg; by default the asset's own, else its volume at 500 kg/m³.

    Returns:
        The `.urdf` file.

    Raises:
        MeshError: the folder cannot be written.
    """
    folder = Path(folder).expanduser()
    mass = mass or asset.mass or asset.volume * DENSITY
    inertia = asset.unit_inertia * (mass / asset.volume)
    names = [f"meshes/{asset.name}.obj"] + [f"meshes/{asset.name}_part_{i:02d}.obj" for i in range(len(asset.parts))]
    keys = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    lines = [
        '<?xml version="1.0"?>',
        f"<robot name={quoteattr(asset.name)}>",
        f"  <link name={quoteattr(asset.name)}>",
        "    <inertial>",
        '      <origin xyz="0 0 0" rpy="0 0 0"/>',
        f'      <mass value="{mass:.9g}"/>',
        "      <inertia " + " ".join(f'{key}="{inertia[at]:.9g}"' for key, at in keys.items()) + "/>",
        "    </inertial>",
    ]
    for i, name in enumerate(names):
        kind = "visual" if i == 0 else "collision"
        lines += [f"    <{kind}>", f"      <geometry><mesh filename={quoteattr(name)}/></geometry>", f"    </{kind}>"]
    lines += ["  </link>", "</robot>", ""]
    file = folder / f"{asset.name}.urdf"
    try:
        (folder / "meshes").mkdir(parents=True, exist_ok=True)
        _write_obj(folder / names[0], asset.vertices, asset.faces)
        for name, part in zip(names[1:], asset.parts, strict=True):
            _write_obj(folder / name, part.vertices, part.faces)
        file.write_text("\n".join(lines))
    except OSError as error:
        raise MeshError(f"{folder}: cannot be written ({error.strerror})") from error
    return file


def _write_obj(path: Path, vertices: NDArray, faces: NDArray) -> None:
    lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in vertices]
    lines += [f"f {a} {b} {c}" for a, b, c in np.asarray(faces) + 1]
    path.write_text("\n".join(lines) + "\n")
