"""Machine parts and building elements."""

from __future__ import annotations

import math

import numpy as np
from shapely.affinity import rotate
from shapely.ops import unary_union

from grasp_core.objects.parametric.family import family
from grasp_core.objects.parametric.outlines import circle, joined, rectangle, regular, slab
from grasp_core.objects.parametric.solids import Section, Solid, box, curve, cylinder, hull, lathe, loft, tube


@family("machine", 6, 11)
def nut(rng: np.random.Generator) -> Solid:
    """A big nut with four to eight sides."""
    outer, inner = 4.0, rng.uniform(1.6, 2.8)
    return slab(
        regular(int(rng.integers(4, 9)), outer).difference(circle(inner)), rng.uniform(1.5, 5), pieces=10, bevel=0.1
    )


@family("machine", 8, 18)
def bolt(rng: np.random.Generator) -> Solid:
    """A head on a shaft: bolts, screws, studs, nails."""
    r, length, head = rng.uniform(0.7, 1.5), rng.uniform(6, 12), rng.uniform(1.5, 2.4)
    shaft = cylinder(r, length)
    if rng.random() < 0.6:
        top = slab(regular(6, r * head), r * 1.2).at(z=length + r * 0.55)
    else:
        top = lathe([(r * head, length - 0.1), (r * head, length + r * 0.4), (r * head * 0.5, length + r)], 2)
    return (shaft + top).turned("y", 90)


@family("machine", 8, 16)
def gear(rng: np.random.Generator) -> Solid:
    """A cog wheel with a bore and, often, a hub."""
    teeth, r = int(rng.integers(6, 13)), 5.0
    tall, bore = rng.uniform(0.8, 1.4), rng.uniform(0.6, 1.6)
    tooth = rectangle(tall * 2, 2 * math.pi * r / teeth * 0.5, x=r + tall * 0.2)
    disc = unary_union([circle(r), *[rotate(tooth, 360 * k / teeth, origin=(0, 0)) for k in range(teeth)]])
    t = rng.uniform(1, 3)
    wheel = slab(disc.difference(circle(bore)), t, pieces=15)
    hub = slab(circle(bore * 2).difference(circle(bore)), t * rng.uniform(1.5, 3), pieces=5)
    return wheel + hub if rng.random() < 0.5 and bore < 1.2 else wheel


@family("machine", 9, 18)
def elbow(rng: np.random.Generator) -> Solid:
    """A bent pipe (closed) with collars."""
    r, arm = rng.uniform(1.4, 2.4), rng.uniform(4, 7)
    bend = math.radians(rng.uniform(45, 110))
    far = np.array([math.cos(bend), math.sin(bend)])
    ends = [(-arm, 0, 0), (-arm * 0.3, 0, 0), (0.3 * far[0] * arm, 0.3 * far[1] * arm, 0), (*(far * arm), 0)]
    path = curve(ends, 20)
    pipe = tube(path, r, pieces=6)
    collar = cylinder(r * 1.3, rng.uniform(1, 2)).turned("y", 90).at(x=-arm)
    return pipe + collar


@family("machine", 9, 18)
def tee(rng: np.random.Generator) -> Solid:
    """Pipes that meet: a tee, a cross, or a star of three."""
    r, arm = rng.uniform(1.1, 2.0), rng.uniform(4.5, 7)
    whole = cylinder(r, 2 * arm, 0.1).at(z=-arm).turned("y", 90)
    side = cylinder(r * rng.uniform(0.8, 1.0), arm, 0.1).turned("x", -90)
    shape = whole + side
    if rng.random() < 0.35:
        shape = shape + side.turned("z", 180)
    if rng.random() < 0.35:
        shape = shape + cylinder(r, arm, 0.1)
    return shape


@family("machine", 8, 18)
def bracket(rng: np.random.Generator) -> Solid:
    """An L, U, T, Z or H profile cut to a length."""
    t, a, b = rng.uniform(0.6, 1.6), rng.uniform(5, 8), rng.uniform(3.5, 7)
    shapes = [
        joined(rectangle(a, t), rectangle(t, b, x=-a / 2 + t / 2, y=b / 2 - t / 2)),
        joined(rectangle(a, t), *[rectangle(t, b, x=s * (a - t) / 2, y=b / 2 - t / 2) for s in (-1, 1)]),
        joined(rectangle(a, t), rectangle(t, b, y=b / 2)),
        joined(
            rectangle(t, b),
            rectangle(a / 2, t, x=a / 4 - t / 2, y=b / 2 - t / 2),
            rectangle(a / 2, t, x=-a / 4 + t / 2, y=-b / 2 + t / 2),
        ),
        joined(rectangle(a, t), *[rectangle(t, b, x=s * (a - t) / 2) for s in (-1, 1)]),
    ]
    return slab(shapes[int(rng.integers(len(shapes)))], rng.uniform(1.5, 10), pieces=6)


@family("machine", 8, 16)
def flange(rng: np.random.Generator) -> Solid:
    """A disc, round or square, with a pipe stub."""
    r, pipe, h = 5.0, rng.uniform(1.5, 3), rng.uniform(3, 9)
    foot = cylinder(r, rng.uniform(0.8, 1.6)) if rng.random() < 0.6 else box(8.5, 8.5, 1.2, 0.2).at(z=0.6)
    return foot + cylinder(pipe, h, 0.1, top=pipe * rng.uniform(0.8, 1.0))


@family("machine", 9, 17)
def hand_wheel(rng: np.random.Generator) -> Solid:
    """A rim with spokes and a hub: valves, steering wheels."""
    r, thick, spokes = 5.0, rng.uniform(0.5, 1.0), int(rng.integers(3, 6))
    t = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    rim = tube(np.c_[r * np.cos(t), r * np.sin(t), 0 * t], thick, pieces=12, closed=True)
    for k in range(spokes):
        rim = rim + box(r, thick * 1.2, thick * 0.9).at(x=r / 2).turned("z", 360 * k / spokes)
    return rim + cylinder(rng.uniform(0.9, 1.5), rng.uniform(1.5, 4)).at(z=-0.8)


@family("machine", 10, 20)
def shaft(rng: np.random.Generator) -> Solid:
    """A stepped axle with three to six diameters."""
    steps = int(rng.integers(3, 7))
    z, line = 0.0, []
    for _ in range(steps):
        r, length = rng.uniform(0.6, 2.6), rng.uniform(1.2, 4.5)
        line += [(r, z), (r, z + length)]
        z += length + 1e-3
    return lathe(line, 2 * steps - 1).turned("y", 90)


@family("machine", 8, 16)
def pulley(rng: np.random.Generator) -> Solid:
    """A wheel with a groove: pulleys, spools, yo-yos, reels."""
    r, core, h = 5.0, rng.uniform(1.5, 3.8), rng.uniform(2.5, 8)
    rim = rng.uniform(0.12, 0.3) * h
    return lathe([(r, 0), (r, rim), (core, rim + 0.25), (core, h - rim - 0.25), (r, h - rim), (r, h)], 5)


@family("machine", 9, 18)
def crank(rng: np.random.Generator) -> Solid:
    """Two round bosses on an arm, one with a peg."""
    a, b, length = rng.uniform(1.4, 2.4), rng.uniform(1.0, 1.8), rng.uniform(6, 10)
    t = rng.uniform(0.8, 1.6)
    c = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    ends = [np.c_[r * 0.8 * np.cos(c) + x, r * 0.8 * np.sin(c), 0 * c] for r, x in ((a, 0), (b, length))]
    arm = hull(*[end + np.array([0, 0, z]) for end in ends for z in (0, t)])
    peg = cylinder(b * 0.6, rng.uniform(2, 5)).at(x=length, z=t - 0.1)
    return arm + cylinder(a, t * 1.6).at(z=-t * 0.3) + peg


@family("machine", 7, 15)
def knob(rng: np.random.Generator) -> Solid:
    """A turned or lobed grip on a stub."""
    lobes, r = int(rng.integers(0, 6)), 3.5
    stub = cylinder(rng.uniform(0.8, 1.6), rng.uniform(2, 5))
    if lobes < 3:
        return stub + lathe([(r * 0.7, 1.8), (r, 2.6), (r, 3.6), (r * 0.7, 4.4)], 3).at(z=0.1)
    arms = [circle(1.3, 2.6 * math.cos(k), 2.6 * math.sin(k)) for k in 2 * math.pi * np.arange(lobes) / lobes]
    return stub + slab(joined(circle(2.2), *arms), 1.8, pieces=10, bevel=0.15).at(z=2.6)


@family("machine", 8, 18)
def housing(rng: np.random.Generator) -> Solid:
    """A block with a boss, feet and a step: motors, gear boxes, plugs, adapters."""
    x, y, z = rng.uniform(5, 9), rng.uniform(4, 7), rng.uniform(3, 6)
    body = box(x, y, z, rng.uniform(0, 0.5))
    r = rng.uniform(0.8, 0.45 * min(y, z))
    boss = cylinder(r, rng.uniform(1, 4)).turned("y", 90).at(x=x / 2 - 0.1)
    step = box(x * rng.uniform(0.3, 0.7), y * 0.8, rng.uniform(1, 3)).at(x=-x * 0.1, z=z / 2 + 0.4)
    feet = box(x * 0.9, y * rng.uniform(1.2, 1.5), 0.8).at(z=-z / 2 + 0.4)
    shape = body + boss
    shape = shape + step if rng.random() < 0.6 else shape
    return shape + feet if rng.random() < 0.5 else shape


@family("machine", 8, 16)
def heat_sink(rng: np.random.Generator) -> Solid:
    """Fins on a plate."""
    fins, w, h = int(rng.integers(3, 7)), 7.0, rng.uniform(2, 6)
    shape = box(w, rng.uniform(4, 9), 1.0)
    deep = np.ptp(shape.parts[0][:, 1])
    for k in range(fins):
        shape = shape + box(w / fins * 0.4, deep, h).at(x=-w / 2 + w * (k + 0.5) / fins, z=h / 2 + 0.4)
    return shape


@family("machine", 8, 17)
def funnel_cone(rng: np.random.Generator) -> Solid:
    """A cone on a plate, closed: traffic cones, funnels, nozzles."""
    r, h = rng.uniform(2.5, 4.5), rng.uniform(6, 11)
    cone = lathe([(r, 0), (r * rng.uniform(0.15, 0.45), h)], 1)
    if rng.random() < 0.6:
        return cone + box(2.4 * r, 2.4 * r, 0.7, 0.1)
    return cone + loft([Section(-rng.uniform(1, 4), r * 0.7), Section(0.1, r)], 1)
