import numpy as np
import pytest

from grasp_core.errors import GraspError
from grasp_core.training import metrics


def test_perfect_and_reversed_rankings() -> None:
    labels = np.array([1.0, 0.8, 0.2, 0.0])
    good, bad = np.array([0.9, 0.8, 0.3, 0.1]), np.array([0.1, 0.3, 0.8, 0.9])
    assert metrics.auc(good, labels) == 1.0
    assert metrics.average_precision(good, labels) == 1.0
    assert metrics.auc(bad, labels) == 0.0
    assert metrics.accuracy(good, labels) == 1.0
    assert metrics.accuracy(bad, labels) == 0.0


def test_auc_equals_the_share_of_ordered_pairs() -> None:
    rng = np.random.default_rng(0)
    scores = np.round(rng.random(200), 2)
    labels = (rng.random(200) < scores).astype(float)
    positive, negative = scores[labels > 0.5], scores[labels <= 0.5]
    pairs = (positive[:, None] > negative).mean() + 0.5 * (positive[:, None] == negative).mean()
    assert metrics.auc(scores, labels) == pytest.approx(pairs)


def test_average_precision_by_hand() -> None:
    # In order: +, −, +, −  → precision 1 at recall 1/2, 2/3 at recall 1.
    assert metrics.average_precision([0.9, 0.8, 0.7, 0.6], [1, 0, 1, 0]) == pytest.approx(0.5 * 1 + 0.5 * 2 / 3)


def test_ties_count_once_whatever_their_order() -> None:
    for labels in ([1, 0, 1, 0], [0, 1, 0, 1]):
        assert metrics.average_precision([0.5] * 4, labels) == pytest.approx(0.5)
        assert metrics.auc([0.5] * 4, labels) == pytest.approx(0.5)


def test_curves_start_and_end_where_they_must() -> None:
    false, true = metrics.roc([0.1, 0.4, 0.35, 0.8], [0, 0, 1, 1])
    assert (false[0], true[0], false[-1], true[-1]) == (0, 0, 1, 1)
    precision, recall = metrics.precision_recall([0.1, 0.4, 0.35, 0.8], [0, 0, 1, 1])
    assert recall[-1] == 1
    assert precision[0] == 1


def test_missing_class_gives_nan_not_a_number_that_looks_good() -> None:
    assert np.isnan(metrics.auc([0.2, 0.3], [0, 0]))
    assert np.isnan(metrics.average_precision([0.2, 0.3], [0, 0]))


def test_brier_and_calibration_compare_with_the_label_itself() -> None:
    assert metrics.brier([0.8, 0.2], [0.8, 0.2]) == 0
    assert metrics.brier([1.0, 0.0], [0.8, 0.2]) == pytest.approx(0.04)
    assert metrics.ece([0.9] * 10, [0.6] * 10) == pytest.approx(0.3)
    rng = np.random.default_rng(1)
    scores = rng.random(40_000)
    assert metrics.ece(scores, rng.random(40_000) < scores) < 0.02


def test_reliability_counts_every_grasp_once() -> None:
    diagram = metrics.reliability([0.0, 0.05, 1.0, 0.5], [0, 0, 1, 1], bins=4)
    np.testing.assert_array_equal(diagram.count, [2, 1, 1])
    np.testing.assert_allclose(diagram.label, [0, 1, 1])


def test_names_of_the_classification_measures() -> None:
    assert set(metrics.classification([0.2, 0.7], [0, 1])) == {"accuracy", "ap", "auc", "brier", "ece"}


@pytest.mark.parametrize(("scores", "labels"), [([], []), ([0.5], [0.5, 1]), ([np.nan], [1]), ([0.5], [np.nan])])
def test_refuses_what_has_no_measure(scores: list[float], labels: list[float]) -> None:
    with pytest.raises(GraspError):
        metrics.brier(scores, labels)


def test_regression_hit_is_the_distance_of_the_best_pixel() -> None:
    quality = np.zeros((40, 60), np.float32)
    quality[10, 50] = 1
    assert metrics.best_pixel(quality) == (50, 10)
    assert metrics.regression_hit(quality, [[0, 0], [47, 14]], 5.0)
    assert not metrics.regression_hit(quality, [[0, 0], [47, 14]], 4.9)
    with pytest.raises(GraspError, match="quality 1"):
        metrics.regression_hit(quality, np.zeros((0, 2)), 5.0)
