import numpy as np
import pytest

from grasp_core.objects.parametric import machine

GROUP = machine


def test_sound(own_family, assert_sound):
    assert_sound(own_family)


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("name", ["nut", "gear"])
def test_the_bore_goes_right_through_and_its_parts_leave_it_free(look, name, seed):
    """The origin lies on the axis of these wheels."""
    wheel = look(name, seed)
    assert wheel.holes == 1
    above = np.array([0, 0, wheel.high[2] + 10])
    for parts in (False, True):
        assert len(wheel.hits(above, (0, 0, -1), parts)) == 0
        assert len(wheel.hits(np.zeros(3), (1, 0, 0), parts)) > 0


def around(piece, count=360):
    """Distance from the origin to the outermost surface, per direction about z."""
    turns = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return np.array([piece.hits(np.zeros(3), (np.cos(t), np.sin(t), 0))[-1] for t in turns])


@pytest.mark.parametrize("seed", [0, 1])
def test_a_gear_has_six_to_twelve_teeth(look, seed):
    away = around(look("gear", seed))
    tip = away > (away.max() + away.min()) / 2
    teeth = int((tip & ~np.roll(tip, 1)).sum())
    assert 6 <= teeth <= 12
    assert away.max() > 1.1 * away.min()


@pytest.mark.parametrize("seed", [0, 1])
def test_a_hand_wheel_has_a_hole_between_each_two_spokes(look, seed):
    assert look("hand_wheel", seed).holes in {3, 4, 5}


@pytest.mark.parametrize("seed", [0, 1])
def test_a_heat_sinks_fins_stand_apart(look, seed):
    sink = look("heat_sink", seed)
    fins = sink.slices("z", 0.9)
    assert 3 <= len(fins) <= 6
    assert np.ptp([fin.area() for fin in fins]) < 0.01 * fins[0].area()
    assert len(sink.slices("z", 0.05)) == 1


@pytest.mark.parametrize("seed", [0, 1])
def test_a_pulleys_groove_is_narrower_than_its_rims(look, seed):
    pulley = look("pulley", seed)
    rim, groove, other = (pulley.spans("z", share).max() for share in (0.05, 0.5, 0.95))
    assert groove < 0.85 * min(rim, other)
    outside = np.array([0.0, 0.0, (pulley.low[2] + pulley.high[2]) / 2])
    assert pulley.hits(outside, (1, 0, 0), parts=True)[-1] < 0.45 * min(rim, other)


@pytest.mark.parametrize("seed", [0, 1])
def test_a_bolts_head_is_wider_than_its_shaft(look, seed):
    bolt = look("bolt", seed)
    assert bolt.spans("x", 0.93).max() > 1.35 * bolt.spans("x", 0.4).max()


@pytest.mark.parametrize("seed", [0, 1])
def test_a_crank_has_a_peg_at_one_end(look, seed):
    crank = look("crank", seed)
    (peg,) = crank.slices("z", 0.97)
    assert peg.bounds()[0] > crank.low[0] + 0.6 * crank.sides[0]


@pytest.mark.parametrize("seed", range(3))
def test_a_bracket_is_the_same_all_along(look, seed):
    bracket = look("bracket", seed)
    areas = [sum(piece.area() for piece in bracket.slices("z", share)) for share in (0.05, 0.5, 0.95)]
    assert areas == pytest.approx([areas[0]] * 3, rel=1e-3)
    assert areas[0] < 0.8 * bracket.sides[0] * bracket.sides[1]


@pytest.mark.parametrize("seed", [0, 1])
def test_a_flange_is_a_flat_foot_with_a_pipe(look, seed):
    flange = look("flange", seed)
    foot, pipe = flange.spans("z", 0.03), flange.spans("z", 0.9)
    assert pipe.max() < 0.75 * foot.min()


@pytest.mark.parametrize("seed", [0, 1])
def test_a_tees_side_pipe_meets_the_middle_of_the_other(look, seed):
    """Its outline fills much less of its box than a straight pipe's would: arms on both sides of a stem."""
    tee = look("tee", seed)
    middle = (tee.low + tee.high) / 2
    (stem,) = tee.slices("y", 0.97)
    z0, x0, z1, x1 = stem.bounds()
    assert (x0 + x1) / 2 == pytest.approx(middle[0], abs=1.0)
    assert x1 - x0 < 0.6 * tee.sides[0] and z1 > z0
