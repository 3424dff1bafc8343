"""Hollow vessels: thin walls whose convex parts are wedges of the wall and a slice of the floor."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from grasp_core.objects.parametric.solids import Points, Section, Solid, breaks, rings_body


def shell(
    sections: Sequence[Section], wall: float, floor: float, *, wedges: int = 8, levels: int = 1, low_wedges: int = 6
) -> Solid:
    """A vessel open at its top.

    Args:
        sections: the outer skin, rising z; the first is the foot.
        wall: thickness of the wall, measured square to the skin.
        floor: thickness of the floor.
        wedges: parts around the topmost level.
        levels: levels of the wall at most, cut where its profile bends most.
        low_wedges: parts around each lower level.
    """
    bottom, top = sections[0].z + floor, sections[-1].z
    bottom = max(bottom, min(s.z for s in _moved(sections, wall)))
    outer = [section_at(sections, bottom), *[s for s in sections if s.z > bottom + 1e-6]]
    inner = _offset(sections, wall, bottom, top)
    opening = replace(inner[-1], z=top + 0.05 * (top - bottom))
    seen = rings_body([s.ring() for s in sections]) - rings_body([s.ring() for s in [*inner, opening]])
    cuts = breaks([[s.z, s.a, s.a if s.b is None else s.b] for s in outer], levels, 0.15)
    parts: list[Points] = []
    for low, high in itertools.pairwise(cuts):
        count = wedges if high == cuts[-1] else low_wedges
        ends = [(outer[low], _inside(inner, outer[low], wall)), (outer[high], _inside(inner, outer[high], wall))]
        parts += [_wedge(ends, count, k) for k in range(count)]
    parts.append(np.concatenate([sections[0].coarse(), outer[0].coarse()]))
    return Solid.of(seen, parts)


def section_at(sections: Sequence[Section], z: float) -> Section:
    """The section between others (rising z) at height z, linear."""
    table = np.array([[s.a, s.a if s.b is None else s.b, s.n, s.x, s.y] for s in sections])
    a, b, n, x, y = (float(np.interp(z, [s.z for s in sections], column)) for column in table.T)
    return Section(z, a, b, n, x, y)


def _moved(sections: Sequence[Section], wall: float) -> list[Section]:
    """Each section moved by `wall` inwards, square to the profile."""
    profile = np.array([[s.a, s.z] for s in sections])
    along = np.gradient(profile, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    moved = []
    for section, (da, dz) in zip(sections, along, strict=True):
        inset = wall * max(dz, 0.0)
        b = (section.a if section.b is None else section.b) - inset
        moved.append(
            replace(section, z=section.z + wall * da, a=max(section.a - inset, 0.1 * section.a), b=max(b, 0.1 * b))
        )
    return moved


def _offset(outer: Sequence[Section], wall: float, bottom: float, top: float) -> list[Section]:
    """The inner skin from `bottom` to `top`, rising."""
    rising: list[Section] = []
    for section in _moved(outer, wall):
        if not rising or section.z > rising[-1].z + 1e-4:
            rising.append(section)
    between = [s for s in rising if bottom + 1e-3 < s.z < top - 1e-3]
    return [section_at(rising, bottom), *between, section_at(rising, top)]


def _inside(inner: Sequence[Section], outer: Section, wall: float) -> Section:
    """The section of the inner skin that belongs to one of the outer skin: the nearest one."""
    near = np.argmin([(s.z - outer.z) ** 2 + (s.a - outer.a + 0.5 * wall) ** 2 for s in inner])
    if outer.z <= inner[0].z:
        near = np.intp(0)
    return inner[int(near)]


def _wedge(ends: Sequence[tuple[Section, Section]], count: int, k: int) -> Points:
    """Points of one wedge of the wall between two levels, each an outer and an inner section.

    The inner face of a wedge is a chord; it is set between the chord's own place and the arc, so that the wall is
    neither too thick nor too thin on average.
    """
    start, width = k * 2 * np.pi / count, 2 * np.pi / count
    corners, middles = np.array([start, start + width]), start + width * np.array([0.0, 0.25, 0.5, 0.75, 1.0])
    rows = []
    for outer, inner in ends:
        square = outer.n > 3
        wall = max(outer.a - inner.a, 1e-3)
        sag = 0.0 if square else inner.a * (1 - np.cos(width / 2)) * 0.55
        out = min(sag, 0.65 * wall)
        rows += [outer.points(corners if square else middles), inner.points(corners, -out)]
    return np.concatenate(rows)
