import numpy as np
import pytest

from grasp_core.objects.parametric import food

GROUP = food


def test_sound(own_family, assert_sound):
    assert_sound(own_family)


@pytest.mark.parametrize("seed", [0, 1])
def test_a_donut_has_a_hole_that_its_parts_leave_free(look, seed):
    donut = look("donut", seed)
    assert donut.holes == 1
    above = (donut.low + donut.high) / 2 + [0, 0, 100]
    assert len(donut.hits(above, (0, 0, -1))) == len(donut.hits(above, (0, 0, -1), parts=True)) == 0
    assert donut.fill < 0.9


@pytest.mark.parametrize("name", ["apple", "orange", "egg", "avocado", "pear", "lemon", "pepper", "loaf", "wedge"])
def test_whole_fruit_and_bread_hardly_differ_from_their_hull(look, name):
    assert look(name, 0).fill > 0.88


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize(("name", "axis"), [("banana", 2), ("croissant", 1)])
def test_bent_ones_have_their_middle_off_the_line_between_the_ends(look, name, axis, seed):
    bent = look(name, seed)
    ends = [bent.slices("x", share)[0].bounds() for share in (0.03, 0.97)]
    # across x a cut's coordinates are y and z
    heights = [(box[axis - 1] + box[axis + 1]) / 2 for box in ends]
    middle = bent.slices("x", 0.5)[0].bounds()
    assert min(heights) - (middle[axis - 1] + middle[axis + 1]) / 2 > 0.06 * bent.sides[0]


@pytest.mark.parametrize("seed", [0, 1])
def test_a_carrot_tapers_and_an_egg_is_blunt_at_one_end(look, seed):
    carrot = look("carrot", seed)
    thick = [carrot.spans("x", share).max() for share in (0.05, 0.4, 0.8)]
    assert thick[0] < thick[1] < thick[2]
    egg = look("egg", seed)
    assert egg.spans("x", 0.12).max() > 1.1 * egg.spans("x", 0.88).max()


@pytest.mark.parametrize("seed", [0, 1])
def test_a_lemon_has_a_tip_at_either_end_and_an_orange_has_none(look, seed):
    lemon, orange = look("lemon", seed), look("orange", seed)
    for share in (0.05, 0.95):
        assert lemon.spans("x", share).max() < 0.5 * lemon.spans("x", 0.5).max()
        # of a ball: 2 √(0.05 · 0.95) = 0.44; tips are longer than a ball's caps
        assert orange.spans("x", share).max() == pytest.approx(0.44 * orange.spans("x", 0.5).max(), rel=0.05)
    assert lemon.sides[0] > 1.1 * lemon.sides[1:].max()


@pytest.mark.parametrize("seed", [0, 1])
def test_a_mushrooms_cap_overhangs_its_stem(look, seed):
    mushroom = look("mushroom", seed)
    widths = [mushroom.spans("z", share).max() for share in np.linspace(0.02, 0.98, 33)]
    assert max(widths) > 1.4 * widths[0]
    assert int(np.argmax(widths)) > 8


@pytest.mark.parametrize("seed", [0, 1])
def test_a_wedge_is_one_convex_part_and_narrow_at_its_tip(look, seed):
    wedge = look("wedge", seed)
    assert len(wedge.asset.parts) == 1 and wedge.fill > 0.999
    assert wedge.spans("x", 0.1)[0] < 0.4 * wedge.sides[1]


def test_apples_are_dented_around_their_stem(look):
    """Beside the stem the fruit is lower than its shoulders, those farther out."""
    apple = look("apple", 1)
    x, y = apple.foot()
    drops = np.array([apple.drop(x - r * apple.sides[0], y) for r in (0.1, 0.15, 0.2, 0.3)])
    assert drops[0] > drops.min() + 0.5
