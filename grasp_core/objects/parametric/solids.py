"""Building blocks of the catalogue: closed solids that carry their exact convex parts along.

Sizes here are plain proportions (think centimetres); `family.make` gives an object its size in metres.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import manifold3d
import numpy as np
from numpy.typing import ArrayLike, NDArray

from grasp_core.objects.hulls import solid

Points = NDArray[np.float64]
RING = 48
"""Points of a visual ring; rings of parts take every fourth or sixth."""


@dataclass(frozen=True)
class Solid:
    """A closed body, the points (N, 3) of each convex part, and the parts' relative densities."""

    body: manifold3d.Manifold
    parts: tuple[Points, ...]
    densities: tuple[float, ...]

    @classmethod
    def of(cls, body: manifold3d.Manifold, parts: Sequence[Points]) -> Solid:
        """A body of density 1."""
        return cls(body, tuple(np.asarray(part, float) for part in parts), (1.0,) * len(parts))

    def __add__(self, other: Solid) -> Solid:
        return Solid(self.body + other.body, self.parts + other.parts, self.densities + other.densities)

    def carved(self, other: Solid) -> Solid:
        """With the body of `other` taken from what is seen: for grooves too shallow to matter to physics."""
        return replace(self, body=self.body - other.body)

    def dense(self, density: float) -> Solid:
        """With another relative density."""
        return replace(self, densities=(density,) * len(self.parts))

    def mapped(self, matrix: ArrayLike, offset: ArrayLike = (0, 0, 0)) -> Solid:
        """Under x → matrix · x + offset (3×3 and (3,))."""
        m, t = np.asarray(matrix, float), np.asarray(offset, float)
        return Solid(
            self.body.transform(np.c_[m, t].tolist()), tuple(part @ m.T + t for part in self.parts), self.densities
        )

    def at(self, x: float = 0, y: float = 0, z: float = 0) -> Solid:
        """Moved."""
        return self.mapped(np.eye(3), (x, y, z))

    def scaled(self, x: float, y: float | None = None, z: float | None = None) -> Solid:
        """Stretched along each axis; one number scales all."""
        return self.mapped(np.diag([x, x if y is None else y, x if z is None else z]))

    def turned(self, axis: str, degrees: float) -> Solid:
        """Turned about the axis "x", "y" or "z" through the origin."""
        return self.mapped(turn(axis, degrees))


def turn(axis: str, degrees: float) -> Points:
    """The rotation (3, 3) about a main axis."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    matrix = np.eye(3)
    matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = c, -s, s, c
    return matrix


def hull(*points: ArrayLike) -> Solid:
    """The convex hull of point sets: one part."""
    together = np.concatenate([np.asarray(p, float).reshape(-1, 3) for p in points])
    return Solid.of(manifold3d.Manifold.hull_points(together), [together])


def box(x: float, y: float, z: float, rounding: float = 0.0) -> Solid:
    """A box about the origin with sides x, y, z, its edges rounded by a radius (chamfered in the part)."""
    r = min(rounding, 0.49 * min(x, y, z))
    corners = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)], float)
    half = np.array([x, y, z]) / 2
    if r <= 0:
        return hull(corners * half)
    ball_ = manifold3d.Manifold.sphere(r, 16)
    seen = manifold3d.Manifold.batch_hull([ball_.translate(tuple(c * (half - r))) for c in corners])
    cut = 0.45 * r
    part = [c * (half - cut * (1 - np.eye(3)[k])) for c in corners for k in range(3)]
    return Solid.of(seen, [np.array(part)])


@dataclass(frozen=True)
class Section:
    """A superellipse in a plane of constant z: half axes a and b (a when None), exponent n (2 round, 6 squarish)."""

    z: float
    a: float
    b: float | None = None
    n: float = 2.0
    x: float = 0.0
    y: float = 0.0

    def ring(self, count: int = RING, inset: float = 0.0, start: float = 0.0) -> Points:
        """(count, 3) points, counter-clockwise from the angle `start` rad, moved inwards by `inset`."""
        angle = start + np.arange(count) * (2 * np.pi / count)
        return self.points(angle, inset)

    def points(self, angle: ArrayLike, inset: float = 0.0) -> Points:
        """(len, 3) points at parameter angles, rad."""
        t = np.asarray(angle, float)
        c, s = np.cos(t), np.sin(t)
        a, b = self.a - inset, (self.a if self.b is None else self.b) - inset
        px = a * np.sign(c) * np.abs(c) ** (2 / self.n)
        py = b * np.sign(s) * np.abs(s) ** (2 / self.n)
        return np.c_[px + self.x, py + self.y, np.full(len(t), self.z)]

    def coarse(self) -> Points:
        """The ring of a part: 12 points (8 when squarish), of the same area as the fine ring."""
        count = 8 if self.n > 3 else 12
        ring, fine = self.ring(count), self.ring()
        grow = math.sqrt(_area(fine) / max(_area(ring), 1e-12))
        centre = np.array([self.x, self.y, self.z])
        return centre + (ring - centre) * grow


def _area(ring: Points) -> float:
    x, y = ring[:, 0] - ring[:, 0].mean(), ring[:, 1] - ring[:, 1].mean()
    return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2)


def breaks(curve: ArrayLike, most: int, tolerance: float = 0.04) -> list[int]:
    """Indices that cut a polyline (N, D) into at most `most` chords, always where it strays farthest from its chord."""
    points = np.asarray(curve, float)
    chosen = [0, len(points) - 1]
    while len(chosen) <= most:
        worst, where = tolerance, -1
        for i, j in itertools.pairwise(chosen):
            along = points[j] - points[i]
            offset = points[i + 1 : j] - points[i]
            if len(offset) == 0:
                continue
            foot = np.clip(offset @ along / max(along @ along, 1e-12), 0, 1)[:, None] * along
            away = np.linalg.norm(offset - foot, axis=1)
            if away.max() > worst + 1e-9:
                worst, where = float(away.max()), i + 1 + int(away.argmax())
        if where < 0:
            break
        chosen = sorted([*chosen, where])
    return chosen


def rings_body(rings: Sequence[Points], closed: bool = False) -> manifold3d.Manifold:
    """A body whose skin runs through rings (K, 3) of equal count; capped at both ends, or closed into a loop."""
    count, k = len(rings), len(rings[0])
    vertices = np.concatenate(rings)
    index = np.arange(count * k).reshape(count, k)
    faces = []
    for i in range(count if closed else count - 1):
        low, high = index[i], index[(i + 1) % count]
        a, b, c, d = low, np.roll(low, -1), np.roll(high, -1), high
        faces += [np.c_[a, b, c], np.c_[a, c, d]]
    if not closed:
        ends = np.array([rings[0].mean(axis=0), rings[-1].mean(axis=0)])
        vertices = np.concatenate([vertices, ends])
        low, high = index[0], index[-1]
        faces += [np.c_[np.roll(low, -1), low, np.full(k, count * k)]]
        faces += [np.c_[high, np.roll(high, -1), np.full(k, count * k + 1)]]
    body = solid(vertices, np.concatenate(faces))
    return body if body.volume() >= 0 else solid(vertices, np.concatenate(faces)[:, ::-1])


def loft(sections: Sequence[Section], slices: int = 6) -> Solid:
    """A solid through convex sections of rising z; its parts are at most `slices` slices."""
    profile = [[s.z, s.a, s.a if s.b is None else s.b, s.x, s.y] for s in sections]
    cuts = breaks(profile, slices)
    rings = [sections[i].coarse() for i in cuts]
    parts = [np.concatenate(pair) for pair in itertools.pairwise(rings)]
    return Solid.of(rings_body([s.ring() for s in sections]), parts)


def lathe(profile: ArrayLike, slices: int = 6) -> Solid:
    """A solid of revolution about z from (radius, z) pairs of rising z."""
    return loft([Section(float(z), max(float(r), 1e-3)) for r, z in np.asarray(profile, float)], slices)


def cylinder(radius: float, height: float, rounding: float = 0.0, top: float | None = None) -> Solid:
    """An upright cylinder (or cone to the radius `top`) on z = 0, its rims rounded."""
    top = radius if top is None else top
    r = min(rounding, 0.45 * height, 0.9 * radius, 0.9 * top)
    if r <= 0:
        return lathe([(radius, 0), (top, height)])
    arc = np.linspace(0, np.pi / 2, 5)
    low = [(radius - r + r * math.sin(t), r - r * math.cos(t)) for t in arc]
    high = [(top - r + r * math.cos(t), height - r + r * math.sin(t)) for t in arc]
    return lathe(low + high, 3)


def ball(x: float, y: float | None = None, z: float | None = None) -> Solid:
    """An ellipsoid about the origin with half axes x, y, z (x where None)."""
    t = np.linspace(-np.pi / 2, np.pi / 2, 25)
    unit = lathe(np.c_[np.cos(t), np.sin(t)], 5)
    unit = replace(unit, parts=tuple(part * 1.03 for part in unit.parts))  # keeps most of the volume of the ball
    return unit.scaled(x, x if y is None else y, x if z is None else z)


def curve(points: ArrayLike, count: int = 40, closed: bool = False) -> Points:
    """A smooth curve (count, D) through points (N, D): centripetal Catmull-Rom."""
    given = np.asarray(points, float)
    if closed:
        given = np.concatenate([given[-1:], given, given[:2]])
    else:
        given = np.concatenate([[2 * given[0] - given[1]], given, [2 * given[-1] - given[-2]]])
    knots = np.concatenate([[0], np.cumsum(np.sqrt(np.linalg.norm(np.diff(given, axis=0), axis=1)) + 1e-9)])
    t = np.linspace(knots[1], knots[-2], count, endpoint=not closed)
    k = np.clip(np.searchsorted(knots, t, side="right") - 1, 1, len(given) - 3)
    t = t[:, None]
    p0, p1, p2, p3 = (given[k + i] for i in (-1, 0, 1, 2))
    t0, t1, t2, t3 = (knots[k + i][:, None] for i in (-1, 0, 1, 2))
    a1 = ((t1 - t) * p0 + (t - t0) * p1) / (t1 - t0)
    a2 = ((t2 - t) * p1 + (t - t1) * p2) / (t2 - t1)
    a3 = ((t3 - t) * p2 + (t - t2) * p3) / (t3 - t2)
    b1 = ((t2 - t) * a1 + (t - t0) * a2) / (t2 - t0)
    b2 = ((t3 - t) * a2 + (t - t1) * a3) / (t3 - t1)
    return ((t2 - t) * b1 + (t - t1) * b2) / (t2 - t1)


def tube(
    path: ArrayLike,
    radius: ArrayLike,
    flat: float = 1.0,
    *,
    pieces: int = 6,
    closed: bool = False,
    n: float = 2.0,
    up: ArrayLike = (0, 0, 1),
) -> Solid:
    """A rod along a path (N, 3) with one radius or one for each point.

    `flat` is the section's half axis along `up` over its radius; parts are at most `pieces` chords of the path.
    """
    line = np.asarray(path, float)
    radii = np.broadcast_to(np.asarray(radius, float), (len(line),))
    ends = np.concatenate([line[-1:], line, line[:1]]) if closed else line
    ahead = np.gradient(ends, axis=0)[1:-1] if closed else np.gradient(ends, axis=0)
    ahead = ahead / np.linalg.norm(ahead, axis=1, keepdims=True)
    side = np.cross(np.asarray(up, float), ahead)
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    over = np.cross(ahead, side)

    def rings(count: int, grow: float) -> list[Points]:
        unit = Section(0, 1, 1, n).ring(count)[:, :2] * grow
        return [
            p + r * (unit[:, :1] * s + unit[:, 1:] * flat * o)
            for p, r, s, o in zip(line, radii, side, over, strict=True)
        ]

    coarse = rings(8 if n > 3 else 12, 1.0 if n > 3 else 1.0233)
    if closed:
        cuts = [round(i * len(line) / pieces) for i in range(pieces)]
        pairs = list(zip(cuts, [*cuts[1:], 0], strict=True))
    else:
        cuts = breaks(np.c_[line, radii], pieces)
        pairs = list(itertools.pairwise(cuts))
    parts = [np.concatenate([coarse[i], coarse[j]]) for i, j in pairs]
    return Solid.of(rings_body(rings(24, 1.0), closed), parts)
