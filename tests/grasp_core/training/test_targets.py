import math

import numpy as np
import pytest

from grasp_core.training.targets import draw_target


def draw(angle: float = 0.0, rectangle: str = "third_along", labels: tuple[float, ...] = (1.0,)) -> np.ndarray:
    count = len(labels)
    pixels = np.tile([50.0, 40.0], (count, 1))
    return draw_target(
        (80, 100),
        pixels,
        np.full(count, angle),
        np.full(count, 30.0),
        np.array(labels),
        rectangle=rectangle,  # type: ignore[arg-type]
    )


def sides(target: np.ndarray) -> tuple[int, int]:
    rows, columns = np.nonzero(target)
    return int(np.ptp(columns)) + 1, int(np.ptp(rows)) + 1


@pytest.mark.parametrize(("rectangle", "wanted"), [("third_along", (10, 30)), ("third_across", (30, 10))])
def test_sides_of_both_readings(rectangle: str, wanted: tuple[int, int]) -> None:
    width, height = sides(draw(rectangle=rectangle))
    assert abs(width - wanted[0]) <= 1
    assert abs(height - wanted[1]) <= 1


def test_a_quarter_turn_swaps_the_sides() -> None:
    assert sides(draw(math.pi / 2)) == sides(draw(0.0, "third_across"))


def test_angle_is_counter_clockwise_as_displayed() -> None:
    target = draw(math.radians(45), "third_across")
    assert target[33, 57] == 1.0  # right and up
    assert target[47, 57] == 0.0


def test_larger_label_wins_and_low_ones_are_not_drawn() -> None:
    assert draw(labels=(1.0, 0.8)).max() == draw(labels=(0.8, 1.0)).max() == 1.0
    assert set(np.unique(draw(labels=(0.8, 1.0)))) == {0.0, 1.0}
    assert draw(labels=(0.6, 0.2, float("nan"))).max() == 0.0
    assert draw(labels=(0.8,)).max() == np.float32(0.8)


def test_rectangle_is_centred_and_clipped_at_the_border() -> None:
    rows, columns = np.nonzero(draw())
    assert columns.mean() == pytest.approx(50, abs=0.5)
    assert rows.mean() == pytest.approx(40, abs=0.5)
    clipped = draw_target((80, 100), np.array([[0.0, 0.0]]), np.zeros(1), np.full(1, 30.0), np.ones(1))
    assert clipped[0, 0] == 1


def test_blur_puts_the_best_pixel_inside_a_plateau() -> None:
    pixels = np.array([[u, 40.0] for u in range(30, 71, 4)])
    count = len(pixels)
    target = draw_target((80, 100), pixels, np.zeros(count), np.full(count, 30.0), np.ones(count), blur=6.0)
    v, u = np.unravel_index(int(np.argmax(target)), target.shape)
    assert abs(u - 50) <= 2
    assert abs(v - 40) <= 2
    assert target.max() < 1.0


def test_mean_of_overlaps_is_the_share_of_success() -> None:
    labels = np.tile([1.0, 0.0, 0.0, 0.0], 100)
    count = len(labels)
    pixels = np.full((count, 2), 40.0)
    target = draw_target((80, 100), pixels, np.zeros(count), np.full(count, 30.0), labels, overlap="mean")
    assert target[40, 40] == pytest.approx(0.25, abs=0.01)
    assert target[40, 60] == 0
    lone = draw_target((80, 100), pixels[:1], np.zeros(1), np.full(1, 30.0), np.ones(1), overlap="mean")
    assert 0 < lone.max() < 0.3  # one lucky grasp is no peak


def test_mean_clips_at_every_border() -> None:
    pixels = np.array([[0.0, 0.0], [99.0, 79.0], [-200.0, 40.0], [50.0, 400.0]])
    target = draw_target((80, 100), pixels, np.full(4, 0.5), np.full(4, 30.0), np.ones(4), overlap="mean")
    assert target[0, 0] > 0
    assert target[79, 99] > 0
    assert target[40, 50] == 0
