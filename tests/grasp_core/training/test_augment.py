import math
from collections.abc import Callable

import msgspec
import numpy as np
import pytest

from grasp_core.camera import DepthImage
from grasp_core.sensing.noise import ImageNoise
from grasp_core.training.augment import Augmentation, corrupt, mirror_crops, move_image, moved_by
from grasp_core.training.scenes import TrainingScene

Toys = Callable[[int, int], list[TrainingScene]]


def clean(scene: TrainingScene) -> DepthImage:
    return DepthImage(scene.depth, scene.camera, np.ones(scene.units.shape, np.bool_))


def on_object(depth: np.ndarray, pixels: np.ndarray) -> np.ndarray:
    u, v = np.clip(np.rint(pixels).astype(int), 0, 299).T
    return depth[v, u] < 0.68


@pytest.mark.parametrize("turn", [0.0, 0.7, -2.0])
@pytest.mark.parametrize("flip", [False, True])
def test_grasps_move_with_the_image(toys: Toys, turn: float, flip: bool) -> None:
    scene = toys(0, 1)[0]
    placed = moved_by(scene, scene.depth, turn, flip, 1.0, (20.0, -15.0))
    centre = np.array([149.5, 149.5])
    inner = np.abs(scene.pixels - centre).max(axis=1) < 80
    before, after = on_object(scene.depth, scene.pixels)[inner], on_object(placed.depth, placed.pixels)[inner]
    assert np.mean(before == after) > 0.95  # pixels on an edge may change sides
    assert before.any()
    assert not before.all()
    # the closing axis keeps its angle to a line between two grasps
    ends = placed.pixels[1] - placed.pixels[0]
    starts = scene.pixels[1] - scene.pixels[0]
    old = math.atan2(-starts[1], starts[0]) - scene.angles
    new = math.atan2(-ends[1], ends[0]) - placed.angles
    np.testing.assert_allclose(np.cos(2 * old), np.cos(2 * new), atol=1e-4)
    np.testing.assert_allclose(np.sin(2 * old) * (-1 if flip else 1), np.sin(2 * new), atol=1e-4)


def test_turn_is_counter_clockwise_as_displayed(toys: Toys) -> None:
    scene = toys(0, 1)[0]
    placed = moved_by(scene, scene.depth, math.pi / 2, False, 1.0, (0.0, 0.0))
    wanted = np.rot90(scene.depth)  # numpy turns counter-clockwise
    assert np.mean(np.abs(placed.depth - wanted) < 1e-4) > 0.99


def test_zoom_scales_lengths(toys: Toys) -> None:
    scene = toys(3, 1)[0]
    placed = moved_by(scene, scene.depth, 0.0, False, 1.1, (0.0, 0.0))
    assert (placed.depth < 0.68).sum() == pytest.approx(1.21 * (scene.depth < 0.68).sum(), rel=0.03)
    np.testing.assert_allclose(placed.pixels - 149.5, 1.1 * (scene.pixels - 149.5), atol=1e-3)


def test_moving_draws_from_its_settings(toys: Toys) -> None:
    scene = toys(0, 1)[0]
    still = Augmentation(rotate=False, shift=0.0, mirror=False, zoom=0.0)
    placed = move_image(scene, scene.depth, still, np.random.default_rng(0))
    np.testing.assert_allclose(placed.pixels, scene.pixels, atol=1e-3)
    np.testing.assert_array_equal(placed.depth, scene.depth)
    a, b = (move_image(scene, scene.depth, Augmentation(), np.random.default_rng(4)) for _ in range(2))
    np.testing.assert_array_equal(a.depth, b.depth)
    assert np.abs(a.pixels - scene.pixels).max() > 3


def test_corruption_is_small_whole_and_repeatable(toys: Toys) -> None:
    scene = toys(0, 1)[0]
    strong = Augmentation(clean=0.0, holes=5.0)
    image = corrupt(clean(scene), strong, np.random.default_rng(1))
    again = corrupt(clean(scene), strong, np.random.default_rng(1))
    np.testing.assert_array_equal(image.depth, again.depth)
    assert image.valid.all()
    assert image.depth.dtype == np.float32
    difference = image.depth - scene.depth
    assert 0.0005 < np.median(np.abs(difference)) < 0.01
    assert np.mean(np.abs(difference) > 0.02) < 0.02


def test_richer_noise_is_drawn_for_its_share_of_images(toys: Toys) -> None:
    image = clean(toys(0, 1)[0])
    calm = Augmentation(clean=0.0, holes=0.0, plane_height=0.0, plane_tilt=0.0, noise=ImageNoise(sigma_d=0.0))
    errors = []
    for share in (0.0, 0.5, 1.0):
        given = msgspec.structs.replace(calm, rich=share, rich_noise=ImageNoise(field_sigma=0.01))
        moved = [corrupt(image, given, np.random.default_rng(seed)).depth - image.depth for seed in range(40)]
        errors.append(np.mean([np.median(np.abs(change)) > 0.003 for change in moved]))
    assert errors[0] == 0 and 0.25 < errors[1] < 0.75 and errors[2] == 1


def test_no_corruption_when_all_is_off(toys: Toys) -> None:
    scene = toys(0, 1)[0]
    off = Augmentation(clean=1.0, plane_height=0.0, plane_tilt=0.0)
    np.testing.assert_array_equal(corrupt(clean(scene), off, np.random.default_rng(0)).depth, scene.depth)


def test_crops_are_mirrored_both_ways_one_by_one() -> None:
    crop = np.arange(16, dtype=np.float32).reshape(4, 4)
    mirrored = mirror_crops(np.repeat(crop[None], 200, 0), np.random.default_rng(0))
    kinds = {image.tobytes() for image in mirrored}
    wanted = {np.ascontiguousarray(c).tobytes() for c in (crop, crop[:, ::-1], crop[::-1], crop[::-1, ::-1])}
    assert kinds == wanted


def test_settings_refuse_nonsense() -> None:
    with pytest.raises(ValueError, match="holes"):
        Augmentation(holes=-1)
    with pytest.raises(ValueError, match="clean"):
        Augmentation(clean=1.5)
