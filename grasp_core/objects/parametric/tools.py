"""Hand tools."""

from __future__ import annotations

import numpy as np
from shapely.affinity import rotate
from shapely.geometry import Polygon

from grasp_core.objects.parametric.family import family
from grasp_core.objects.parametric.outlines import circle, joined, rectangle, slab, strip
from grasp_core.objects.parametric.solids import Section, Solid, box, curve, cylinder, hull, lathe, loft, tube


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


@family("tools", 12, 20)
def screwdriver(rng: np.random.Generator) -> Solid:
    """A swelling handle and a thin, denser shaft."""
    length, thick = rng.uniform(7, 11), rng.uniform(1.1, 1.8)
    shaft = rng.uniform(5, 11)
    rod = cylinder(rng.uniform(0.25, 0.45), shaft).turned("y", 90).at(x=length - 0.3)
    return grip(rng, length, thick, 4) + rod.dense(4.0)


@family("tools", 13, 20)
def wrench(rng: np.random.Generator) -> Solid:
    """An open-ended spanner, with a ring on the other end or a second jaw."""
    jaw, neck = rng.uniform(1.6, 2.6), rng.uniform(0.7, 1.2)
    length = 16.0
    slot = rectangle(jaw * 1.6, jaw * 0.95, x=-jaw * 0.75)
    head = circle(jaw).difference(rotate(slot, rng.uniform(-25, 25), origin=(0, 0)))
    shapes = [head, rectangle(length - jaw, neck * 2, x=length / 2 + jaw * 0.25)]
    other = rng.uniform(1.2, 2.2)
    if rng.random() < 0.6:
        outline = joined(*shapes, circle(other, length)).difference(circle(other * 0.55, length))
    else:
        outline = joined(*shapes, circle(other, length)).difference(
            rectangle(other * 1.6, other * 0.9, x=length + other * 0.8)
        )
    return slab(outline, rng.uniform(0.6, 1.2), pieces=8, bevel=0.1)


@family("tools", 12, 20)
def pliers(rng: np.random.Generator) -> Solid:
    """Two bent handles, a joint and a jaw."""
    spread, jaw, w = rng.uniform(1.0, 2.2), rng.uniform(2.5, 5), rng.uniform(0.9, 1.4)
    nose = Polygon([(-1.2, -1), (-1.2, 1), (0, 1.3), (jaw, rng.uniform(0.25, 0.8)), (jaw, -0.4), (0, -1.3)])
    arms = [
        strip(curve([(-0.5, s * 0.3), (-4, s * spread), (-8, s * spread * 1.05), (-11, s * spread * 0.8)], 12), w)
        for s in (-1, 1)
    ]
    return slab(joined(nose, circle(1.5), *arms), rng.uniform(0.9, 1.5), pieces=9, bevel=0.12)


@family("tools", 13, 20)
def mallet(rng: np.random.Generator) -> Solid:
    """A big head, round or square, on a handle."""
    length, head = rng.uniform(11, 17), rng.uniform(5, 10)
    r = rng.uniform(1.7, 3)
    block = (
        cylinder(r, head, 0.25).turned("x", 90).at(y=head / 2) if rng.random() < 0.6 else box(2 * r, head, 1.6 * r, 0.3)
    )
    return grip(rng, length, rng.uniform(0.8, 1.2)).at(x=-length) + block.dense(rng.uniform(0.6, 2)).at(x=r * 0.5)


@family("tools", 13, 20)
def axe(rng: np.random.Generator) -> Solid:
    """A hatchet: a wedge of a blade on one side of the handle."""
    length, blade, reach = rng.uniform(13, 18), rng.uniform(3.5, 7), rng.uniform(3.5, 6)
    thick = rng.uniform(1.2, 2)
    head = hull(
        [[sx * 1.3, -1.2, sz * thick / 2] for sx in (-1, 1) for sz in (-1, 1)],
        [[sx * blade / 2, reach, sz * 0.1] for sx in (-1, 1) for sz in (-1, 1)],
    )
    return grip(rng, length, rng.uniform(0.75, 1.1)).at(x=-length) + head.dense(3.0).at(x=0.6)


@family("tools", 12, 20)
def chisel(rng: np.random.Generator) -> Solid:
    """A handle and a flat blade: chisels, files, knives, scrapers."""
    length, blade = rng.uniform(7, 10), rng.uniform(5, 10)
    w, t = rng.uniform(0.5, 1.6), rng.uniform(0.12, 0.35)
    flat = box(blade, 2 * w, 2 * t, 0.05).at(x=length + blade / 2 - 0.4)
    end = hull(
        [[length + blade - 0.5, sy * w, sz * t] for sy in (-1, 1) for sz in (-1, 1)],
        [[length + blade + 0.8, sy * w * rng.uniform(0.2, 1), -t] for sy in (-1, 1)],
    )
    return grip(rng, length, rng.uniform(0.9, 1.5)) + (flat + end).dense(3.0)


@family("tools", 10, 20)
def paintbrush(rng: np.random.Generator) -> Solid:
    """A handle, a ferrule and flat bristles."""
    length, w = rng.uniform(7, 12), rng.uniform(1.2, 4)
    brush = [Section(0, w, 0.9, 6), Section(2.2, w, 0.9, 6), Section(2.2 + rng.uniform(2.5, 5), w * 0.95, 0.45, 6)]
    return grip(rng, length, rng.uniform(0.7, 1.1)) + loft(brush, 2).turned("y", 90).at(x=length - 0.3)


@family("tools", 7, 14)
def tape_roll(rng: np.random.Generator) -> Solid:
    """A ring: a roll of tape, a bangle, a bearing."""
    outer, inner, h = 5.0, rng.uniform(1.2, 4.3), rng.uniform(1, 6)
    return ring(outer, inner, h)


def ring(outer: float, inner: float, height: float, count: int = 12) -> Solid:
    """A flat ring about z on z = 0; its parts are sectors."""
    seen = cylinder(outer, height).body - cylinder(inner, height + 2).at(z=-1).body
    parts = []
    for k in range(count):
        t = (k + np.array([0, 0.5, 1])) * 2 * np.pi / count
        out = outer * 1.006 * np.c_[np.cos(t), np.sin(t)]
        near = inner * 1.015 * np.c_[np.cos(t[[0, 2]]), np.sin(t[[0, 2]])]
        flat = np.concatenate([out, near])
        parts.append(np.concatenate([np.c_[flat, np.full(5, z)] for z in (0.0, height)]))
    return Solid.of(seen, parts)


@family("tools", 10, 20)
def flashlight(rng: np.random.Generator) -> Solid:
    """A tube with a wider head."""
    r, head, length = rng.uniform(1.1, 1.8), rng.uniform(1.6, 3), rng.uniform(9, 15)
    line = [(r, 0), (r, length * 0.68), (head, length * 0.8), (head, length)]
    return lathe(line, 4).turned("y", 90)


@family("tools", 10, 18)
def clamp(rng: np.random.Generator) -> Solid:
    """A G-clamp: a C-shaped frame and a screw."""
    w, h, t = rng.uniform(5, 8), rng.uniform(6, 10), rng.uniform(0.9, 1.5)
    frame = rectangle(w, h, 0.8).difference(rectangle(w, h - 2 * t, 0.5, x=t))
    body = slab(frame, rng.uniform(1.2, 2), pieces=6)
    screw = cylinder(0.45, h * 0.8).turned("x", 90).at(x=w / 2 - 1, y=h * 0.1)
    bar = cylinder(0.3, 3).turned("y", 90).at(x=w / 2 - 2.5, y=-h * 0.66)
    return body + screw + bar


@family("tools", 11, 20)
def trowel(rng: np.random.Generator) -> Solid:
    """A pointed or square blade on a cranked neck."""
    length, w, reach = rng.uniform(7, 10), rng.uniform(2, 4), rng.uniform(6, 10)
    tip = rng.uniform(0.1, 1.0) * w
    t = 0.25
    low = rng.uniform(1, 2.5)
    blade = hull(
        [[0, sy * w, sz * t] for sy in (-1, 1) for sz in (-1, 1)],
        [[reach, sy * tip, sz * t] for sy in (-1, 1) for sz in (-1, 1)],
    )
    neck = tube(curve([(-0.3, 0, low), (1.5, 0, low), (2.2, 0, 0.1)], 10), 0.4, pieces=3, up=(0, 1, 0))
    return grip(rng, length, 1.1).at(x=-length, z=low) + (blade.at(x=1.2) + neck).dense(2.0)


@family("tools", 10, 18)
def drill(rng: np.random.Generator) -> Solid:
    """A pistol shape: cordless drills, glue guns, hair dryers, spray heads."""
    r, length, grip_h = rng.uniform(1.8, 2.8), rng.uniform(8, 12), rng.uniform(6, 9)
    barrel = lathe([(r * 0.8, 0), (r, 1), (r, length * 0.7), (r * 0.55, length * 0.8), (0.5, length)], 4).turned(
        "y", 90
    )
    rake = rng.uniform(-0.1, 0.35) * grip_h
    hand = tube([[r + 0.4, 0, 0], [r + 0.4 - rake, 0, -grip_h]], r * 0.62, 0.8, n=3.5, up=(0, 1, 0))
    foot = box(rng.uniform(3, 6), 2 * r * 0.8, 1.8, 0.3).at(x=r + 0.8 - rake, z=-grip_h)
    return barrel + hand + (foot if rng.random() < 0.6 else foot.scaled(0.6).at(z=-grip_h * 0.4))
