import numpy as np
import pytest

from grasp_core.sensing.lookup import look_up

VALUES = np.arange(12, dtype=np.float32).reshape(3, 4)


@pytest.mark.parametrize("shape", [(5,), (5, 1)])
def test_the_nearest_pixel_or_what_lies_outside(shape):
    u, v = np.array([0.4, 1.6, 3.4, 3.6, -2.0]).reshape(shape), np.array([0.0, 1.4, 2.4, 2.0, 1.0]).reshape(shape)
    found = look_up(VALUES, u, v, outside=-np.inf)
    assert found.shape == shape
    assert found.ravel().tolist() == [0.0, 6.0, 11.0, -np.inf, -np.inf]


def test_between_pixels_it_interpolates():
    found = look_up(VALUES, np.array([[0.5, 1.25]]), np.array([[0.0, 1.5]]), outside=0.0, linear=True)
    assert found.tolist() == [[0.5, 7.25]]


def test_more_places_than_opencv_takes_at_once():
    count = 40_000
    u, v = np.tile(np.arange(4.0), count // 4)[:, None], np.full((count, 1), 2.0)
    assert np.array_equal(look_up(VALUES, u, v, outside=0.0)[:, 0], np.tile(VALUES[2], count // 4))


def test_no_place_gives_nothing():
    assert look_up(VALUES, np.zeros((0, 7)), np.zeros((0, 7)), outside=0.0).size == 0
