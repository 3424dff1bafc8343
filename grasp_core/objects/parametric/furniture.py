"""Doll's-house furniture and the like: thin legs, tops and shades, as sets of larger objects have them."""

from __future__ import annotations

import numpy as np

from grasp_core.objects.parametric.family import family
from grasp_core.objects.parametric.shells import shell
from grasp_core.objects.parametric.solids import Section, Solid, box, curve, cylinder, hull, lathe, loft, tube


def _legs(rng: np.random.Generator, x: float, y: float, height: float, thick: float) -> Solid:
    """Four legs below z = 0 at (±x, ±y), upright or splayed, round or square."""
    splay, round_ = rng.uniform(0.0, 0.2), rng.random() < 0.5
    legs = []
    for sx in (-1, 1):
        for sy in (-1, 1):
            top, foot = np.array([sx * x, sy * y, 0.3]), np.array([sx * x * (1 + splay), sy * y * (1 + splay), -height])
            n = 2.0 if round_ else 8.0
            legs.append(tube([foot, (foot + top) / 2, top], thick, pieces=1, n=n, up=(0, 1, 0)))
    return legs[0] + legs[1] + legs[2] + legs[3]


@family("furniture", 9, 20)
def chair(rng: np.random.Generator) -> Solid:
    """A seat, four legs and a back; sometimes arms."""
    w, d, leg, back = rng.uniform(2.2, 3.2), rng.uniform(2.2, 3), rng.uniform(3.5, 5.5), rng.uniform(4, 7)
    t = rng.uniform(0.25, 0.6)
    shape = box(2 * d, 2 * w, 2 * t, 0.15) + _legs(rng, d - t, w - t, leg, rng.uniform(0.3, 0.55))
    lean = rng.uniform(0, 0.2) * back
    low = [[-d + x, s * w, 0] for s in (-1, 1) for x in (0, 2 * t)]
    high = [[-d - lean + x, s * w * rng.uniform(0.8, 1), back] for s in (-1, 1) for x in (0, 1.4 * t)]
    shape = shape + hull(low, high)
    if rng.random() < 0.35:
        for s in (-1, 1):
            y = s * (w - 0.2)
            shape = shape + box(2 * d, 0.8, 0.6).at(y=y, z=2.4) + box(0.7, 0.7, 2.6).at(d - 0.6, y, 1.2)
    return shape


@family("furniture", 8, 19)
def stool(rng: np.random.Generator) -> Solid:
    """A round or square seat on legs or on a column."""
    r, leg, t = rng.uniform(2, 3.5), rng.uniform(4, 9), rng.uniform(0.4, 1.0)
    seat = cylinder(r, t, 0.1) if rng.random() < 0.6 else box(2 * r, 2 * r, t, 0.1).at(z=t / 2)
    if rng.random() < 0.65:
        return seat + _legs(rng, r * 0.62, r * 0.62, leg, rng.uniform(0.3, 0.5))
    return seat + cylinder(0.5, leg + 0.2).at(z=-leg) + cylinder(r * rng.uniform(0.7, 1.0), 0.5, 0.1).at(z=-leg)


@family("furniture", 9, 20)
def table(rng: np.random.Generator) -> Solid:
    """A square or oval top on four legs."""
    x, y, leg, t = rng.uniform(4, 7), rng.uniform(2.5, 5), rng.uniform(3, 7), rng.uniform(0.4, 0.9)
    square = rng.random() < 0.7
    top = box(2 * x, 2 * y, t, 0.1) if square else loft([Section(-t / 2, x, y), Section(t / 2, x, y)], 1)
    inset = 0.85 if square and rng.random() < 0.7 else 0.55
    return top + _legs(rng, x * inset, y * inset, leg, rng.uniform(0.3, 0.6))


@family("furniture", 10, 20)
def lamp(rng: np.random.Generator) -> Solid:
    """A foot, a column and a shade (closed or hollow)."""
    foot, h, r = rng.uniform(1.8, 3.2), rng.uniform(6, 11), rng.uniform(2.4, 4.2)
    column = lathe([(foot, 0), (foot, 0.6), (0.55, 1.1), (0.5, h + 2.8)], 3)
    deep, slope = rng.uniform(3, 5), rng.uniform(0.45, 0.95)
    if rng.random() < 0.5:
        return column + lathe([(r, h), (r * slope, h + deep)], 1)
    shade = shell([Section(0, r * slope), Section(deep / 2, r * (1 + slope) / 2), Section(deep, r)], 0.3, 0.5)
    return column + shade.turned("x", 180).at(z=h + 3.1)


@family("furniture", 9, 18)
def bathtub(rng: np.random.Generator) -> Solid:
    """An open tub, oval or square."""
    a, b, h, n = 7.0, rng.uniform(3, 4.2), rng.uniform(3, 5), rng.uniform(2, 5)
    skin = [Section(0, a * 0.8, b * 0.75, n), Section(h * 0.5, a * 0.93, b * 0.92, n), Section(h, a, b, n)]
    return shell(skin, rng.uniform(0.3, 0.6), 0.6, levels=2)


@family("furniture", 9, 18)
def flower_pot(rng: np.random.Generator) -> Solid:
    """A pot, open, or with a plant in it."""
    r, h, foot = rng.uniform(3, 4.5), rng.uniform(4, 8), rng.uniform(0.55, 0.85)
    pot = shell([Section(0, r * foot), Section(h * 0.8, r * 0.92), Section(h, r)], rng.uniform(0.4, 0.8), 0.8)
    if rng.random() < 0.5:
        return pot
    plant = cylinder(0.6, h + rng.uniform(1, 4)).at(z=0.3)
    for _ in range(3):
        end = np.array([*rng.uniform(-3.5, 3.5, 2), h + rng.uniform(3, 7)])
        start = np.array([0, 0, h * 0.6])
        plant = plant + tube([start, (start + end) / 2, end], [0.5, 0.9, 0.3], 0.6, pieces=2, up=(0.3, 1, 0.1))
    return pot + plant


@family("furniture", 10, 20)
def bed(rng: np.random.Generator) -> Solid:
    """A mattress, a headboard, feet and a pillow; or a sofa."""
    x, y, t = 7.0, rng.uniform(3, 5.5), rng.uniform(1.4, 2.6)
    shape = box(2 * x, 2 * y, t, 0.3) + box(0.8, 2 * y, rng.uniform(3.5, 6)).at(x=-x, z=1.2)
    if rng.random() < 0.6:
        shape = shape + box(0.7, 2 * y, rng.uniform(2, 4)).at(x=x, z=0.4)
    if rng.random() < 0.5:
        shape = shape + box(2.6, 1.5 * y, 1.0, 0.4).at(x=-x + 2.4, z=t / 2 + 0.3)
    return shape + _legs(rng, x * 0.9, y * 0.85, t / 2 + rng.uniform(0.6, 2), 0.4)


@family("furniture", 9, 19)
def sofa(rng: np.random.Generator) -> Solid:
    """A seat, a back and two arms."""
    w, d, h = rng.uniform(4, 8), rng.uniform(2.5, 3.5), rng.uniform(1.6, 2.6)
    arm = rng.uniform(0.7, 1.4)
    shape = box(2 * d, 2 * w, h, 0.2) + box(1.4, 2 * w, rng.uniform(3, 5), 0.3).at(x=-d + 0.5, z=h)
    for s in (-1, 1):
        shape = shape + box(2 * d, arm, rng.uniform(2.2, 3.2), 0.2).at(y=s * (w - arm / 2 + 0.1), z=h * 0.5)
    return shape


@family("furniture", 9, 19)
def shelf(rng: np.random.Generator) -> Solid:
    """Boards between two sides, with or without a back."""
    w, h, d, t = rng.uniform(3, 6), rng.uniform(7, 12), rng.uniform(1.3, 2.4), rng.uniform(0.4, 0.7)
    shape = box(2 * d, t, h).at(y=w)
    boards = int(rng.integers(2, 5))
    for k in range(boards):
        shape = shape + box(2 * d, 2 * w, t).at(z=-h / 2 + t / 2 + (h - t) * k / (boards - 1))
    shape = shape + box(2 * d, t, h).at(y=-w)
    return shape + box(0.4, 2 * w, h).at(x=-d + 0.2) if rng.random() < 0.4 else shape


@family("furniture", 9, 19)
def guitar(rng: np.random.Generator) -> Solid:
    """A waisted body and a long neck: guitars, paddles, spoons, ladles."""
    r, neck = rng.uniform(2.2, 3.4), rng.uniform(7, 11)
    t = rng.uniform(0.8, 2)
    low = loft([Section(0, r, r * 0.95), Section(t, r, r * 0.95)], 1)
    high = loft([Section(0, r * 0.75, r * 0.7), Section(t, r * 0.75, r * 0.7)], 1).at(x=r * 1.1)
    path = curve([(r, 0, t * 0.7), (r + neck * 0.6, 0, t * 0.7), (r + neck, 0, t * 0.5)], 10)
    return low + high + tube(path, 0.55, 0.7, pieces=2, up=(0, 1, 0))
