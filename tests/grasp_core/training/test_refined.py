from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import torch

from grasp_core import config
from grasp_core.errors import ConfigError
from grasp_core.networks.weights import CropSpec
from grasp_core.training.augment import Augmentation
from grasp_core.training.loop import Schedule
from grasp_core.training.refined import (
    RefinedSettings,
    RefinedTask,
    scene_samples,
    scores,
    soft_cross_entropy,
    train_refined,
    with_bare_grasps,
)
from grasp_core.training.scenes import TrainingScene

Toys = Callable[[int, int], list[TrainingScene]]
SETTINGS = RefinedSettings(
    Schedule(epochs=4, batch=64, rate=4e-3, patience=4), width=4, crop=CropSpec(size=32), pool=8, colliding=0.5, bare=0
)


@pytest.fixture(autouse=True)
def one_thread() -> None:
    torch.set_num_threads(1)


def test_loss_equals_five_copies_in_the_two_classes() -> None:
    logits = torch.randn(6, 2)
    quality = torch.tensor([0.0, 0.2, 0.4, 0.6, 0.8, 1.0])
    copies, classes = [], []
    for row, q in zip(logits, quality, strict=True):
        good = round(5 * float(q))
        copies += [row] * 5
        classes += [1] * good + [0] * (5 - good)
    wanted = torch.nn.functional.cross_entropy(torch.stack(copies), torch.tensor(classes))
    torch.testing.assert_close(soft_cross_entropy(logits, quality, torch.ones(6)), wanted)


def test_weights_of_the_loss_are_copies_too() -> None:
    logits, labels = torch.randn(2, 2), torch.tensor([1.0, 0.0])
    doubled = soft_cross_entropy(logits[[0, 1, 1]], labels[[0, 1, 1]], torch.ones(3))
    torch.testing.assert_close(soft_cross_entropy(logits, labels, torch.tensor([1.0, 2.0])), doubled)


def test_thinning_keeps_the_weight_of_colliding_grasps(toys: Toys) -> None:
    scene = toys(0, 1)[0]
    rng = np.random.default_rng(0)
    kept = [scene_samples(scene, SETTINGS, 0.1, rng, training=True) for _ in range(40)]
    sizes = np.array([len(part.labels) for part in kept])
    total = np.mean([part.weights.sum() for part in kept])
    assert sizes.mean() == pytest.approx((~scene.colliding).sum() + 0.5 * scene.colliding.sum(), rel=0.05)
    assert total == pytest.approx(len(scene.labels), rel=0.05)
    assert all(part.crops.shape[1:] == (32, 32) for part in kept)


def test_bare_grasps_stand_on_bare_table(toys: Toys) -> None:
    scene = toys(2, 1)[0]
    more = with_bare_grasps(scene, 30, 0.1, np.random.default_rng(0))
    added = slice(len(scene.labels), None)
    assert len(more.labels[added]) == 30
    assert not more.labels[added].any()
    assert not more.colliding[added].any()
    objects = np.argwhere(scene.depth < 0.69)[:, ::-1]
    for pixel in more.pixels[added]:
        assert np.hypot(*(objects - pixel).T).min() > 65  # less than an opening away nothing stands
    np.testing.assert_allclose(more.depths[added], 0.70 - 0.008, atol=1e-4)
    np.testing.assert_array_equal(more.labels[: len(scene.labels)], scene.labels)
    full = toys(2, 1)[0]
    full.units[:] = 6500  # no table in sight
    assert len(with_bare_grasps(full, 5, 0.1, np.random.default_rng(0)).labels) == len(full.labels)


def test_evaluation_uses_every_grasp_and_repeats(toys: Toys) -> None:
    scene = toys(0, 1)[0]
    a, b = (scene_samples(scene, SETTINGS, 0.1, np.random.default_rng(3), training=False) for _ in range(2))
    np.testing.assert_array_equal(a.crops, b.crops)
    np.testing.assert_array_equal(a.labels, scene.labels)
    assert np.all(a.weights == 1)


def test_learns_calibrates_and_resumes(toys: Toys, tmp_path: Path) -> None:
    training, validation = toys(0, 24), toys(500, 6)
    task, result = train_refined(training, validation, SETTINGS, 0.1, tmp_path, about="a", progress=False)
    assert result.history[-1]["loss"] < 0.5 * result.history[0]["loss"]
    assert result.metrics["auc"] > 0.9
    assert result.metrics["ap"] > 3 * task.held_out.labels.mean()
    assert 0.05 < result.metrics["temperature"] < 20
    assert (tmp_path / "refined.pt").is_file()
    again, repeated = train_refined(training, validation, SETTINGS, 0.1, tmp_path, about="a", progress=False)
    assert repeated.metrics == result.metrics
    np.testing.assert_allclose(again.margins(again.held_out), task.margins(task.held_out))


def test_batches_cover_the_epoch_in_a_repeatable_order(toys: Toys) -> None:
    task = RefinedTask(toys(0, 10), toys(500, 1), SETTINGS, 0.1, torch.device("cpu"))
    first = list(task.batches(np.random.default_rng(2)))
    second = list(task.batches(np.random.default_rng(2)))
    shares = [share for share, _ in first]
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)
    assert sum(len(batch[1]) for _, batch in first) > 10 * 120 * 0.6
    for (_, a), (_, b) in zip(first, second, strict=True):
        assert torch.equal(a[0], b[0])


def test_scores_are_the_sigmoid_of_margins() -> None:
    np.testing.assert_allclose(scores(np.array([-800.0, 0.0, 2.0])), [0, 0.5, 1 / (1 + np.exp(-2.0))], atol=1e-12)


def test_needs_validation_grasps(toys: Toys) -> None:
    with pytest.raises(ConfigError, match="validation split"):
        RefinedTask(toys(0, 1), [], SETTINGS, 0.1, torch.device("cpu"))


def test_shipped_settings_decode() -> None:
    shipped = config.load("training", "refined", RefinedSettings)
    assert shipped.width == 16
    assert isinstance(shipped.augmentation, Augmentation)
