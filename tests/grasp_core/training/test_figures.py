from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from grasp_core.errors import ConfigError
from grasp_core.training.figures import classifier_figure, maps_figure, objects_figure
from grasp_core.training.scenes import TrainingScene

Toys = Callable[[int, int], list[TrainingScene]]


def test_classifier_figure_is_a_wide_picture(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    rng = np.random.default_rng(0)
    scores = rng.random(300)
    classifier_figure(tmp_path / "a.png", scores, rng.random(300) < scores)
    image = cv2.imread(str(tmp_path / "a.png"))
    assert image.shape[1] > 2 * image.shape[0]
    assert len(np.unique(image)) > 50


def test_objects_stand_in_one_figure_and_those_without_a_positive_are_left_out(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    hit = float("nan")  # without a grasp of quality 1
    measures = {f"mug_{k:03d}": {"ap": 0.1 * k, "ece": 0.02, "positives": 0.1, "hit": hit} for k in range(9)}
    measures["mug_000"]["hit"] = 0.5
    heights = []
    for name, chosen in (
        ("all", measures),
        ("none", {"pen_000": {"ap": float("nan"), "ece": 0.0, "positives": 0.0, "hit": hit}}),
    ):
        objects_figure(tmp_path / f"{name}.png", chosen)
        heights.append(cv2.imread(str(tmp_path / f"{name}.png")).shape[0])
    assert heights[0] > heights[1] > 100


def test_maps_are_laid_over_their_scenes(tmp_path: Path, toys: Toys) -> None:
    scenes = toys(0, 5)
    maps = [np.zeros((300, 300), np.float32) for _ in scenes]
    maps[1][40:60, 200:220] = 1
    maps_figure(tmp_path / "m.png", scenes, maps, columns=3)
    image = cv2.imread(str(tmp_path / "m.png"))
    assert image.shape == (600, 900, 3)
    assert image[55, 300 + 215, 2] > 120  # heat is red
    assert image[55, 215, 2] < 120
    assert not image[300:, 600:].any()  # the sixth tile is blank


def test_folder_that_is_not_there_is_named(tmp_path: Path, toys: Toys) -> None:
    with pytest.raises(ConfigError, match="nowhere"):
        maps_figure(tmp_path / "nowhere" / "m.png", toys(0, 1), [np.zeros((300, 300), np.float32)])
