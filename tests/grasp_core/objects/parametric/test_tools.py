import numpy as np
import pytest

from grasp_core.objects.parametric import tools
from grasp_core.objects.parametric.tools import grip, ring

GROUP = tools


def test_sound(own_family, assert_sound):
    assert_sound(own_family)


@pytest.mark.parametrize("name", ["hammer", "mallet", "axe", "screwdriver", "chisel", "trowel", "paintbrush", "wrench"])
def test_long_along_their_handle(look, name):
    tool = look(name, 0)
    assert tool.sides.argmax() == 0
    assert tool.sides[0] > 1.15 * tool.sides[1] and tool.sides[0] > 2.5 * tool.sides[2]


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize(
    ("name", "shift"), [("hammer", 10), ("axe", 10), ("screwdriver", 6), ("chisel", 10), ("trowel", 6)]
)
def test_steel_shifts_the_centre_of_mass_towards_the_working_end(look, name, seed, shift):
    """The origin is the centre of mass: of one stuff it would lie at the mesh's own centroid."""
    tool = look(name, seed)
    assert tool.asset.mesh.center_mass[0] * 1000 < -shift


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("name", ["hammer", "mallet"])
def test_head_lies_across_the_handle(look, name, seed):
    tool = look(name, seed)
    assert tool.spans("x", 0.93)[0] > 2 * tool.spans("x", 0.5)[0]


def test_roll_and_ring_spanner_have_a_hole_and_a_screwdriver_has_none(look):
    assert look("tape_roll", 0).holes == 1
    assert {look("wrench", seed).holes for seed in range(4)} == {0, 1}
    assert look("screwdriver", 0).holes == 0


@pytest.mark.parametrize("seed", [0, 1])
def test_pliers_have_two_handles_that_meet(look, seed):
    pliers = look("pliers", seed)
    assert [len(pliers.slices("x", share)) for share in (0.1, 0.95)] == [2, 1]


@pytest.mark.parametrize("seed", [0, 1])
def test_a_clamp_gapes(look, seed):
    """Nothing of the frame stands between its arms where work is put in."""
    clamp = look("clamp", seed)
    middle = clamp.low + clamp.sides * [0.45, 0.6, 0.5]
    assert len(clamp.hits(middle, (0, 1, 0))) == 2
    assert len(clamp.hits(middle, (-1, 0, 0))) == 2
    assert len(clamp.hits(middle, (0, 0, 1))) == len(clamp.hits(middle, (0, 0, -1))) == 0


def test_ring_is_a_ring_in_what_is_seen_and_in_its_parts():
    body = ring(5, 3, 2)
    assert body.body.volume() == pytest.approx(np.pi * (25 - 9) * 2, rel=0.02)
    assert body.body.genus() == 1
    assert len(body.parts) == 12
    corners = np.concatenate(body.parts)
    away = np.hypot(corners[:, 0], corners[:, 1])
    assert away.min() > 2.95 and away.max() < 5.1
    assert (corners[:, 2].min(), corners[:, 2].max()) == (0.0, 2.0)


def test_grip_runs_along_x_from_the_origin():
    handle = grip(np.random.default_rng(0), 12, 1.0, 4)
    x0, y0, _, x1, y1, _ = handle.body.bounding_box()
    assert (x0, x1) == pytest.approx((0, 12), abs=1e-6)
    assert y0 == pytest.approx(-y1, abs=1e-6)
    assert 0.6 < y1 < 1.5
    assert len(handle.parts) == 4
