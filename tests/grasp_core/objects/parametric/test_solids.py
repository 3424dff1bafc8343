import numpy as np
import pytest

from grasp_core.objects.hulls import convex_part
from grasp_core.objects.parametric.solids import (
    Section,
    ball,
    box,
    breaks,
    curve,
    cylinder,
    hull,
    lathe,
    loft,
    tube,
    turn,
)


def parts_volume(solid):
    return sum(convex_part(part).mesh.volume for part in solid.parts)


@pytest.mark.parametrize(
    ("make", "volume"),
    [
        (lambda: box(2, 3, 4), 24),
        (lambda: cylinder(2, 5), np.pi * 4 * 5),
        (lambda: cylinder(2, 3, top=1), np.pi * 3 / 3 * (4 + 2 + 1)),
        (lambda: ball(1, 2, 3), 4 / 3 * np.pi * 6),
        (lambda: tube([[0, 0, 0], [4, 0, 0], [8, 0, 0]], 1.0), np.pi * 8),
        (lambda: loft([Section(0, 2, 3, 8), Section(4, 2, 3, 8)]), 4 * 4 * 6 * 0.97),
    ],
)
def test_volume_of_what_is_seen_and_of_the_parts(make, volume):
    solid = make()
    assert solid.body.volume() == pytest.approx(volume, rel=0.03)
    assert parts_volume(solid) == pytest.approx(volume, rel=0.08)


def test_rounded_box_keeps_its_sides_and_has_24_corners():
    solid = box(4, 6, 2, 0.5)
    low, high = np.array(solid.body.bounding_box()).reshape(2, 3)
    assert np.allclose(high - low, [4, 6, 2], atol=1e-6)
    assert len(convex_part(solid.parts[0]).vertices) == 24


def test_moves_apply_to_body_and_parts_alike():
    moved = box(1, 2, 3).turned("z", 90).scaled(2).at(x=5)
    assert np.allclose(moved.body.bounding_box(), (3, -1, -3, 7, 1, 3), atol=1e-9)
    assert np.allclose([*moved.parts[0].min(axis=0), *moved.parts[0].max(axis=0)], (3, -1, -3, 7, 1, 3), atol=1e-9)


def test_union_keeps_densities():
    both = box(1, 1, 1) + box(1, 1, 1).at(x=0.5).dense(3)
    assert both.densities == (1, 3)
    assert both.body.volume() == pytest.approx(1.5)


def test_turn_is_right_handed():
    assert np.allclose(turn("z", 90) @ [1, 0, 0], [0, 1, 0])
    assert np.allclose(turn("x", 90) @ [0, 1, 0], [0, 0, 1])
    assert np.allclose(turn("y", 90) @ [0, 0, 1], [1, 0, 0])


def test_breaks_cut_at_corners_only():
    line = [[0, 0], [1, 0], [2, 0], [2, 1], [2, 2]]
    assert breaks(line, 5) == [0, 2, 4]
    assert breaks(line, 1) == [0, 4]


def test_curve_runs_through_its_ends():
    line = curve([[0, 0], [1, 2], [3, 1]], 11)
    assert np.allclose(line[[0, -1]], [[0, 0], [3, 1]])
    assert np.isfinite(line).all()


def test_closed_tube_is_a_ring():
    t = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    ring = tube(np.c_[4 * np.cos(t), 4 * np.sin(t), 0 * t], 1.0, pieces=12, closed=True)
    assert ring.body.genus() == 1
    assert ring.body.volume() == pytest.approx(2 * np.pi**2 * 4, rel=0.03)
    assert len(ring.parts) == 12


def test_carving_and_hulls():
    carved = lathe([(2, 0), (2, 3)]).carved(cylinder(1, 1).at(z=2.5))
    assert carved.body.volume() < np.pi * 12 and len(carved.parts) == 1
    assert hull([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 0, 1]]).body.volume() == pytest.approx(1 / 6)
