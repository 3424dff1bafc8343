import numpy as np
import pytest

from grasp_core.objects.parametric import furniture

GROUP = furniture


def test_sound(own_family, assert_sound):
    assert_sound(own_family)


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("name", ["chair", "table", "bed"])
def test_four_legs_in_four_corners(look, name, seed):
    piece = look(name, seed)
    feet = piece.slices("z", 0.02)
    assert len(feet) == 4
    boxes = np.array([foot.bounds() for foot in feet])
    middles = (boxes[:, :2] + boxes[:, 2:]) / 2
    assert len({tuple(np.sign(middle - middles.mean(axis=0))) for middle in middles}) == 4
    assert sum(foot.area() for foot in feet) < 0.35 * piece.sides[0] * piece.sides[1]


@pytest.mark.parametrize("seed", [0, 1])
def test_a_finger_goes_between_the_legs_of_a_table(look, seed):
    """No part fills the space below the top."""
    table = look("table", seed)
    low = np.array([(table.low[0] + table.high[0]) / 2, table.low[1] - 10, table.low[2] + 0.3 * table.sides[2]])
    assert len(table.hits(low, (0, 1, 0))) == len(table.hits(low, (0, 1, 0), parts=True)) == 0


@pytest.mark.parametrize("seed", [0, 1])
def test_a_chairs_back_rises_behind_the_seat(look, seed):
    chair = look("chair", seed)
    (back,) = chair.slices("z", 0.95)
    assert back.bounds()[2] < chair.low[0] + 0.5 * chair.sides[0]


@pytest.mark.parametrize("seed", range(3))
def test_a_shelf_has_boards_one_above_the_other(look, seed):
    shelf = look("shelf", seed)
    front = np.array([shelf.high[0] - 0.3 * shelf.sides[0], (shelf.low[1] + shelf.high[1]) / 2, shelf.high[2] + 5])
    crossings = shelf.hits(front, (0, 0, -1))
    assert len(crossings) in {4, 6, 8}
    thick, gaps = crossings[1::2] - crossings[::2], crossings[2::2] - crossings[1:-1:2]
    assert np.allclose(thick, thick[0], rtol=0.01)
    assert (gaps > 2 * thick[0]).all() and np.ptp(gaps) < 0.02 * gaps.max()


@pytest.mark.parametrize("seed", [0, 1])
def test_a_bathtub_is_open_above_and_closed_below(look, seed):
    tub = look("bathtub", seed)
    x, y = (tub.low + tub.high)[:2] / 2
    assert tub.drop(x, y) > 0.7 * tub.sides[2]
    assert tub.drop(x, y, parts=True) > 0.7 * tub.sides[2]


def test_flower_pots_are_empty_or_planted(look):
    """A plant stands higher than the rim of its pot, over the middle."""
    drops = []
    for seed in range(6):
        pot = look("flower_pot", seed)
        drops.append(pot.drop(*pot.foot()) / pot.sides[2])
    assert any(drop > 0.7 for drop in drops) and any(drop < 0.6 for drop in drops)


@pytest.mark.parametrize("seed", [0, 1])
def test_a_sofa_has_two_arms_and_a_back(look, seed):
    sofa = look("sofa", seed)
    middle = (sofa.low + sofa.high) / 2
    seat = sofa.drop(middle[0], middle[1])
    assert sofa.drop(sofa.low[0] + 0.05 * sofa.sides[0], middle[1]) < seat - 3
    for side in (0.04, 0.96):
        assert sofa.drop(middle[0], sofa.low[1] + side * sofa.sides[1]) < seat - 3


@pytest.mark.parametrize("seed", [0, 1])
def test_a_guitars_neck_is_slim(look, seed):
    guitar = look("guitar", seed)
    assert guitar.spans("x", 0.9)[0] < 0.5 * guitar.spans("x", 0.15)[0]
