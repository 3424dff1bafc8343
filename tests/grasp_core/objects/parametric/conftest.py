"""What the tests of the family groups share: each group's families by name, its soundness, and a look into a shape."""

from collections.abc import Callable
from functools import cached_property

import manifold3d
import numpy as np
import pytest
import trimesh
from scipy.spatial import KDTree

from grasp_core.objects.asset import ObjectAsset
from grasp_core.objects.hulls import arrays, solid
from grasp_core.objects.parametric import FAMILIES, make

SEED = 2


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """A test that takes `own_family` runs for every family of its file's `GROUP`, a module of the package."""
    if "own_family" in metafunc.fixturenames:
        group = metafunc.module.GROUP.__name__
        own = sorted(name for name, family in FAMILIES.items() if family.build.__module__ == group)
        assert own, f"{group} registers no family"
        metafunc.parametrize("own_family", own)


class Look:
    """A look into a shape, lengths in mm, axes those of the asset."""

    def __init__(self, asset: ObjectAsset) -> None:
        self.asset = asset
        self.vertices = asset.vertices * 1000
        self.low, self.high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        self.sides = self.high - self.low

    @cached_property
    def body(self) -> manifold3d.Manifold:
        return solid(self.vertices, self.asset.faces)

    @cached_property
    def parts(self) -> manifold3d.Manifold:
        """Union of the parts."""
        parts = [solid(part.vertices * 1000, part.faces) for part in self.asset.parts]
        return manifold3d.Manifold.batch_boolean(parts, manifold3d.OpType.Add)

    @property
    def holes(self) -> int:
        """How many tunnels run through the visible shape: 1 for a ring or for a cup with a handle."""
        return self.body.genus()

    @property
    def fill(self) -> float:
        """Volume over that of the convex hull."""
        return self.body.volume() / self.body.hull().volume()

    def slices(self, axis: str, share: float) -> list[manifold3d.CrossSection]:
        """The separate pieces of a cut across an axis, at a share of the shape's length along it.

        A cut's two coordinates are the axes after the cut one: y z for x, z x for y, x y for z.
        """
        number = "xyz".index(axis)
        turned = solid(np.roll(self.vertices, -number - 1, axis=1), self.asset.faces)
        cut = turned.slice(self.low[number] + share * self.sides[number])
        return [piece for piece in cut.decompose() if piece.area() > 0.05]

    def spans(self, axis: str, share: float) -> np.ndarray:
        """(2,) sides of the box around a cut."""
        boxes = np.array([piece.bounds() for piece in self.slices(axis, share)])
        return boxes[:, 2:].max(axis=0) - boxes[:, :2].min(axis=0)

    def hits(self, start: np.ndarray, direction: tuple[float, float, float], parts: bool = False) -> np.ndarray:
        """Sorted distances at which a ray crosses the surface (or that of the parts)."""
        vertices, faces = arrays(self.parts if parts else self.body)
        a, b, c = (vertices[faces[:, k]] for k in range(3))
        # a hair off, so that the ray meets no edge
        origin = np.add(start, [1.3e-3, 2.1e-3, 1.7e-3])
        along = np.asarray(direction, float)
        normal = np.cross(b - a, c - a)
        slope = normal @ along
        with np.errstate(divide="ignore", invalid="ignore"):
            far = ((a - origin) * normal).sum(axis=1) / slope
            point = origin + far[:, None] * along
            inside = [(np.cross(q - p, point - p) * normal).sum(axis=1) >= 0 for p, q in ((a, b), (b, c), (c, a))]
        return np.sort(far[(np.abs(slope) > 1e-12) & (far > 0) & np.all(inside, axis=0)])

    def drop(self, x: float, y: float, parts: bool = False) -> float:
        """How far below its highest point the shape is first met from straight above (x, y)."""
        found = self.hits(np.array([x, y, self.high[2] + 1.0]), (0, 0, -1), parts)
        assert len(found), f"nothing of {self.asset.name} lies below ({x:.1f}, {y:.1f})"
        return float(found[0]) - 1.0

    def foot(self, share: float = 0.02) -> np.ndarray:
        """(2,) middle of what stands on the ground: the axis of a turned shape, whatever hangs on its side."""
        boxes = np.array([piece.bounds() for piece in self.slices("z", share)])
        return (boxes[:, :2].min(axis=0) + boxes[:, 2:].max(axis=0)) / 2


@pytest.fixture(scope="session")
def look() -> Callable[[str, int], Look]:
    """`look(family, seed)`."""
    return lambda family, seed: Look(make(family, seed))


@pytest.fixture(scope="session")
def assert_sound() -> Callable[[str], None]:
    """Checks that a family's shape is closed and plausible and that its parts show what is seen."""

    def check(family: str) -> None:
        seen = Look(make(family, SEED))
        assert seen.asset.mesh.is_watertight
        assert FAMILIES[family].shortest * 1000 - 1e-6 <= seen.sides.max() <= FAMILIES[family].longest * 1000 + 1e-6
        assert seen.sides.min() > 4, "thinner than anything that fingers can hold"
        low, high = np.array(seen.parts.bounding_box()).reshape(2, 3)
        assert np.abs([low - seen.low, high - seen.high]).max() < 3.5
        surface = KDTree(trimesh.sample.sample_surface(seen.asset.mesh, 15000, seed=0)[0] * 1000)
        beyond, _ = arrays(seen.parts - seen.body)
        assert surface.query(beyond)[0].max(initial=0.0) < 5.5, "a part stands out of what is seen"
        assert 0.8 < seen.parts.volume() / seen.body.volume() < 1.7

    return check
