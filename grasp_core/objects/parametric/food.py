"""Fruit, vegetables and baked goods."""

from __future__ import annotations

import math

import numpy as np

from grasp_core.objects.parametric.family import family
from grasp_core.objects.parametric.solids import Section, Solid, ball, curve, cylinder, hull, lathe, loft, tube


@family("fruit", 12, 20)
def banana(rng: np.random.Generator) -> Solid:
    """A bent fruit, thick in the middle, with a stem."""
    bend, length, thick = rng.uniform(0.6, 1.6), 16.0, rng.uniform(1.4, 2.1)
    t = np.linspace(-0.5, 0.5, 25)
    radius = length / bend
    path = np.c_[radius * np.sin(bend * t), np.zeros(25), radius * (1 - np.cos(bend * t))]
    s = np.linspace(0, 1, 25)
    body = np.clip(np.sin(np.pi * (0.06 + 0.9 * s)) ** 0.55, 0.22, 1)
    body[:3] = [0.3, 0.3, 0.42]
    return tube(path, thick * body, rng.uniform(0.85, 1.05), pieces=7, n=rng.uniform(2, 2.6), up=(0, 1, 0))


@family("food", 7, 14)
def donut(rng: np.random.Generator) -> Solid:
    """A ring; the hole small to wide."""
    ring, thick = 4.0, rng.uniform(1.0, 2.6)
    t = np.linspace(0, 2 * math.pi, 40, endpoint=False)
    return tube(np.c_[ring * np.cos(t), ring * np.sin(t), 0 * t], thick, rng.uniform(0.75, 1.1), pieces=12, closed=True)


@family("food", 10, 17)
def croissant(rng: np.random.Generator) -> Solid:
    """A crescent, thick in the middle."""
    bend = rng.uniform(1.6, 2.8)
    t = np.linspace(-0.5, 0.5, 25)
    path = curve(np.c_[10 / bend * np.sin(bend * t), 10 / bend * (1 - np.cos(bend * t)), 0 * t], 25)
    body = 0.35 + np.cos(np.pi * t) ** 0.8 * (1 + 0.06 * np.sign(np.sin(22 * t)))
    return tube(path, body * rng.uniform(1.5, 2.1), rng.uniform(0.75, 1.0), pieces=6)


def _arch(rng: np.random.Generator, points: list[tuple[float, float]], dent: float = 0.0, slices: int = 6) -> Solid:
    """A fruit turned about z through (radius, z) points, dented at both ends and a little lop-sided."""
    line = curve(points, 24)
    skew = rng.uniform(-0.12, 0.12)
    top = float(line[-1, 1])
    sections = [Section(float(z), max(float(r), 0.02), x=skew * float(z)) for r, z in line]
    fruit = loft(sections, slices)
    if dent > 0:
        fruit = fruit.carved(ball(dent, dent, dent * 0.7).at(x=skew * top, z=top + dent * 0.15))
    return fruit


@family("fruit", 6, 10)
def apple(rng: np.random.Generator) -> Solid:
    """A round fruit, dented on top, with a stem."""
    tall, narrow = rng.uniform(0.8, 1.15), rng.uniform(0.55, 0.85)
    h = 7 * tall
    points = [(1.0, 0), (narrow * 2.6, 0.1 * h), (3.7, 0.55 * h), (2.6, 0.93 * h), (0.8, h)]
    fruit = _arch(rng, points, rng.uniform(0.7, 1.0), 5)
    return fruit + tube([[0, 0, h - 1.2], [0.1, 0, h], [0.4, 0, h + 0.8]], 0.22, pieces=1, up=(0, 1, 0))


@family("fruit", 8, 14)
def pear(rng: np.random.Generator) -> Solid:
    """A pear: a belly and a neck."""
    h, neck = rng.uniform(8.5, 11.5), rng.uniform(1.1, 1.9)
    points = [(0.8, 0), (2.9, 0.1 * h), (3.6, 0.32 * h), (neck + 0.5, 0.65 * h), (neck, 0.85 * h), (0.4, h)]
    return _arch(rng, points) + tube(
        [[0, 0, h * 0.5], [0.1, 0, h * 0.8], [0.5, 0, h + 0.9]], 0.25, pieces=2, up=(0, 1, 0)
    )


@family("fruit", 6, 11)
def lemon(rng: np.random.Generator) -> Solid:
    """A lemon with its two tips."""
    h, r = rng.uniform(7, 10), rng.uniform(2.3, 3.2)
    tip = rng.uniform(0.5, 0.9)
    line = curve(
        [
            (0.2, 0),
            (tip, 0.07 * h),
            (r * 0.85, 0.28 * h),
            (r, 0.5 * h),
            (r * 0.85, 0.75 * h),
            (tip, 0.95 * h),
            (0.2, h),
        ],
        24,
    )
    return lathe(line, 5).turned("y", 90)


@family("fruit", 7, 12)
def avocado(rng: np.random.Generator) -> Solid:
    """A drop."""
    h = rng.uniform(9, 12)
    points = [(0.5, 0), (2.6, 0.1 * h), (3.3, 0.36 * h), (rng.uniform(1.7, 2.4), 0.75 * h), (0.5, h)]
    return _arch(rng, points).turned("y", 90)


@family("fruit", 6, 9, stretch=0.1)
def orange(rng: np.random.Generator) -> Solid:
    """A ball, near enough: oranges, balls, plums, melons."""
    return ball(3.5, 3.5 * rng.uniform(0.9, 1.1), 3.5 * rng.uniform(0.8, 1.15))


@family("food", 6, 9)
def egg(rng: np.random.Generator) -> Solid:
    """An egg."""
    h = rng.uniform(5.5, 7.5)
    blunt = rng.uniform(0.3, 0.45)
    points = [(0.4, 0), (2.0, 0.12 * h), (2.4, blunt * h), (1.7, 0.78 * h), (0.3, h)]
    return _arch(rng, points, slices=5).turned("y", 90)


@family("vegetable", 12, 20)
def carrot(rng: np.random.Generator) -> Solid:
    """A long taper with a tuft."""
    length, thick = 16.0, rng.uniform(1.1, 2.2)
    z = np.linspace(0, 1, 14)
    bend = rng.uniform(-1.2, 1.2)
    path = np.c_[length * z, bend * np.sin(np.pi * z), 0 * z]
    root = tube(path, thick * np.clip(0.12 + 0.88 * (1 - (1 - z) ** 2) ** 0.7, 0.1, 1), pieces=5)
    return root + lathe([(0.5, 0), (0.8, 0.8), (0.4, rng.uniform(1.5, 3))], 2).turned("y", 90).at(x=length - 0.2)


@family("vegetable", 10, 20)
def cucumber(rng: np.random.Generator) -> Solid:
    """A bent rod with round ends: cucumbers, aubergines, sausages, baguettes."""
    z = np.linspace(0, 1, 25)
    bend, thick, drop = rng.uniform(-2, 2), rng.uniform(1.2, 2.8), rng.uniform(0.0, 0.45)
    profile = np.clip(1 - np.abs(2 * z - 1) ** rng.uniform(4, 9), 0.05, 1) ** 0.5 * (1 - drop * (1 - z))
    path = np.c_[14 * z, bend * np.sin(np.pi * z), 0 * z]
    return tube(path, thick * profile, rng.uniform(0.8, 1.0), pieces=6)


@family("vegetable", 6, 12)
def mushroom(rng: np.random.Generator) -> Solid:
    """A cap on a stem."""
    r, h = rng.uniform(2.5, 4.5), rng.uniform(3, 6)
    stem = lathe([(rng.uniform(0.9, 1.6), 0), (rng.uniform(0.8, 1.2), h)], 2)
    t = np.linspace(0, np.pi / 2, 9)
    cap = lathe([(r * 0.8, -0.25 * r), *zip(r * np.cos(t), rng.uniform(0.5, 0.9) * r * np.sin(t), strict=True)], 4)
    return stem + cap.at(z=h)


@family("vegetable", 7, 13)
def pepper(rng: np.random.Generator) -> Solid:
    """A bell pepper: blocky, narrowing, with a stalk."""
    h, n = rng.uniform(7, 10), rng.uniform(2.4, 3.2)
    line = curve([(1.8, 0), (2.6, 0.12 * h), (rng.uniform(3, 3.6), 0.7 * h), (2.6, 0.95 * h), (1.0, h)], 16)
    body = loft([Section(float(z), float(r), float(r) * 0.92, n) for r, z in line], 5)
    return body + cylinder(0.5, 1.8, 0.1).at(z=h - 0.3)


@family("food", 9, 20)
def loaf(rng: np.random.Generator) -> Solid:
    """A loaf: long or square, domed on top."""
    w, length, h = rng.uniform(3, 5.5), rng.uniform(5, 12), rng.uniform(2, 5)
    base = loft([Section(0, length, w, 5), Section(h, length * 1.03, w * 1.05, 5)], 1)
    dome = [
        Section(h + rng.uniform(1.5, 3) * s, length * 1.05 * c, w * 1.08 * c, 4)
        for s, c in ((0, 1), (0.6, 0.9), (1, 0.6))
    ]
    return base + loft(dome, 2)


@family("food", 8, 14)
def ice_cream(rng: np.random.Generator) -> Solid:
    """A cone with one or two scoops."""
    h, r = rng.uniform(8, 11), rng.uniform(2.2, 3.2)
    cone = lathe([(0.25, 0), (r, h)], 1)
    ice = ball(r * 1.12).at(z=h + 0.25 * r)
    if rng.random() < 0.5:
        ice = ice + ball(r * 0.95).at(x=rng.uniform(-0.4, 0.4), z=h + 1.6 * r)
    return cone + ice


@family("food", 6, 14)
def wedge(rng: np.random.Generator) -> Solid:
    """A piece of cheese, cake or melon."""
    angle, r, h = rng.uniform(25, 75), rng.uniform(6, 10), rng.uniform(2, 7)
    t = np.radians(np.linspace(0, angle, 7))
    arc = [(r * math.cos(a), r * math.sin(a)) for a in t]
    flat = [(0.0, 0.0), *arc]
    tip = rng.uniform(0.6, 1.0)
    return hull([(x, y, 0) for x, y in flat], [(x * tip, y * tip, h) for x, y in flat])
