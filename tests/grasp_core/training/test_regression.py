from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
import pytest
import torch

from grasp_core import config
from grasp_core.errors import ConfigError
from grasp_core.training.augment import Augmentation, move_image
from grasp_core.training.loop import Schedule
from grasp_core.training.regression import (
    RegressionSettings,
    RegressionTask,
    example,
    scene_target,
    train_regression,
)
from grasp_core.training.scenes import TrainingScene

Toys = Callable[[int, int], list[TrainingScene]]
SETTINGS = RegressionSettings(Schedule(epochs=3, batch=4, rate=4e-3, patience=5))


@pytest.fixture(autouse=True)
def one_thread() -> None:
    torch.set_num_threads(1)


def test_example_shows_heights_and_the_target_on_the_object(toys: Toys) -> None:
    scene = toys(0, 1)[0]
    calm = Augmentation(clean=1.0, plane_height=0.0, plane_tilt=0.0)
    heights, target = example(scene, scene_target(scene, SETTINGS, 0.1), calm, np.random.default_rng(0))
    assert heights.shape == target.shape == (300, 300)
    assert target.max() == 1.0
    assert heights[target > 0.9].mean() > 0.5 * heights.max()  # grasps lie on and across the bar
    assert np.median(heights) == pytest.approx(0.0, abs=1e-3)


def test_always_colliding_grasps_are_drawn_unless_told_otherwise(toys: Toys) -> None:
    scene = toys(0, 1)[0]
    all_of_them = msgspec.structs.replace(SETTINGS, overlap="mean")
    some = msgspec.structs.replace(all_of_them, colliding=False)
    assert scene.colliding.any()
    drawn, less = scene_target(scene, all_of_them, 0.1), scene_target(scene, some, 0.1)
    assert (less >= drawn - 1e-6).all() and less.sum() > 1.1 * drawn.sum()  # they are failures


def test_the_moved_target_is_the_target_of_the_moved_grasps(toys: Toys) -> None:
    scene = toys(0, 1)[0]
    smooth = msgspec.structs.replace(SETTINGS, blur=8.0)
    calm = Augmentation(clean=1.0, plane_height=0.0, plane_tilt=0.0, zoom=0.0, shift=30.0)
    _, target = example(scene, scene_target(scene, smooth, 0.1), calm, np.random.default_rng(4))
    placed = move_image(scene, scene.depth, calm, np.random.default_rng(4))
    drawn = scene_target(replace(scene, pixels=placed.pixels, angles=placed.angles), smooth, 0.1)
    assert np.abs(target - drawn).max() < 0.05 < 0.8 < drawn.max()


def test_learns_where_to_grasp(toys: Toys, tmp_path: Path) -> None:
    task, result = train_regression(toys(0, 16), toys(500, 4), SETTINGS, 0.1, tmp_path, about="a", progress=False)
    assert result.history[-1]["loss"] < result.history[0]["loss"]
    assert result.metrics["hit"] >= 0.75
    measured = task.measures(toys(600, 2))
    assert measured["skill"] > 0.2
    assert measured["region"] > np.mean([scene.labels.mean() for scene in toys(600, 2)])
    assert (tmp_path / "regression.csv").is_file()


def test_needs_a_perfect_grasp_to_validate_on(toys: Toys) -> None:
    with pytest.raises(ConfigError, match="quality 1"):
        RegressionTask(toys(0, 1), [], SETTINGS, 0.1, torch.device("cpu"))


def test_shipped_settings_decode() -> None:
    assert config.load("training", "regression", RegressionSettings).least == 0.6
