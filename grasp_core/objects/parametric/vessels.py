"""Vessels of kitchen and table: hollow ones with thin walls, and closed ones."""

from __future__ import annotations

import math

import numpy as np

from grasp_core.objects.parametric.family import family
from grasp_core.objects.parametric.shells import shell
from grasp_core.objects.parametric.solids import Section, Solid, curve, cylinder, lathe, loft, tube


def rounds(profile: np.ndarray | list[tuple[float, float]]) -> list[Section]:
    """Round sections from (radius, z) pairs."""
    return [Section(float(z), max(float(r), 1e-3)) for r, z in np.asarray(profile, float)]


def _body(rng: np.random.Generator, height: float, radius: float) -> list[Section]:
    """The skin of a drinking vessel: straight, flared, bellied or waisted; round or a little squarish."""
    foot, middle = radius * rng.uniform(0.65, 1.05), radius * rng.uniform(0.85, 1.12)
    line = curve([(foot, 0), (middle, height * rng.uniform(0.4, 0.6)), (radius, height)], 12)
    n = 2.0 if rng.random() < 0.8 else rng.uniform(2.5, 4.5)
    return [Section(float(z), float(r), n=n) for r, z in line]


def handle(
    z_low: float, z_high: float, r_low: float, r_high: float, reach: float, thick: float, flat: float, pieces: int = 4
) -> Solid:
    """A grip in the xz plane: from the wall at (r_low, z_low) out by `reach` and back to it at (r_high, z_high)."""
    dz = z_high - z_low
    line = curve(
        [
            (r_low - thick * 0.6, 0, z_low),
            (r_low + reach * 0.75, 0, z_low + 0.12 * dz),
            (max(r_low, r_high) + reach, 0, z_low + 0.55 * dz),
            (r_high + reach * 0.75, 0, z_high - 0.06 * dz),
            (r_high - thick * 0.6, 0, z_high - 0.03 * dz),
        ],
        24,
    )
    return tube(line, thick, flat, pieces=pieces, up=(0, 1, 0))


@family("kitchen", 7, 15)
def cup(rng: np.random.Generator) -> Solid:
    """A tumbler without a handle."""
    height = rng.uniform(7, 13)
    return shell(_body(rng, height, rng.uniform(3, 4.6)), rng.uniform(0.25, 0.7), rng.uniform(0.4, 1.2), levels=2)


@family("kitchen", 9, 15)
def mug(rng: np.random.Generator) -> Solid:
    """A mug with one handle."""
    height, radius = rng.uniform(7, 11), rng.uniform(3.3, 4.8)
    skin = _body(rng, height, radius)
    wall = rng.uniform(0.3, 0.6)
    low, high = height * rng.uniform(0.12, 0.28), height * rng.uniform(0.74, 0.92)
    radii = [float(np.interp(z, [s.z for s in skin], [s.a for s in skin])) for z in (low, high)]
    grip = handle(low, high, radii[0], radii[1], rng.uniform(2.2, 3.4), rng.uniform(0.4, 0.75), rng.uniform(1.0, 1.8))
    vessel = shell(skin, wall, rng.uniform(0.4, 0.9), levels=2)
    inside = lathe([(max(s.a - wall, 0.1), s.z) for s in skin if s.z > 1])
    return vessel + Solid(grip.body - inside.body, grip.parts, grip.densities)


@family("kitchen", 10, 18)
def bowl(rng: np.random.Generator) -> Solid:
    """A bowl, shallow to deep, with or without a foot."""
    radius, height = rng.uniform(6, 9), rng.uniform(3.2, 7.5)
    foot = radius * rng.uniform(0.35, 0.6)
    power = rng.uniform(1.6, 2.8)
    t = np.linspace(0, 1, 14)
    profile = np.c_[foot + (radius - foot) * (1 - (1 - t) ** power) ** (1 / power), height * t]
    wall = rng.uniform(0.3, 0.7)
    dish = shell(rounds(profile), wall, wall * rng.uniform(1.0, 1.6), levels=2)
    if rng.random() < 0.4:
        return dish + cylinder(foot * 0.95, 0.7).at(z=-0.6)
    return dish


@family("kitchen", 14, 20)
def plate(rng: np.random.Generator) -> Solid:
    """A plate with a raised rim."""
    radius = 10.0
    well, rise = radius * rng.uniform(0.55, 0.75), radius * rng.uniform(0.12, 0.24)
    n = 2.0 if rng.random() < 0.75 else rng.uniform(3.2, 6)
    wall = rng.uniform(0.35, 0.6)
    line = [(well * 0.92, 0), (well, 0.12 * rise), (radius * 0.9, 0.75 * rise), (radius, rise)]
    flat = [Section(z, r, n=n) for r, z in line]
    return shell(flat, wall, wall, levels=2)


@family("kitchen", 12, 20)
def bottle(rng: np.random.Generator) -> Solid:
    """A closed bottle with shoulder, neck and cap."""
    radius, height = rng.uniform(2.6, 4.2), rng.uniform(14, 24)
    neck, shoulder = radius * rng.uniform(0.3, 0.55), height * rng.uniform(0.5, 0.72)
    n = 2.0 if rng.random() < 0.6 else rng.uniform(3.2, 6)
    ratio = 1.0 if n < 3 else rng.uniform(0.55, 1.0)
    waist = rng.uniform(0.82, 1.0)
    line = [(radius * 0.9, 0), (radius, 0.06 * height), (radius * waist, shoulder * 0.5), (radius, shoulder)]
    slope = height * rng.uniform(0.06, 0.2)
    body = [Section(float(z), float(r), float(r) * ratio, n) for r, z in curve(line, 16)]
    top = [Section(min(shoulder + slope, 0.86 * height), neck, neck), Section(0.9 * height, neck, neck)]
    cap = cylinder(neck * rng.uniform(1.05, 1.35), 0.12 * height, 0.1).at(z=0.88 * height)
    return loft(body + top, 6) + cap


@family("kitchen", 7, 16)
def can(rng: np.random.Generator) -> Solid:
    """A drink or food can."""
    radius, height = rng.uniform(2.6, 4.6), rng.uniform(4, 15)
    lip = rng.uniform(0.8, 0.97)
    line = [(radius * lip, 0), (radius, (1 - lip) * radius + 0.1)]
    line += [(radius, height - (1 - lip) * radius * 1.3 - 0.1), (radius * lip, height)]
    return lathe(line, 3).carved(cylinder(radius * lip * 0.93, 1).at(z=height - 0.12))


@family("kitchen", 9, 18)
def jar(rng: np.random.Generator) -> Solid:
    """A jar with a screw lid."""
    radius, height = rng.uniform(3, 4.8), rng.uniform(6, 14)
    n = 2.0 if rng.random() < 0.6 else rng.uniform(3.2, 5)
    lid = radius * rng.uniform(0.72, 1.05)
    line = [(radius * 0.92, 0), (radius, 0.5), (radius, height * 0.8), (lid * 0.93, height * 0.92)]
    body = loft([Section(z, r, r, n) for r, z in line], 4)
    return body + cylinder(lid, height * rng.uniform(0.12, 0.2), 0.15).at(z=height * 0.9)


@family("kitchen", 10, 20)
def pan(rng: np.random.Generator) -> Solid:
    """A small pan with a long handle."""
    radius, height = rng.uniform(4.5, 7), rng.uniform(1.8, 6)
    flare = rng.uniform(0.82, 1.0)
    skin = rounds([(radius * flare, 0), (radius * (flare + 1) / 2, height / 2), (radius, height)])
    length, thick = rng.uniform(6, 11), rng.uniform(0.45, 0.8)
    rise = rng.uniform(-0.02, 0.25) * length
    z = height * rng.uniform(0.72, 0.85)
    path = [(radius - 0.3, 0, z), (radius + length * 0.4, 0, z + rise * 0.6), (radius + length, 0, z + rise)]
    grip = tube(curve(path, 14), np.linspace(thick * 0.8, thick * 1.2, 14), rng.uniform(0.5, 1.0), pieces=2)
    return shell(skin, rng.uniform(0.25, 0.5), 0.4) + grip


@family("kitchen", 10, 20)
def wine_glass(rng: np.random.Generator) -> Solid:
    """A stemmed glass: foot, stem and a thin bowl."""
    radius, deep, stem = rng.uniform(2.8, 4.2), rng.uniform(5, 9), rng.uniform(4, 8)
    belly = rng.uniform(1.0, 1.25)
    top = curve([(0.7, 0), (radius * belly, deep * 0.45), (radius, deep)], 14)
    glass = shell(rounds(top), rng.uniform(0.2, 0.35), 0.5, levels=2).at(z=stem)
    thin = rng.uniform(0.35, 0.6)
    foot = lathe([(radius * 0.95, 0), (radius * 0.9, 0.3), (thin, 1.0), (thin, stem), (0.75, stem + 0.3)], 4)
    return glass + foot


@family("kitchen", 12, 20)
def jug(rng: np.random.Generator) -> Solid:
    """A pitcher with a spout-side lip and a handle."""
    height, radius = rng.uniform(11, 17), rng.uniform(3.6, 5.5)
    line = curve([(radius * 0.8, 0), (radius, height * 0.35), (radius * rng.uniform(0.72, 0.88), height * 0.8)], 12)
    rim = float(line[-1, 0]) * rng.uniform(1.0, 1.12)
    lean = -rng.uniform(0.02, 0.15) * radius
    skin = [*rounds(line), Section(height, rim * 1.08, rim, x=lean)]
    low, high = height * 0.22, height * rng.uniform(0.78, 0.9)
    radii = [float(np.interp(z, [s.z for s in skin], [s.a + s.x for s in skin])) for z in (low, high)]
    grip = handle(low, high, radii[0], radii[1], rng.uniform(2.4, 3.6), rng.uniform(0.5, 0.8), rng.uniform(1, 1.6))
    wall = rng.uniform(0.35, 0.6)
    inside = loft([Section(s.z, s.a - wall, (s.b or s.a) - wall, s.n, s.x) for s in skin if s.z > 1])
    return shell(skin, wall, 0.6, levels=2) + Solid(grip.body - inside.body, grip.parts, grip.densities)


@family("kitchen", 12, 20)
def teapot(rng: np.random.Generator) -> Solid:
    """A round pot with lid, knob, spout and handle."""
    radius, height = rng.uniform(4.5, 6), rng.uniform(6, 9)
    t = np.linspace(-0.42 * math.pi, 0.42 * math.pi, 15)
    belly = lathe(np.c_[radius * np.cos(t) ** rng.uniform(0.5, 1.0), height / 2 + height / 2 * np.sin(t)], 4)
    knob = lathe([(radius * 0.35, height * 0.94), (0.5, height * 1.04), (0.9, height * 1.14), (0.6, height * 1.24)], 3)
    spout = curve(
        [(radius * 0.6, 0, height * 0.3), (radius * 1.3, 0, height * 0.5), (radius * 1.6, 0, height * 0.95)], 12
    )
    nose = tube(spout, np.linspace(1.1, 0.55, 12), pieces=2, up=(0, 1, 0))
    grip = handle(height * 0.25, height * 0.8, radius * 0.85, radius * 0.75, rng.uniform(2, 3), 0.5, 1.1)
    return belly + knob + nose + grip.turned("z", 180)
