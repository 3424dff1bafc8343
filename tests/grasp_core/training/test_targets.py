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
