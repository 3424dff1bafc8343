import numpy as np
import pytest

from grasp_core.objects.parametric import bathroom

GROUP = bathroom


def test_sound(own_family, assert_sound):
    assert_sound(own_family)


@pytest.mark.parametrize("seed", [0, 1])
def test_a_paper_roll_is_hollow_along_its_axis(look, seed):
    roll = look("paper_roll", seed)
    assert roll.holes == 1
    for parts in (False, True):
        assert len(roll.hits(np.array([0, 0, roll.high[2] + 5]), (0, 0, -1), parts)) == 0
    bore = 2 * roll.hits(np.zeros(3), (1, 0, 0))[0]
    assert 10 < bore < 0.9 * roll.sides[0]


@pytest.mark.parametrize("seed", [0, 1])
def test_a_soap_dish_is_open_above(look, seed):
    dish = look("soap_dish", seed)
    assert dish.drop(0, 0) > 0.6 * dish.sides[2]
    assert dish.drop(0, 0, parts=True) > 0.6 * dish.sides[2]
    assert dish.sides[2] < 0.6 * dish.sides[0]


@pytest.mark.parametrize("seed", [0, 1])
def test_a_soap_is_one_convex_bar(look, seed):
    soap = look("soap", seed)
    assert soap.fill > 0.999
    assert len(soap.asset.parts) == 1
    assert soap.sides[2] < min(soap.sides[:2])


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("name", ["pump_bottle", "spray_bottle"])
def test_a_spout_reaches_out_to_one_side_over_a_slim_neck(look, name, seed):
    bottle = look(name, seed)
    axis = bottle.foot()
    head = bottle.slices("z", 0.96)[0].bounds()
    assert head[2] - axis[0] > 1.5 * (axis[0] - head[0])
    widths = [bottle.spans("z", share).max() for share in np.linspace(0.05, 0.95, 31)]
    assert min(widths[8:]) < 0.65 * max(widths)
    assert len(bottle.slices("z", 0.1)) == 1


@pytest.mark.parametrize("seed", [0, 1])
def test_a_razors_head_lies_across_its_handle(look, seed):
    razor = look("razor", seed)
    assert razor.spans("x", 0.95)[0] > 2 * razor.spans("x", 0.4)[0]


@pytest.mark.parametrize("seed", [0, 1])
def test_a_hairbrush_has_light_bristles_on_a_paddle(look, seed):
    brush = look("hairbrush", seed)
    assert brush.spans("x", 0.7)[0] > 1.5 * brush.spans("x", 0.2)[0]
    # bristles stand on one side only, and weigh less than their volume
    (tip,) = brush.slices("z", 0.98)
    assert tip.bounds()[0] > brush.low[0] + 0.4 * brush.sides[0]
    assert brush.asset.mesh.center_mass[2] > 0


@pytest.mark.parametrize("seed", [0, 1])
def test_a_tube_of_paste_is_flat_at_its_end_and_round_at_its_cap(look, seed):
    tube = look("tube_of_paste", seed)
    flat, cap = tube.spans("x", 0.02), tube.spans("x", 0.98)
    assert flat.max() > 3 * flat.min()
    assert cap.max() < 1.35 * cap.min()


@pytest.mark.parametrize("seed", [0, 1])
def test_a_toothbrush_is_slim_and_its_brush_is_at_one_end(look, seed):
    brush = look("toothbrush", seed)
    assert brush.sides[0] > 5 * brush.sides[1:].max()
    assert brush.slices("x", 0.92)[0].area() > 1.5 * brush.slices("x", 0.72)[0].area()


@pytest.mark.parametrize("seed", [0, 1])
def test_a_cream_jar_is_flat_with_a_lid(look, seed):
    jar = look("cream_jar", seed)
    assert jar.sides[2] < min(jar.sides[:2])
    assert jar.drop(*jar.foot()) < 1
