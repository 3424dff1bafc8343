import numpy as np
import pytest

from grasp_core.objects.parametric import vessels
from grasp_core.objects.parametric.vessels import handle, rounds

GROUP = vessels


def test_sound(own_family, assert_sound):
    assert_sound(own_family)


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize(
    ("name", "depth"),
    [("cup", 0.75), ("mug", 0.75), ("jug", 0.75), ("bowl", 0.6), ("pan", 0.4), ("plate", 0.5), ("wine_glass", 0.3)],
)
def test_from_above_the_bottom_is_seen_and_no_lid(look, name, seed, depth):
    """In what is seen and in the parts: a closed mouth would keep a finger out."""
    vessel = look(name, seed)
    x, y = vessel.foot()
    assert vessel.drop(x, y) > depth * vessel.sides[2]
    assert vessel.drop(x, y, parts=True) > depth * vessel.sides[2]


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize(("name", "depth"), [("bottle", 1.0), ("jar", 1.0), ("teapot", 1.0), ("can", 5.0)])
def test_closed_ones_have_a_lid(look, name, seed, depth):
    vessel = look(name, seed)
    assert vessel.drop(*vessel.foot()) < depth
    assert vessel.fill > 0.7


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize(("name", "handles"), [("cup", 0), ("bowl", 0), ("plate", 0), ("mug", 1), ("jug", 1)])
def test_a_handle_leaves_a_hole_and_stands_out_on_one_side(look, name, handles, seed):
    vessel = look(name, seed)
    assert vessel.holes == handles
    axis = vessel.foot()
    right, left = vessel.high[0] - axis[0], axis[0] - vessel.low[0]
    assert (right > left + 10) == bool(handles)
    assert vessel.high[1] - axis[1] == pytest.approx(axis[1] - vessel.low[1], rel=0.02)


@pytest.mark.parametrize("seed", [0, 1])
def test_a_pans_handle_is_one_long_bar(look, seed):
    pan = look("pan", seed)
    (bar,) = pan.slices("x", 0.95)
    assert bar.area() < 250 and bar.num_contour() == 1
    assert pan.sides[0] > 1.3 * pan.sides[1]


def test_rounds_are_round_and_never_empty():
    first, second = rounds([(0.0, 0.0), (2.0, 1.5)])
    assert first.a > 0
    assert (second.a, second.z, second.n) == (2.0, 1.5, 2.0)


def test_handle_reaches_out_from_the_wall_and_back():
    grip = handle(1, 9, 4, 3, 2.5, 0.5, 1.0)
    x0, y0, z0, x1, y1, z1 = grip.body.bounding_box()
    assert x0 < 3 and x1 == pytest.approx(4 + 2.5 + 0.5, abs=0.15)
    assert (y0, y1) == pytest.approx((-0.5, 0.5), abs=0.02)
    assert z0 < 1.2 and 8.5 < z1 < 9.6
    assert len(grip.parts) == 4
    assert np.concatenate(grip.parts)[:, 0].max() == pytest.approx(x1, abs=0.1)
