"""Small exact objects, made by hand so that these tests need no decomposition."""

from collections.abc import Callable

import numpy as np
import pytest
import trimesh

from grasp_core.gripper import Gripper, load_gripper
from grasp_core.objects.asset import ObjectAsset
from grasp_core.objects.decomposition import build_asset
from grasp_core.scene import Scene
from grasp_core.simulation.physics import Physics, load_physics

Maker = Callable[..., ObjectAsset]


def from_parts(name: str, parts: list[trimesh.Trimesh], mass: float | None = None) -> ObjectAsset:
    mesh = trimesh.util.concatenate(parts)
    return build_asset(name, name, mesh, parts=[np.asarray(part.vertices) for part in parts], mass=mass)


def box(x: float, y: float, z: float, mass: float | None = None) -> ObjectAsset:
    return from_parts("box", [trimesh.creation.box([x, y, z])], mass)


def can(radius: float = 0.03, height: float = 0.1) -> ObjectAsset:
    return from_parts("can", [trimesh.creation.cylinder(radius, height, sections=12)])


def bowl(radius: float = 0.06, height: float = 0.05, wall: float = 0.004, count: int = 10) -> ObjectAsset:
    """Segments of a cone's wall on a flat bottom, open to +z."""
    parts = []
    for k in range(count):
        angles = (2 * np.pi * k / count, 2 * np.pi * (k + 1) / count)
        corners = [
            [r * np.cos(a), r * np.sin(a), z]
            for z, share in ((0.0, 0.55), (height, 1.0))
            for a in angles
            for r in (radius * share - wall, radius * share)
        ]
        parts.append(trimesh.convex.convex_hull(np.array(corners)))
    bottom = trimesh.creation.cylinder(radius * 0.55, wall, sections=count)
    bottom.apply_translation([0, 0, wall / 2])
    return from_parts("bowl", [*parts, bottom])


def mug(radius: float = 0.04, height: float = 0.09, wall: float = 0.003, count: int = 10) -> ObjectAsset:
    """A ring of wall segments, a bottom and a square handle: 14 parts."""
    parts = []
    for k in range(count):
        angles = (2 * np.pi * k / count, 2 * np.pi * (k + 1) / count)
        corners = [
            [r * np.cos(a), r * np.sin(a), z] for z in (0, height) for a in angles for r in (radius - wall, radius)
        ]
        parts.append(trimesh.convex.convex_hull(np.array(corners)))
    bottom = trimesh.creation.cylinder(radius, wall, sections=count)
    bottom.apply_translation([0, 0, wall / 2])
    parts.append(bottom)
    for centre, size in (
        ([radius + 0.015, 0, 0.02], [0.03, 0.008, 0.008]),
        ([radius + 0.015, 0, 0.07], [0.03, 0.008, 0.008]),
        ([radius + 0.03, 0, 0.045], [0.008, 0.008, 0.058]),
    ):
        block = trimesh.creation.box(size)
        block.apply_translation(centre)
        parts.append(block)
    return from_parts("mug", parts)


def standing(asset: ObjectAsset, x: float = 0.0, y: float = 0.0) -> np.ndarray:
    """The asset's own axes, resting on z = 0 above (x, y)."""
    pose = np.eye(4)
    pose[:3, 3] = [x, y, -asset.hull.vertices[:, 2].min()]
    return pose


def alone(asset: ObjectAsset) -> Scene:
    return Scene.single(asset, standing(asset))


@pytest.fixture(scope="session")
def physics() -> Physics:
    return load_physics()


@pytest.fixture(scope="session")
def gripper() -> Gripper:
    return load_gripper()


@pytest.fixture(scope="session")
def shapes() -> object:
    class Shapes:
        box = staticmethod(box)
        can = staticmethod(can)
        bowl = staticmethod(bowl)
        mug = staticmethod(mug)
        standing = staticmethod(standing)
        alone = staticmethod(alone)

    return Shapes
