"""OFF meshes as they are found in the wild: fused headers, CRLF, comments, colours, polygons."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import trimesh
from numpy.typing import NDArray

from grasp_core.errors import MeshError

_HEADER = re.compile(r"^\s*(?:ST)?C?N?4?n?OFF(\s+BINARY)?", re.IGNORECASE)


def read_off(path: Path) -> trimesh.Trimesh:
    """Read an OFF file; polygons become triangle fans, colours and normals are left out.

    Raises:
        MeshError: not an OFF file, cut short, or with indices out of range; the message names file and reason.
    """
    try:
        text = path.read_bytes().decode("latin-1")
    except OSError as error:
        raise MeshError(f"{path}: cannot be read ({error.strerror})") from error
    header = _HEADER.match(text)
    if header is None:
        raise MeshError(f"{path}: does not begin with OFF; it is no OFF mesh or a damaged one")
    if header.group(1):
        raise MeshError(f"{path}: is a binary OFF file, which is not read; convert it to text OFF or PLY")
    lines = [line for raw in text[header.end() :].splitlines() if (line := raw.split("#", 1)[0].split())]
    try:
        vertex_count, face_count = int(lines[0][0]), int(lines[0][1])
    except (IndexError, ValueError) as error:
        raise MeshError(f"{path}: the counts of vertices and faces after OFF are missing or no numbers") from error
    body = lines[1:]
    if len(body) < vertex_count + face_count:
        raise MeshError(
            f"{path}: promises {vertex_count} vertices and {face_count} faces but ends after {len(body)} lines;"
            " copy it again"
        )
    try:
        vertices = np.array([line[:3] for line in body[:vertex_count]], np.float64).reshape(-1, 3)
        faces = _triangles(body[vertex_count : vertex_count + face_count])
    except (ValueError, IndexError) as error:
        raise MeshError(f"{path}: a line of coordinates or a face is damaged ({error}); copy the file again") from error
    if len(faces) and (faces.min() < 0 or faces.max() >= vertex_count):
        raise MeshError(f"{path}: a face names vertex {faces.max()} of {vertex_count}; the file is damaged")
    return trimesh.Trimesh(vertices, faces, process=False)


def _triangles(lines: list[list[str]]) -> NDArray[np.int64]:
    """(F, 3) from face lines `n i0 i1 … [colour]`."""
    if lines and all(line[0] == "3" for line in lines):
        return np.array([line[1:4] for line in lines], np.int64)
    faces = []
    for line in lines:
        corners = [int(word) for word in line[1 : int(line[0]) + 1]]
        if len(corners) != int(line[0]):
            raise ValueError(f"a face of {line[0]} corners names {len(corners)}")
        faces += [(corners[0], corners[i], corners[i + 1]) for i in range(1, len(corners) - 1)]
    return np.array(faces, np.int64).reshape(-1, 3)
