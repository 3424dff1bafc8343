import numpy as np
import pytest
from shapely.geometry import Polygon
from shapely.ops import unary_union

from grasp_core.objects.parametric.outlines import circle, convex_pieces, joined, rectangle, regular, slab, strip


def test_convex_outline_is_one_piece():
    assert len(convex_pieces(rectangle(4, 2))) == 1
    assert len(convex_pieces(circle(2))[0]) <= 12


@pytest.mark.parametrize(
    "outline",
    [
        joined(rectangle(6, 1), rectangle(1, 6)),
        circle(3).difference(circle(2)),
        rectangle(6, 6).difference(rectangle(3, 6, y=2)),
        strip([(0, 0), (4, 0), (4, 4), (0, 6)], 1),
    ],
)
def test_pieces_cover_the_outline_and_little_else(outline):
    pieces = [Polygon(piece) for piece in convex_pieces(outline, 10)]
    assert len(pieces) <= 10
    cover = unary_union(pieces)
    assert cover.intersection(outline).area > 0.97 * outline.area
    assert cover.difference(outline).area < 0.08 * outline.area
    assert all(piece.convex_hull.area == pytest.approx(piece.area) for piece in pieces)


def test_slab_has_the_outlines_volume_and_height():
    ring = circle(3).difference(circle(1.5))
    body = slab(ring, 0.8)
    assert body.body.volume() == pytest.approx(ring.area * 0.8, rel=1e-3)
    assert body.body.genus() == 1
    assert np.ptp(np.concatenate(body.parts)[:, 2]) == pytest.approx(0.8)
    assert slab(ring, 0.8, bevel=0.1).body.volume() < ring.area * 0.8


def test_outlines_that_do_not_touch_are_refused():
    with pytest.raises(ValueError, match="touch"):
        joined(circle(1), circle(1, x=5))


def test_regular_polygon():
    assert regular(6, 1).area == pytest.approx(1.5 * np.sqrt(3))
