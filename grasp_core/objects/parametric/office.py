"""Things from desk and drawer."""

from __future__ import annotations

import numpy as np

from grasp_core.objects.parametric.family import family
from grasp_core.objects.parametric.outlines import rectangle, slab
from grasp_core.objects.parametric.solids import Section, Solid, box, cylinder, lathe, loft


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
