"""Toys, sports things and free forms."""

from __future__ import annotations

import numpy as np
from shapely.geometry import Polygon

from grasp_core.objects.parametric.family import family
from grasp_core.objects.parametric.outlines import joined, rectangle, regular, slab
from grasp_core.objects.parametric.solids import Section, Solid, ball, box, curve, cylinder, hull, lathe, loft, tube


@family("toys", 8, 18)
def toy_car(rng: np.random.Generator) -> Solid:
    """A body, a cabin and four wheels."""
    length, w, h = rng.uniform(8, 13), rng.uniform(3.5, 5), rng.uniform(1.4, 2.6)
    r = rng.uniform(0.9, 1.5)
    c = length * rng.uniform(0.2, 0.32)
    x = rng.uniform(-0.15, 0.1) * length
    cabin = loft([Section(0, c, w * 0.46, 6, x=x), Section(rng.uniform(1.2, 2.4), c * 0.7, w * 0.4, 6, x=x)], 1)
    car = box(length, w, h, 0.3) + cabin.at(z=h / 2 - 0.05)
    for sx in (-1, 1):
        for sy in (-1, 1):
            wheel = cylinder(r, 0.9, 0.1).turned("x", 90).at(y=0.45)
            car = car + wheel.at(x=sx * length * 0.3, y=sy * (w / 2), z=-h / 2)
    return car


@family("toys", 6, 14)
def brick(rng: np.random.Generator) -> Solid:
    """A block with studs."""
    nx, ny = int(rng.integers(2, 5)), int(rng.integers(1, 3))
    shape = box(nx * 2, ny * 2, rng.uniform(1.4, 3))
    top = float(shape.parts[0][:, 2].max())
    for i in range(nx):
        for j in range(ny):
            shape = shape + cylinder(0.6, 0.6).at(x=2 * i - nx + 1, y=2 * j - ny + 1, z=top - 0.05)
    return shape


@family("toys", 7, 16)
def polyomino(rng: np.random.Generator) -> Solid:
    """Three to five cubes face to face."""
    cells = [(0, 0, 0)]
    steps = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1)]
    count = int(rng.integers(3, 6))
    while len(cells) < count:
        at = cells[int(rng.integers(len(cells)))]
        step = steps[int(rng.integers(5))]
        new = (at[0] + step[0], at[1] + step[1], at[2] + step[2])
        if new not in cells:
            cells.append(new)
    shape = box(2.06, 2.06, 2.06)
    for x, y, z in cells[1:]:
        shape = shape + box(2.06, 2.06, 2.06).at(2.0 * x, 2.0 * y, 2.0 * z)
    return shape


@family("toys", 9, 18)
def dumbbell(rng: np.random.Generator) -> Solid:
    """Two weights on a bar: balls, discs or blocks."""
    bar, r, gap = rng.uniform(0.8, 1.4), rng.uniform(1.8, 3.2), rng.uniform(5, 9)
    kind = int(rng.integers(3))
    weight = [ball(r), cylinder(r, r, 0.2).at(z=-r / 2), slab(regular(6, r), r * 1.1)][kind].dense(2.0)
    other = weight.scaled(rng.uniform(0.7, 1.0)) if rng.random() < 0.3 else weight
    return (cylinder(bar, gap).at(z=-gap / 2) + weight.at(z=-gap / 2) + other.at(z=gap / 2)).turned("y", 90)


@family("toys", 10, 20)
def bowling_pin(rng: np.random.Generator) -> Solid:
    """A turned figure: pins, pawns, dolls, skittles, table legs."""
    h = 14.0
    belly, neck, head = rng.uniform(2, 3.2), rng.uniform(0.8, 1.4), rng.uniform(1.3, 2.2)
    foot = (belly * rng.uniform(0.55, 1.1), 0)
    return lathe(curve([foot, (belly, 0.3 * h), (neck, 0.68 * h), (head, 0.86 * h), (0.4, h)], 26), 7)


@family("toys", 7, 15)
def spinning_top(rng: np.random.Generator) -> Solid:
    """A cone, a rim and a peg."""
    r, peg = rng.uniform(2.5, 4), rng.uniform(0.4, 0.7)
    return lathe([(0.2, 0), (r, 3.2), (r, 3.2 + rng.uniform(0.5, 2)), (peg, 6.2), (peg, 6.2 + rng.uniform(1.5, 4))], 5)


@family("toys", 9, 18)
def animal(rng: np.random.Generator) -> Solid:
    """A four-legged toy: body, legs, neck, head and tail."""
    length, r, leg = rng.uniform(5, 8), rng.uniform(1.4, 2.2), rng.uniform(2.5, 5)
    shape = ball(length / 2 + r * 0.4, r, r * rng.uniform(0.9, 1.2))
    for sx in (-1, 1):
        for sy in (-1, 1):
            foot = cylinder(r * 0.38, leg + r * 0.5, top=r * 0.45).at(z=-leg - r * 0.3)
            shape = shape + foot.at(x=sx * length * 0.36, y=sy * r * 0.5)
    rise = rng.uniform(0.5, 4)
    head = np.array([length / 2 + rng.uniform(0.6, 1.6), 0, rise + r * 0.4])
    neck = tube(np.array([[length * 0.35, 0, 0], head]), r * 0.5, pieces=1, up=(0, 1, 0))
    snout = ball(r * rng.uniform(0.8, 1.2), r * 0.65, r * 0.65)
    return shape + neck + snout.at(head[0] + r * 0.3, 0, head[2] + 0.2)


@family("toys", 9, 18)
def toy_plane(rng: np.random.Generator) -> Solid:
    """A fuselage, wings and a tail."""
    length, span, r = 12.0, rng.uniform(9, 15), rng.uniform(0.8, 1.4)
    body = lathe([(0.3, 0), (r, length * 0.2), (r, length * 0.6), (0.4, length)], 4).turned("y", 90)
    chord, sweep = rng.uniform(2, 3.5), rng.uniform(-0.5, 3)
    x0, tip = length * rng.uniform(0.3, 0.42), rng.uniform(0.4, 0.9)
    shape = body
    for s in (-1, 1):
        root = [[x0 + c * chord, s * 0.1, z] for c in (0, 1) for z in (-0.25, 0.25)]
        end = [[x0 + sweep + c * chord * tip, s * span / 2, z] for c in (0, 1) for z in (-0.15, 0.15)]
        shape = shape + hull(root, end)
        tail = [[length - 2 + c * 1.7, s * 0.1, z] for c in (0, 1) for z in (-0.2, 0.2)]
        far = [[length - 1.2 + c * 1.2, s * span * 0.18, z] for c in (0, 1) for z in (-0.15, 0.15)]
        shape = shape + hull(tail, far)
    fin = hull(
        [[length - 2.2, y, 0] for y in (-0.2, 0.2)],
        [[length - 0.2, y, 0] for y in (-0.2, 0.2)],
        [[length - 0.8 + c, y, rng.uniform(1.8, 2.6)] for c in (0, 0.8) for y in (-0.15, 0.15)],
    )
    return shape + fin


@family("toys", 8, 18)
def boat(rng: np.random.Generator) -> Solid:
    """A hull with a cabin or a mast."""
    length, w, h = 6.0, rng.uniform(1.6, 2.8), rng.uniform(1.5, 3)
    shape = loft([Section(0, length * 0.75, w * 0.6, 1.8), Section(h, length, w, 1.7, x=0.3)], 1)
    if rng.random() < 0.6:
        shape = shape + box(rng.uniform(2.5, 5), w * 1.1, 2.2, 0.1).at(x=-1, z=h + 1)
    if rng.random() < 0.7:
        shape = shape + cylinder(0.4, rng.uniform(4, 8)).at(x=0.5, z=h - 0.2)
    return shape


@family("toys", 7, 14)
def star(rng: np.random.Generator) -> Solid:
    """A star or a cross-shaped tile."""
    points, r = int(rng.integers(4, 8)), 5.0
    inner = rng.uniform(0.4, 0.7) * r
    t = np.arange(2 * points) * np.pi / points
    radius = np.where(np.arange(2 * points) % 2 == 0, r, inner)
    return slab(Polygon(np.c_[radius * np.cos(t), radius * np.sin(t)]), rng.uniform(1, 4), pieces=9, bevel=0.1)


@family("toys", 8, 16)
def arch(rng: np.random.Generator) -> Solid:
    """Building blocks: arches, bridges, gates and steps."""
    a, b, t = rng.uniform(6, 9), rng.uniform(3.5, 7), rng.uniform(1, 2)
    kinds = [
        rectangle(a, b).difference(rectangle(a - 2 * t, b, y=-t)),
        joined(*[rectangle(a * (3 - k) / 3, b / 3, x=-a * k / 6, y=k * (b / 3 - 0.01)) for k in range(3)]),
        joined(rectangle(a, t * 1.5), *[rectangle(t, b, x=x, y=-b / 2) for x in (-a / 2 + t, 0, a / 2 - t)]),
    ]
    return slab(kinds[int(rng.integers(3))], rng.uniform(1.5, 4.5), pieces=6).turned("x", 90)


@family("free", 8, 18, stretch=0.15)
def stone(rng: np.random.Generator) -> Solid:
    """A random convex lump."""
    points = rng.normal(size=(int(rng.integers(9, 22)), 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    return hull(points * rng.uniform(0.75, 1.1, (len(points), 1)) * rng.uniform(0.45, 1.0, 3))


@family("free", 9, 19, stretch=0.1)
def cluster(rng: np.random.Generator) -> Solid:
    """Three to six random boxes, rods, balls and lumps that grow into each other."""
    shape, centre = ball(1.0), np.zeros(3)
    for _ in range(int(rng.integers(3, 6))):
        a, b, c = rng.uniform(1.0, 4.0, 3)
        kind = int(rng.integers(4))
        rod, cone = cylinder(a * 0.6, 2 * b).at(z=-b), cylinder(a, b, top=a * 0.4).at(z=-b / 2)
        one = [box(2 * a, 2 * b, c, 0.2), rod, ball(a, a, b), cone][kind]
        tilt = float(rng.uniform(0, 360)) if rng.random() < 0.4 else 0.0
        one = one.turned("x", tilt).turned("z", float(rng.uniform(0, 360)))
        shape = shape + one.at(*centre)
        step = rng.normal(size=3)
        centre = centre + step / np.linalg.norm(step) * min(a, b, c) * 0.7
    return shape


@family("free", 9, 19)
def twist(rng: np.random.Generator) -> Solid:
    """A bent rod of changing thickness: hooks, pipes, handles, bones, driftwood."""
    points = np.cumsum(rng.normal(size=(4, 3)) * [2.2, 2.2, 0.5] + [3.2, 0, 0], axis=0)
    path = curve(points, 24)
    radius = np.interp(np.linspace(0, 1, 24), np.linspace(0, 1, 4), rng.uniform(0.6, 1.7, 4))
    return tube(path, radius, rng.uniform(0.6, 1.2), pieces=8, n=float(rng.choice([2.0, 2.0, 4.0])))


@family("free", 8, 18, stretch=0.15)
def tower(rng: np.random.Generator) -> Solid:
    """Stacked convex slices of changing size, offset and squareness: lamps, vases, bottles, chess pieces."""
    count = int(rng.integers(3, 6))
    z, sections = 0.0, []
    n = float(rng.choice([2.0, 2.0, 4.0, 8.0]))
    ratio = rng.uniform(0.6, 1.0) if n > 3 else 1.0
    for _ in range(count):
        a = rng.uniform(0.8, 3.5)
        sections += [Section(z, a, a * ratio, n, x=rng.uniform(-0.4, 0.4))]
        z += rng.uniform(0.8, 4.5)
        sections += [Section(z, a * rng.uniform(0.6, 1.2), None, n) if n < 3 else Section(z, a, a * ratio, n)]
        z += 0.02
    return loft(sections, 2 * count - 1)
