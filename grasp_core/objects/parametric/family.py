"""Families of everyday shapes, and the making of one object from a family and a seed."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import trimesh

from grasp_core.errors import MeshError
from grasp_core.objects.asset import ObjectAsset
from grasp_core.objects.decomposition import build_asset
from grasp_core.objects.hulls import arrays
from grasp_core.objects.parametric.solids import Solid


@dataclass(frozen=True)
class Family:
    """A recipe for shapes.

    Attributes:
        name: e.g. "mug".
        group: e.g. "kitchen".
        build: draws proportions from the generator and makes the shape; its scale does not matter.
        shortest: smallest length of the longest side, metres.
        longest: largest length of the longest side, metres.
        stretch: spread (of the logarithm) of an extra stretch along each axis.
    """

    name: str
    group: str
    build: Callable[[np.random.Generator], Solid]
    shortest: float
    longest: float
    stretch: float


FAMILIES: dict[str, Family] = {}
"""Every family by name, filled by the modules of this package."""

Builder = Callable[[np.random.Generator], Solid]


def family(
    group: str, shortest: float = 10, longest: float = 20, stretch: float = 0.05
) -> Callable[[Builder], Builder]:
    """Register a builder under its function's name (a trailing underscore is dropped); lengths in centimetres."""

    def register(build: Builder) -> Builder:
        name = build.__name__.rstrip("_")
        FAMILIES[name] = Family(name, group, build, shortest / 100, longest / 100, stretch)
        return build

    return register


@lru_cache(maxsize=32)
def make(name: str, seed: int) -> ObjectAsset:
    """The object `name_seed` (e.g. "mug_003"): the same for the same family and seed.

    Raises:
        MeshError: no such family; the message lists them.
    """
    if name not in FAMILIES:
        raise MeshError(f"no family is called '{name}'; choose one of: {', '.join(sorted(FAMILIES))}")
    if seed < 0:
        raise MeshError(f"the seed of a family must be 0 or above, not {seed}")
    kind = FAMILIES[name]
    rng = np.random.default_rng(np.random.SeedSequence([zlib.crc32(name.encode()), seed]))
    size = rng.uniform(kind.shortest, kind.longest)
    stretch = np.exp(np.clip(rng.normal(0, kind.stretch, 3), -2 * kind.stretch, 2 * kind.stretch))
    shape = kind.build(rng).scaled(*stretch)
    # A corner of one piece may stick out of another as a loose chip: the largest body is the object.
    bodies = sorted(shape.body.decompose(), key=lambda body: -body.volume())
    vertices, faces = arrays(bodies[0] if bodies else shape.body)
    if len(faces) == 0:
        raise MeshError(f"{name}_{seed:03d}: the shape came out empty; take another seed")
    scale = size / np.ptp(vertices, axis=0).max()
    return build_asset(
        f"{name}_{seed:03d}",
        name,
        trimesh.Trimesh(vertices * scale, faces, process=False),
        parts=[part * scale for part in shape.parts],
        densities=shape.densities,
        source=f"family {name}, seed {seed}",
        meta={"group": kind.group},
    )
