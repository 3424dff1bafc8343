from collections.abc import Callable

import numpy as np

from grasp_core.gripper import load_gripper
from grasp_core.networks.weights import Weights
from grasp_core.training.assess import assess
from grasp_core.training.scenes import TrainingScene

Toys = Callable[[int, int], list[TrainingScene]]


class Tall:
    """Calls tall pixels good, and grasps whose crop has an object in its middle."""

    backend = "fake"
    digest = "0"
    meta = Weights(name="fake", gripper="paper", gripper_digest=load_gripper().digest)

    def quality_map(self, x: np.ndarray) -> np.ndarray:
        return x

    def scores(self, crops: np.ndarray) -> np.ndarray:
        return (crops[:, 20:28, 20:28].mean(axis=(1, 2)) < 0).astype(np.float32) * 0.8


def test_every_grasp_is_scored_and_counted_by_object(toys: Toys) -> None:
    scenes = toys(0, 3)
    found = assess(Tall(), scenes, 0.10)
    assert len(found.scores) == sum(len(scene.labels) for scene in scenes)
    np.testing.assert_array_equal(found.labels, np.concatenate([scene.labels for scene in scenes]))
    assert set(found.by_object()) == {"bar_0", "bar_1", "bar_2"}
    assert found.totals["auc"] > 0.6  # grasps on the bar succeed more often than those beside it
    assert len(found.maps) == 3
    assert set(found.hits) == {0, 1, 2}
    assert 0 <= found.totals["hit"] <= 1
    per_object = {name: values["hit"] for name, values in found.by_object().items()}
    assert per_object == {scene.object: float(found.hits[k]) for k, scene in enumerate(scenes)}


def test_repeats_with_its_seed(toys: Toys) -> None:
    scenes = toys(0, 1)
    first, second, third = (assess(Tall(), scenes, 0.10, seed=seed) for seed in (0, 0, 1))
    np.testing.assert_array_equal(first.maps[0], second.maps[0])
    assert not np.array_equal(first.maps[0], third.maps[0])


def test_scenes_without_a_perfect_grasp_have_no_hit(toys: Toys) -> None:
    scene = toys(0, 1)[0]
    scene.labels[:] = 0.0
    found = assess(Tall(), [scene], 0.10)
    assert found.hits == {}
    assert np.isnan(found.totals["hit"]) and np.isnan(found.by_object()[scene.object]["hit"])
