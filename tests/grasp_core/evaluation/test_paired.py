import numpy as np
import pytest

from grasp_core.evaluation.paired import compare
from grasp_core.evaluation.records import CandidateRecord, PlanRecord
from grasp_core.grasp import Grasp


def plan(*successes: int, attempts: int = 5) -> PlanRecord:
    """A plan with a candidate for every number of successes."""
    candidates = tuple(
        CandidateRecord(
            Grasp((0, 0, 0.02), 0, 0.1),
            0.9,
            ("SUCCESS",) * good + ("MISSED",) * (attempts - good),
            (1,) * attempts,
            (0,) * attempts,
        )
        for good in successes
    )
    return PlanRecord("scene", "planner", 1.0, None if candidates else "none", candidates)


def test_best_ones_are_compared_everywhere_and_all_where_both_returned_some():
    found = compare([(plan(5, 0), plan(4)), (plan(), plan(5)), (plan(3), plan())], 5)
    assert found.top1.scenes == 3 and found.top1.difference == pytest.approx(8 / 15 - 9 / 15)
    assert found.all.scenes == 1 and found.all.difference == pytest.approx(5 / 10 - 4 / 5)


def test_the_interval_is_that_of_the_mean_of_paired_differences():
    rng = np.random.default_rng(3)
    level = rng.integers(1, 5, 400)
    pairs = [(plan(int(x) + int(rng.integers(0, 2))), plan(int(x))) for x in level]
    found = compare(pairs, 5).top1
    steps = np.array([one.candidates[0].successes - two.candidates[0].successes for one, two in pairs]) / 5
    half = 1.96 * steps.std(ddof=1) / np.sqrt(len(steps))
    assert found.difference == pytest.approx(steps.mean())
    assert found.low == pytest.approx(steps.mean() - half, abs=1e-4)
    assert found.high == pytest.approx(steps.mean() + half, abs=1e-4)
    assert found.low > 0  # the scenes differ by far more than the planners: only pairs tell them apart


def test_the_same_plans_give_the_same_interval():
    pairs = [(plan(5), plan(4)), (plan(2), plan(5)), (plan(5, 5), plan(1))]
    assert compare(pairs, 5) == compare(pairs, 5)
    swapped = compare([(two, one) for one, two in pairs], 5)
    assert swapped.top1.low == pytest.approx(-compare(pairs, 5).top1.high)


def test_without_common_scenes_there_is_no_difference():
    found = compare([], 5)
    assert found.top1.difference is None and found.all.scenes == 0 and found.top1.text == "no scenes"
