"""Hand tools."""

from __future__ import annotations

import numpy as np

from grasp_core.objects.parametric.family import family
from grasp_core.objects.parametric.solids import Section, Solid, box, cylinder, hull, loft


def grip(rng: np.random.Generator, length: float, thick: float, slices: int = 3) -> Solid:
    """A handle along x from 0 to `length`: round, oval or squarish, straight or swelling."""
    n, oval = (2.0, rng.uniform(0.7, 1.0)) if rng.random() < 0.65 else (4.0, rng.uniform(0.6, 1.0))
    z = np.linspace(0, 1, 9)
    swell = 1 + rng.uniform(-0.12, 0.3) * np.sin(np.pi * z) + rng.uniform(-0.2, 0.25) * (z - 0.5)
    swell[0] *= 0.85
    swell[-1] *= 0.85
    return loft(
        [Section(length * t, thick * w, thick * w * oval, n) for t, w in zip(z, swell, strict=True)], slices
    ).turned("y", 90)


@family("tools", 13, 20)
def hammer(rng: np.random.Generator) -> Solid:
    """A hammer whose head is of denser stuff than its handle; with a peen, a claw or two faces."""
    length, thick = rng.uniform(13, 20), rng.uniform(0.75, 1.25)
    wide, side = rng.uniform(5, 9), rng.uniform(1.6, 2.8)
    head = box(side, wide * 0.55, side, 0.2)
    face = cylinder(side * 0.55, wide * 0.3, 0.15).turned("x", 90).at(y=-wide * 0.22)
    kind = rng.integers(3)
    if kind == 0:
        rest = face.turned("z", 180)
    elif kind == 1:
        y0, y1 = wide * 0.25, wide * 0.62
        w = side / 2
        rest = hull(
            [[sx * w, y0, sz * w] for sx in (-1, 1) for sz in (-1, 1)],
            [[-w, y1, 0.15], [w, y1, 0.15], [-w, y1, -0.15], [w, y1, -0.15]],
        )
    else:
        rest = _claw(wide, side)
    handle = grip(rng, length, thick).at(x=-length)
    return handle + (head + face + rest).dense(rng.uniform(2.0, 4.0)).at(x=side * 0.3)


def _claw(wide: float, side: float) -> Solid:
    w, drop = side / 2, side * 0.45
    prongs = []
    for sign in (-1, 1):
        near = [[sign * w * s, wide * 0.22, z * w * 0.8] for s in (0.12, 1) for z in (-1, 1)]
        far = [[sign * w * s + 0, wide * 0.72, -drop + z] for s in (0.35, 0.9) for z in (-0.12, 0.12)]
        prongs.append(hull(near, far))
    return (prongs[0] + prongs[1]).turned("y", 90)
