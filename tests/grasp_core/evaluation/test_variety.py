import math

from grasp_core.evaluation.variety import FIVE, count_distinct
from grasp_core.grasp import Grasp


def test_grasps_count_once_unless_they_differ_in_place_or_angle():
    here = Grasp((0.1, 0.0, 0.02), 0.0, 0.1)
    beside = Grasp((0.109, 0.0, 0.02), 0.0, 0.1)
    farther = Grasp((0.111, 0.0, 0.02), 0.0, 0.1)
    turned = Grasp((0.1, 0.0, 0.02), 0.3, 0.1)
    assert count_distinct([]) == 0
    assert count_distinct([here]) == count_distinct([here, here, beside]) == 1
    assert count_distinct([here, beside, farther, turned]) == 3


def test_angles_on_both_sides_of_the_wrap_are_one():
    ends = [Grasp((0, 0, 0.02), angle, 0.1) for angle in (-math.pi / 2, math.pi / 2 - 0.01)]
    assert count_distinct(ends) == 1
    assert count_distinct([Grasp((0.02 * k, 0, 0.02), 0, 0.1) for k in range(FIVE)]) == FIVE
