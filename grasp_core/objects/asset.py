"""ObjectAsset: a graspable rigid object, its mesh and its convex parts, ready for physics and rendering.

Object frame: origin at the centre of mass of the parts, metres, axes as in the source mesh. Volume and inertia come
from the convex parts, never from the raw mesh, which may be open or wound wrongly.
"""

from __future__ import annotations

import hashlib
import io
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import msgspec
import numpy as np
import trimesh
from numpy.typing import NDArray

from grasp_core.errors import MeshError


@dataclass(frozen=True, eq=False)
class Part:
    """One convex collision part: vertices (V, 3) float64 in the object frame, metres; faces (F, 3) int32, outward."""

    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]

    @cached_property
    def mesh(self) -> trimesh.Trimesh:
        """The part as a trimesh."""
        return trimesh.Trimesh(self.vertices, self.faces, process=False)


@dataclass(frozen=True, eq=False)
class ObjectAsset:
    """A rigid object.

    Attributes:
        name: unique in its library; names split datasets.
        category: family or class, e.g. "mug".
        vertices: (V, 3) float64 of the visual mesh in the object frame, metres.
        faces: (F, 3) int32.
        parts: convex collision parts, made once and stored with the asset.
        volume: of the parts, overlaps counted once where known, m³.
        unit_inertia: (3, 3) inertia about the origin for a density of 1 kg/m³, object axes, kg·m².
        mass: kg where the source states one (URDF), else None: physics gives it from its density.
        decomposition: how the parts came about: "coacd", "exact" (built convex) or "hull" (fallback), with details.
        source: where the object comes from (file name or family and seed), for people.
    """

    name: str
    category: str
    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]
    parts: tuple[Part, ...]
    volume: float
    unit_inertia: NDArray[np.float64]
    mass: float | None = None
    decomposition: str = "exact"
    source: str = ""
    meta: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.parts or self.vertices.ndim != 2 or self.vertices.shape[1] != 3 or not len(self.faces):
            raise MeshError(f"the object '{self.name}' needs a mesh and at least one convex part; import it again")
        if not (self.volume > 0 and np.isfinite(self.vertices).all() and np.isfinite(self.unit_inertia).all()):
            raise MeshError(
                f"the object '{self.name}' has no volume or holds numbers that are not finite; mend its mesh"
            )
        if self.mass is not None and not 0 < self.mass < float("inf"):
            raise MeshError(f"the object '{self.name}' has the mass {self.mass} kg; state one above 0 or none")

    @cached_property
    def mesh(self) -> trimesh.Trimesh:
        """The visual mesh as a trimesh (not processed)."""
        return trimesh.Trimesh(self.vertices, self.faces, process=False)

    @cached_property
    def hull(self) -> trimesh.Trimesh:
        """Convex hull of all parts."""
        return trimesh.convex.convex_hull(np.concatenate([part.vertices for part in self.parts]))

    @cached_property
    def extents(self) -> NDArray[np.float64]:
        """(3,) sides of the visual mesh's axis-aligned box, metres."""
        return np.ptp(self.vertices, axis=0)

    @cached_property
    def digest(self) -> str:
        """A hash of the geometry and mass."""
        h = hashlib.sha256()
        for array in (self.vertices, self.faces, *(a for part in self.parts for a in (part.vertices, part.faces))):
            h.update(np.ascontiguousarray(array).tobytes())
        h.update(repr(self.mass).encode())
        return h.hexdigest()[:12]

    def to_bytes(self) -> bytes:
        """The asset as one compressed npz; inverse of `from_bytes`."""
        arrays: dict[str, NDArray] = {
            "vertices": self.vertices,
            "faces": self.faces,
            "unit_inertia": self.unit_inertia,
            "part_vertices": np.concatenate([part.vertices for part in self.parts]),
            "part_faces": np.concatenate([part.faces for part in self.parts]),
            "part_sizes": np.array([[len(part.vertices), len(part.faces)] for part in self.parts], np.int32),
        }
        head = {
            "name": self.name,
            "category": self.category,
            "volume": self.volume,
            "mass": self.mass,
            "decomposition": self.decomposition,
            "source": self.source,
            "meta": self.meta,
        }
        arrays["head"] = np.frombuffer(msgspec.json.encode(head), np.uint8)
        buffer = io.BytesIO()
        np.savez_compressed(buffer, **arrays)  # type: ignore[arg-type]
        return buffer.getvalue()

    @classmethod
    def from_bytes(cls, data: bytes) -> ObjectAsset:
        """Read what `to_bytes` wrote.

        Raises:
            MeshError: the bytes are damaged or something else.
        """
        try:
            with np.load(io.BytesIO(data), allow_pickle=False) as arrays:
                head = msgspec.json.decode(arrays["head"].tobytes())
                sizes = arrays["part_sizes"]
                ends = np.cumsum(sizes, axis=0)
                parts = tuple(
                    Part(arrays["part_vertices"][e[0] - s[0] : e[0]], arrays["part_faces"][e[1] - s[1] : e[1]])
                    for s, e in zip(sizes, ends, strict=True)
                )
                return cls(
                    vertices=arrays["vertices"],
                    faces=arrays["faces"],
                    unit_inertia=arrays["unit_inertia"],
                    parts=parts,
                    **head,
                )
        except Exception as error:  # zip, npy, JSON and type errors alike mean damaged bytes
            raise MeshError(f"these bytes hold no object asset ({error}); import the object again") from error

    def save(self, path: Path) -> None:
        """Write the asset to one `.npz` file."""
        path.write_bytes(self.to_bytes())

    @classmethod
    def load(cls, path: Path) -> ObjectAsset:
        """Read an asset that `save` wrote.

        Raises:
            MeshError: missing or damaged file.
        """
        try:
            return cls.from_bytes(path.read_bytes())
        except OSError as error:
            raise MeshError(f"{path}: cannot be read ({error.strerror})") from error
        except MeshError as error:
            raise MeshError(f"{path}: {error}") from error
