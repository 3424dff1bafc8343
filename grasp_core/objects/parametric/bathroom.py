"""Things of the bathroom."""

from __future__ import annotations

import numpy as np

from grasp_core.objects.parametric.family import family
from grasp_core.objects.parametric.shells import shell
from grasp_core.objects.parametric.solids import Section, Solid, box, curve, cylinder, hull, lathe, loft, tube
from grasp_core.objects.parametric.tools import ring


@family("bathroom", 13, 19)
def toothbrush(rng: np.random.Generator) -> Solid:
    """A slim bent handle with a brush."""
    bend, r = rng.uniform(-0.8, 0.8), rng.uniform(0.4, 0.75)
    z = np.linspace(0, 1, 14)
    path = np.c_[16 * z, 0 * z, bend * np.sin(np.pi * z)]
    body = tube(path, r * np.interp(z, [0, 0.3, 0.65, 0.8, 1], [0.8, 1.1, 0.6, 0.5, 0.85]), 0.7, pieces=5)
    return body + box(2.6, 1.0, 1.1, 0.1).at(x=14.8, z=0.6)


@family("bathroom", 7, 12, stretch=0.1)
def soap(rng: np.random.Generator) -> Solid:
    """A bar of soap: from a pillow to a rounded brick."""
    return box(8, rng.uniform(4, 6), rng.uniform(1.8, 3.2), rng.uniform(0.6, 1.5))


@family("bathroom", 12, 20)
def tube_of_paste(rng: np.random.Generator) -> Solid:
    """A squeezed tube: round at its cap, flat at its end."""
    r, length = rng.uniform(1.5, 2.4), rng.uniform(10, 15)
    body = [Section(0, 0.15, r * 1.35, 3), Section(length * 0.35, r * 0.7, r * 1.15, 2.2), Section(length, r, r)]
    cap = cylinder(r * rng.uniform(0.5, 1.0), rng.uniform(1, 2.5), 0.1).at(z=length - 0.1)
    return (loft(body, 3) + cap).turned("y", 90)


@family("bathroom", 12, 20)
def pump_bottle(rng: np.random.Generator) -> Solid:
    """A bottle with a pump and its spout."""
    r, h, n = rng.uniform(2.8, 4), rng.uniform(9, 14), (2.0 if rng.random() < 0.5 else 4.0)
    ratio = rng.uniform(0.6, 1.0)
    body = [Section(z, r * s, r * s * ratio, n) for z, s in ((0, 0.95), (0.5, 1), (h * 0.85, 1), (h, 0.45))]
    neck = lathe([(1.2, h - 0.2), (1.2, h + 1.2), (0.5, h + 1.25), (0.5, h + 3)], 3)
    spout = box(rng.uniform(3, 5), 1.1, 0.9, 0.2).at(x=1.2, z=h + 3.2)
    return loft(body, 3) + neck + spout


@family("bathroom", 8, 13)
def paper_roll(rng: np.random.Generator) -> Solid:
    """A roll of toilet or kitchen paper, full to nearly used up."""
    return ring(rng.uniform(3, 6), rng.uniform(1.8, 2.6), rng.uniform(7, 13))


@family("bathroom", 7, 12)
def cream_jar(rng: np.random.Generator) -> Solid:
    """A flat tin or cream jar."""
    r, h = rng.uniform(3, 5), rng.uniform(1.6, 4)
    return cylinder(r, h, 0.3) + cylinder(r * rng.uniform(1.0, 1.06), h * 0.5, 0.15).at(z=h * 0.6)


@family("bathroom", 13, 20)
def hairbrush(rng: np.random.Generator) -> Solid:
    """A paddle or oval head on a handle, bristles as a block."""
    head, w = rng.uniform(5, 9), rng.uniform(1.8, 3.6)
    handle = tube(
        curve([(0, 0, 0), (5, 0, 0.3), (10, 0, 0)], 14), np.interp(np.arange(14), [0, 5, 13], [0.8, 1.0, 0.7]), pieces=3
    )
    paddle = loft([Section(z, head / 2, w, rng.uniform(2, 5)) for z in (-0.6, 0.6)], 1).at(x=9.5 + head / 2)
    bristles = loft([Section(0.5, head * 0.42, w * 0.8), Section(0.5 + rng.uniform(0.8, 1.8), head * 0.4, w * 0.75)], 1)
    return handle + paddle + bristles.at(x=9.5 + head / 2).dense(0.4)


@family("bathroom", 12, 17)
def razor(rng: np.random.Generator) -> Solid:
    """A handle with a head across it."""
    path = curve([(0, 0, 0), (5, 0, 0.6), (9, 0, 0.2), (11, 0, 1.2)], 16)
    handle = tube(
        path, np.interp(np.linspace(0, 1, 16), [0, 0.4, 1], [0.5, 0.75, 0.35]) * rng.uniform(0.9, 1.3), pieces=5
    )
    return handle + box(1.2, rng.uniform(3.5, 5), 0.7, 0.15).turned("y", -40).at(x=11.2, z=1.4)


@family("bathroom", 10, 16)
def soap_dish(rng: np.random.Generator) -> Solid:
    """An open tray, round or square: dishes, ashtrays, trays, drawers."""
    a, b, h, n = 6.0, rng.uniform(3.5, 6), rng.uniform(1.5, 4), rng.uniform(3.2, 10)
    flare = rng.uniform(0.8, 1.0)
    return shell(
        [Section(0, a * flare, b * flare, n), Section(h, a, b, n)], rng.uniform(0.3, 0.8), rng.uniform(0.3, 0.8)
    )


@family("bathroom", 12, 20)
def spray_bottle(rng: np.random.Generator) -> Solid:
    """A bottle with a trigger head."""
    r, h = rng.uniform(3, 4), rng.uniform(9, 12)
    ratio = rng.uniform(0.6, 0.9)
    body = [Section(0, r, r * ratio, 3), Section(h * 0.6, r, r * ratio, 3), Section(h, 1.4, 1.4)]
    head = box(rng.uniform(5, 7), 2, 2.2, 0.3).at(x=1.2, z=h + 2.6)
    trigger = hull(
        [[2.6, s * 0.4, h + 1.8] for s in (-1, 1)],
        [[1.8, s * 0.4, h + 1.8] for s in (-1, 1)],
        [[2.2, s * 0.4, h - 1] for s in (-1, 1)],
    )
    return loft(body, 3) + cylinder(1.2, 2.4).at(z=h - 0.3) + head + trigger
