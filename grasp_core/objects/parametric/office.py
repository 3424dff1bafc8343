"""Things from desk and drawer."""

from __future__ import annotations

import numpy as np
from shapely.affinity import rotate
from shapely.geometry import Polygon

from grasp_core.objects.parametric.family import family
from grasp_core.objects.parametric.outlines import circle, joined, rectangle, slab, strip
from grasp_core.objects.parametric.solids import Section, Solid, box, cylinder, hull, lathe, loft


@family("office", 11, 17)
def pen(rng: np.random.Generator) -> Solid:
    """A thin or thick pen with a tip and, often, a clip; round, or hexagonal-like."""
    length, radius = 14.0, rng.uniform(0.4, 0.95)
    n = 2.0 if rng.random() < 0.7 else 3.5
    tip = length * rng.uniform(0.08, 0.2)
    line = [(0.12, 0), (radius * 0.95, tip), (radius, length * 0.5), (radius, length * 0.97), (radius * 0.7, length)]
    body = loft([Section(z, r, n=n) for r, z in line], 4)
    if rng.random() < 0.6:
        clip = length * rng.uniform(0.2, 0.32)
        body = body + box(0.3, 0.5, clip, 0.08).at(x=radius + 0.12, z=length * 0.97 - clip / 2)
        body = body + box(0.5, 0.5, 0.5, 0.08).at(x=radius - 0.05, z=length * 0.97 - 0.25)
    return body.turned("y", 90)


@family("office", 12, 17)
def phone(rng: np.random.Generator) -> Solid:
    """A smartphone with a camera bump, or a folded one."""
    width, thick = rng.uniform(6.2, 8.2), rng.uniform(0.7, 1.5)
    body = slab(rectangle(width, 15, rng.uniform(0.4, 1.2)), thick, bevel=0.12)
    if rng.random() < 0.7:
        side = rng.uniform(1.8, 3.0)
        body = body + box(side, side, 0.4, 0.12).at(x=width / 2 - side * 0.75, y=7.5 - side * 0.75, z=thick / 2 + 0.05)
    return body


@family("packaging", 8, 20)
def carton(rng: np.random.Generator) -> Solid:
    """A drink carton: a block with a gabled top and perhaps a cap."""
    width, deep, height = rng.uniform(4.5, 8), rng.uniform(4, 7), rng.uniform(8, 17)
    roof = rng.uniform(1.5, 3.5)
    sections = [Section(0, width / 2, deep / 2, 14), Section(height, width / 2, deep / 2, 14)]
    body = loft([*sections, Section(height + roof, width / 2, 0.25, 14)], 2)
    body = body + box(width, 0.5, 1.4).at(z=height + roof + 0.4)
    if rng.random() < 0.5:
        body = body + cylinder(1.1, 1.4, 0.1).turned("x", 50).at(y=-deep * 0.25, z=height + roof * 0.4)
    return body


@family("packaging", 6, 20, stretch=0.1)
def box_(rng: np.random.Generator) -> Solid:
    """A closed box: cubes, slabs and bars, sharp or rounded."""
    sides = np.sort(rng.uniform(0.25, 1.0, 3)) * 10
    x, y, z = (float(side) for side in rng.permutation(sides))
    return box(x, y, z, float(rng.choice([0.0, 0.0, 0.3, 1.0])))


@family("office", 8, 16)
def glue_stick(rng: np.random.Generator) -> Solid:
    """A stick with a stepped cap."""
    radius, cap = rng.uniform(1.1, 2.0), rng.uniform(0.3, 0.45)
    line = [
        (radius, 0),
        (radius, 9 * (1 - cap)),
        (radius * 1.12, 9 * (1 - cap) + 0.05),
        (radius * 1.12, 8.7),
        (radius, 9),
    ]
    return lathe(line, 4)


@family("office", 10, 18)
def stapler(rng: np.random.Generator) -> Solid:
    """A base and an arm that gapes at the front."""
    length, w, gape = rng.uniform(10, 15), rng.uniform(1.6, 2.8), rng.uniform(0.4, 2)
    base = box(length, w, 1.0, 0.2).at(z=0.5)
    top = hull(
        [[-length / 2, s * w / 2, z] for s in (-1, 1) for z in (0.9, 2.6)],
        [[length / 2, s * w / 2 * 0.9, z + gape] for s in (-1, 1) for z in (1.0, 2.2)],
    )
    return base + top


@family("office", 11, 18)
def scissors(rng: np.random.Generator) -> Solid:
    """Two finger rings and a closed or open pair of blades."""
    r, blade, open_ = rng.uniform(1.6, 2.3), rng.uniform(6, 10), rng.uniform(2, 14)
    halves = []
    for s in (-1, 1):
        eye = circle(r, -5.5, s * (r + 0.2)).difference(circle(r - rng.uniform(0.5, 0.8), -5.5, s * (r + 0.2)))
        arm = strip([(-4.6, s * r * 0.6), (0, 0)], 1.1)
        cut = Polygon([(-1, -0.6), (-1, 0.6), (blade, 0.15 * s + 0.1), (blade, 0.15 * s - 0.1)])
        halves += [eye, arm, rotate(cut, s * open_ / 2, origin=(0, 0))]
    return slab(joined(*halves), rng.uniform(0.5, 1.0), pieces=13)


@family("office", 8, 14)
def mouse(rng: np.random.Generator) -> Solid:
    """A computer mouse."""
    length, w, h = rng.uniform(9, 12), rng.uniform(5, 7), rng.uniform(2.8, 4.5)
    lift = rng.uniform(-0.12, 0.12) * length
    sections = [(0, 1.0), (0.3, 1.02), (0.65, 0.85), (0.9, 0.5), (1.0, 0.2)]
    return loft([Section(h * z, length / 2 * s, w / 2 * s, 2.6, x=lift * z) for z, s in sections], 4)


@family("office", 12, 20)
def remote(rng: np.random.Generator) -> Solid:
    """A remote control or a handset: a long rounded bar, slim in the middle or at one end."""
    z = np.linspace(0, 1, 9)
    waist, taper = rng.uniform(0, 0.3), rng.uniform(-0.25, 0.25)
    w, t = rng.uniform(1.8, 2.8), rng.uniform(0.7, 1.4)
    width = w * (1 - waist * np.sin(np.pi * z) + taper * (z - 0.5))
    return loft([Section(16 * s, float(a), t, 4.5) for s, a in zip(z, width, strict=True)], 4).turned("y", 90)


@family("office", 9, 20)
def book(rng: np.random.Generator) -> Solid:
    """A closed book or notebook, with a rounded spine."""
    w, h, t = rng.uniform(6, 11), rng.uniform(9, 16), rng.uniform(0.8, 4)
    spine = cylinder(t / 2, h).turned("x", 90).at(x=-w / 2, y=h / 2)
    return box(w, h, t, 0.05) + spine


@family("office", 6, 14)
def tape_dispenser(rng: np.random.Generator) -> Solid:
    """A weighted block with a roll and a cutter's nose."""
    length, w, r = rng.uniform(10, 14), rng.uniform(2.5, 4.5), rng.uniform(2.6, 3.6)
    base = hull(
        [[-length / 2, s * w / 2, z] for s in (-1, 1) for z in (0, 3.0)],
        [[length / 2, s * w / 2, z] for s in (-1, 1) for z in (0, 2.4)],
        [[length * 0.2, s * w / 2, 1.6] for s in (-1, 1)],
    ).dense(2.0)
    roll = cylinder(r, w * 0.7, 0.1).turned("x", 90).at(x=-length * 0.15, y=w * 0.35, z=r * 0.6 + 1.4)
    return base + roll + box(0.6, w, 1.8).at(x=length / 2 - 0.3, z=2.6)


@family("office", 6, 12)
def stamp(rng: np.random.Generator) -> Solid:
    """A foot and a turned knob."""
    r, w = rng.uniform(1.2, 1.9), rng.uniform(3, 7)
    foot = box(w, rng.uniform(2.5, 4.5), 1.6, 0.15).at(z=0.8)
    line = [(r * 0.8, 1.5), (r * 0.45, 3), (r * 0.5, 4), (r, 5.6), (r * 0.8, 6.6), (0.3, 7)]
    return foot + lathe(line, 5)


@family("office", 8, 16)
def glasses_case(rng: np.random.Generator) -> Solid:
    """A long pebble: cases, soap, stones, computer speakers."""
    z = np.linspace(-1, 1, 11)
    n = rng.uniform(2.2, 4)
    size = np.clip(1 - np.abs(z) ** rng.uniform(2, 4), 0.04, 1) ** 0.5
    x, y, h = 8.0, rng.uniform(3, 6.5), rng.uniform(1.4, 3.4)
    return loft(
        [
            Section(h * float(t), x * (0.4 + 0.6 * float(s)), y * (0.4 + 0.6 * float(s)), n)
            for t, s in zip(z, size, strict=True)
        ],
        4,
    )
