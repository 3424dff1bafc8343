import numpy as np
import pytest

from workbench import colours


def test_scores_run_from_red_to_teal():
    low, high = colours.score(0.0), colours.score(1.0)
    assert low[0] > low[1] and high[1] > high[0]
    assert (colours.score([-5.0, 7.0, np.nan]) == [low, high, low]).all()
    assert colours.score([0.1, 0.5, 0.9]).shape == (3, 3)


def test_every_outcome_has_its_colour():
    from grasp_core.simulation.evidence import Outcome

    assert set(colours.OUTCOMES) == {str(outcome) for outcome in Outcome}
    assert len(set(colours.OUTCOMES.values())) == len(colours.OUTCOMES)


def test_css():
    assert colours.css((255, 0, 10)) == "#ff000a"
    assert colours.score_gradient().startswith("linear-gradient(90deg,#")
    assert colours.heat_gradient().count("#") == 9


def test_near_is_bright_and_holes_are_apart():
    depth = np.array([[0.6, 0.7, 0.0]], np.float32)
    valid = np.array([[True, True, False]])
    picture = colours.depth(depth, valid, 0.6, 0.7)
    assert picture[0, 0].sum() > picture[0, 1].sum()
    assert tuple(picture[0, 2]) == colours.UNMEASURED


def test_single_pixels_do_not_set_the_range():
    depth = np.full((100, 100), 0.7, np.float32)
    depth[0, 0] = 0.01
    near, far = colours.depth_range(depth, depth > 0)
    assert near > 0.6 and far > near
    assert colours.depth_range(depth, depth > 1) == (0.0, 1.0)


def test_quality_is_clipped_for_display_only():
    values = np.array([[-3.0, 0.0, 1.0, 9.0]], np.float32)
    picture = colours.heat(values)
    assert (picture[0, 0] == picture[0, 1]).all() and (picture[0, 2] == picture[0, 3]).all()
    assert values[0, 3] == 9.0
    assert (colours.heat(np.array([[0.25]], np.float32), 0.25) == picture[0, 2]).all()


@pytest.mark.parametrize("largest, top", [(0.0, 0.05), (0.23, 0.25), (0.9, 0.9), (7.0, 1.0), (-1.0, 0.05)])
def test_the_colours_of_a_map_end_at_its_largest_value(largest, top):
    assert colours.heat_top(np.array([[largest, -2.0]], np.float32)) == pytest.approx(top)


@pytest.mark.parametrize("value", [0, 128, 255])
def test_lit_colours_are_deeper(value):
    assert colours.lit(np.array([value], np.uint8))[0] <= value


def test_every_depth_map_has_its_gradient():
    gradients = {colours.depth_gradient(name) for name in colours.DEPTH_MAPS}
    assert len(gradients) == len(colours.DEPTH_MAPS)
    assert all(gradient.count("#") == 9 for gradient in gradients)
