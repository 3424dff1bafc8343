import numpy as np
import pytest

from grasp_core.evaluation.report import pool, table
from grasp_core.rates import wilson


def test_pool_adds_counts_and_drops_scenes_without_attempts():
    rate = pool([4, 0, 5], [5, 0, 5])
    assert (rate.successes, rate.attempts) == (9, 10)
    assert rate.rate == pytest.approx(0.9)
    assert (rate.low, rate.high) == wilson(9, 10)


def test_one_attempt_a_scene_needs_no_correction():
    rate = pool([1, 0, 1, 1], [1, 1, 1, 1])
    assert (rate.scene_low, rate.scene_high) == (rate.low, rate.high)


def test_attempts_that_all_agree_within_scenes_count_once_a_scene():
    rate = pool([5] * 30 + [0] * 10, [5] * 40)
    expected = wilson(0.75 * 39, 39)  # the between-scene estimate divides by S - 1
    assert (rate.scene_low, rate.scene_high) == pytest.approx(expected)
    assert rate.scene_low < rate.low < rate.rate < rate.high < rate.scene_high


def test_a_perfect_run_counts_scenes_not_attempts():
    rate = pool([5] * 10, [5] * 10)
    assert (rate.scene_low, rate.scene_high) == wilson(10, 10)
    assert rate.scene_low < rate.low and rate.high == 1


def test_independent_attempts_lose_little_and_coverage_holds():
    rng = np.random.default_rng(0)
    truth, inside, clustered_inside, runs = 0.8, 0, 0, 400
    for _ in range(runs):
        chances = rng.beta(0.8, 0.2, size=40)  # scenes differ a lot
        rate = pool(rng.binomial(5, chances), np.full(40, 5))
        inside += rate.low <= truth <= rate.high
        clustered_inside += rate.scene_low <= truth <= rate.scene_high
    assert clustered_inside / runs > 0.92  # what a 95 % interval promises, less the noise of 400 runs
    assert inside / runs < 0.85  # and why the plain interval is not enough
    rate = pool(rng.binomial(5, 0.8, size=200), np.full(200, 5))
    assert (rate.scene_high - rate.scene_low) / (rate.high - rate.low) < 1.25


def test_no_attempts_make_no_rate():
    rate = pool([], [])
    assert rate.rate is None and (rate.low, rate.high) == (0.0, 1.0) and rate.text == "none"


def test_text_for_people():
    assert pool([5] * 10, [5] * 10).text == "100.0 % (72.2-100.0 %; 50/50)"


def test_table_lines_up():
    lines = table(["object", "rate"], [["mug", 1], ["plate_003", 0.25]]).splitlines()
    assert lines == ["object     rate", "---------  ----", "mug           1", "plate_003  0.25"]
