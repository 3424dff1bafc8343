import numpy as np
import pytest

from grasp_core import config
from grasp_core.evaluation.hard import KINDS, hard_plans
from grasp_core.evaluation.suites import Suite

SUITE = config.load("benchmarks", "hard", Suite)


@pytest.mark.parametrize("kind", KINDS)
def test_objects_of_a_kind_keep_to_its_ranges(kind):
    ranges = SUITE.hard[kind]
    low = {name: values[0] for name, values in ranges.items()}
    high = {name: values[1] for name, values in ranges.items()}
    for plan in hard_plans({kind: ranges}, 3):
        asset = plan.make()
        sides = asset.extents
        if kind == "thin_rim":
            assert low["diameter"] - 1e-6 <= sides[0] <= high["diameter"] + 1e-6
            assert low["height"] - 1e-6 <= sides[2] <= high["height"] + 1e-6
        elif kind in ("flat", "near_opening"):
            names = ("length", "width", "height") if kind == "flat" else ("width", "length", "height")
            for name, side in zip(names, sides, strict=True):
                assert low[name] - 1e-6 <= side <= high[name] + 1e-6
        elif kind == "little_grip":
            assert low["base"] - 1e-6 <= sides[0] <= high["base"] + 1e-6
            assert sides[2] >= low["base_height"] + low["knob_height"] - 1e-6
        else:
            assert sides[0] > low["length"] and low["head"] - 1e-6 <= sides[2] <= high["head"] + 1e-6
        assert asset.name == plan.name and asset.category == kind and kind in asset.source


def test_the_head_of_a_heavy_end_holds_the_centre_of_mass_near_it():
    for plan in hard_plans({"heavy_end": SUITE.hard["heavy_end"]}, 3):
        asset = plan.make()  # its origin is the centre of mass, its head at greatest x
        assert asset.vertices[:, 0].max() < 0.4 * np.ptp(asset.vertices[:, 0])


def test_objects_repeat_and_differ():
    one, again, other = (
        plan.make().digest for plan in (*hard_plans(SUITE.hard, 1)[:1] * 2, hard_plans(SUITE.hard, 2)[1])
    )
    assert one == again != other


@pytest.mark.parametrize(
    ("kinds", "words"),
    [
        ({"soft": {}}, "no kind is called 'soft'"),
        ({"flat": {"length": (0.1, 0.2)}}, "needs the ranges of length, width, height"),
        ({"flat": {"length": (0.2, 0.1), "width": (0.1, 0.1), "height": (0.01, 0.02)}}, "least and a greatest"),
    ],
)
def test_nonsense_is_refused(kinds, words):
    with pytest.raises(ValueError, match=words):
        hard_plans(kinds, 1)
