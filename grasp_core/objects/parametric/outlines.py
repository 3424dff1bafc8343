"""Flat things: outlines cut from a plate, split into convex pieces in the plane."""

from __future__ import annotations

import manifold3d
import numpy as np
from numpy.typing import ArrayLike, NDArray
from shapely.geometry import LineString, MultiPoint, Point, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from grasp_core.objects.parametric.solids import Points, Solid


def circle(radius: float, x: float = 0.0, y: float = 0.0) -> Polygon:
    """A disc as a polygon of 48 points."""
    return Point(x, y).buffer(radius, quad_segs=12)


def rectangle(width: float, height: float, rounding: float = 0.0, x: float = 0.0, y: float = 0.0) -> Polygon:
    """A rectangle about (x, y), its corners rounded."""
    r = min(rounding, 0.49 * min(width, height))
    w, h = width / 2 - r, height / 2 - r
    core = Polygon([(x - w, y - h), (x + w, y - h), (x + w, y + h), (x - w, y + h)])
    return core.buffer(r, quad_segs=6) if r > 0 else core


def regular(count: int, radius: float, phase: float = 0.0) -> Polygon:
    """A regular polygon with its corners on a circle."""
    t = phase + np.arange(count) * 2 * np.pi / count
    return Polygon(np.c_[np.cos(t), np.sin(t)] * radius)


def strip(points: ArrayLike, width: float, round_ends: bool = True) -> Polygon:
    """A band of constant width along a polyline (N, 2)."""
    return LineString(np.asarray(points, float)).buffer(
        width / 2, quad_segs=6, cap_style="round" if round_ends else "flat"
    )


def joined(*outlines: BaseGeometry) -> Polygon:
    """The union of outlines that touch."""
    union = unary_union(outlines)
    if union.geom_type != "Polygon":
        raise ValueError("the outlines do not touch")
    return union


def slab(outline: Polygon, thickness: float, *, pieces: int = 8, bevel: float = 0.0) -> Solid:
    """An outline (holes allowed) given a thickness about z = 0; parts are convex pieces of the outline."""
    seen = _extrude(outline, thickness - 2 * bevel)
    if bevel > 0:
        smaller = outline.buffer(-bevel, quad_segs=4)
        if smaller.geom_type == "Polygon" and not smaller.is_empty:
            seen = seen + _extrude(smaller, thickness)
    parts = []
    for piece in convex_pieces(outline, pieces):
        parts.append(np.concatenate([np.c_[piece, np.full(len(piece), z)] for z in (-thickness / 2, thickness / 2)]))
    return Solid.of(seen, parts)


def _extrude(outline: Polygon, thickness: float) -> manifold3d.Manifold:
    rings = [np.asarray(ring.coords)[:-1, :2] for ring in (outline.exterior, *outline.interiors)]
    section = manifold3d.CrossSection(rings, manifold3d.FillRule.EvenOdd)
    return manifold3d.Manifold.extrude(section, thickness).translate((0, 0, -thickness / 2))


def convex_pieces(outline: Polygon, most: int = 8, corners: int = 12) -> list[NDArray[np.float64]]:
    """Convex polygons (K, 2) with at most `corners` corners that together cover an outline, nearly nothing else.

    The outline is simplified, triangulated, and triangles grow together in the order in which their hull covers the
    least outside the outline.
    """
    size = np.sqrt(outline.area)
    slack = 0.004 * size
    simple = outline.simplify(slack)
    while len(simple.exterior.coords) + sum(len(r.coords) for r in simple.interiors) > 60:
        slack *= 1.4
        simple = outline.simplify(slack)
    if simple.convex_hull.area < 1.01 * simple.area:
        return [_corners(simple.convex_hull, corners)]
    rings = [np.asarray(r.coords)[:-1, :2] for r in (simple.exterior, *simple.interiors)]
    oriented = [_wound(ring, i == 0) for i, ring in enumerate(rings)]
    points = np.concatenate(oriented)
    pieces: list[Polygon] = [Polygon(points[list(t)]) for t in manifold3d.triangulate(oriented)]
    pieces = [piece for piece in pieces if piece.area > 1e-9 * outline.area]
    wanted = outline.buffer(1e-9 * size)

    def cost(i: int, j: int) -> float:
        if pieces[i].distance(pieces[j]) > 1e-9 * size:
            return np.inf
        return float(unary_union([pieces[i], pieces[j]]).convex_hull.difference(wanted).area)

    costs = {(i, j): cost(i, j) for i in range(len(pieces)) for j in range(i)}
    alive = set(range(len(pieces)))
    while len(alive) > 1:
        pair = min(costs, key=lambda p: (costs[p], p))
        if len(alive) <= most and costs[pair] > 0.004 * outline.area:
            break
        if not np.isfinite(costs[pair]):
            break
        i, j = pair
        pieces.append(unary_union([pieces[i], pieces[j]]).convex_hull)
        new = len(pieces) - 1
        alive -= {i, j}
        costs = {p: c for p, c in costs.items() if not {i, j} & set(p)}
        costs |= {(new, k): cost(new, k) for k in alive}
        alive.add(new)
    return [_corners(pieces[i], corners) for i in sorted(alive)]


def _wound(ring: NDArray[np.float64], outer: bool) -> NDArray[np.float64]:
    x, y = ring[:, 0], ring[:, 1]
    positive = x @ np.roll(y, -1) - y @ np.roll(x, -1) > 0
    return ring if positive == outer else ring[::-1].copy()


def _corners(piece: Polygon, most: int) -> Points:
    """The corners of a convex polygon, the least important dropped."""
    ring = np.asarray(MultiPoint(np.asarray(piece.exterior.coords)[:, :2]).convex_hull.exterior.coords)[:-1]
    while len(ring) > most:
        before, after = np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0)
        a, b = ring - before, after - ring
        ring = np.delete(ring, np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).argmin(), axis=0)
    return ring
