import numpy as np

from grasp_core.networks.inputs import HEIGHT_RANGE, HEIGHT_SCALE, regression_input


def test_empty_table_is_zero_and_heights_scale() -> None:
    depth = np.full((4, 5), 0.70, np.float32)
    depth[1, 2] = 0.60
    heights = regression_input(depth)
    assert heights.dtype == np.float32
    assert heights.shape == depth.shape
    assert abs(heights[1, 2] - 0.1 * HEIGHT_SCALE) < 1e-5
    heights[1, 2] = 0
    assert np.all(np.abs(heights) < 1e-6)


def test_far_and_near_values_are_clipped() -> None:
    heights = regression_input(np.array([[5.0, 0.01]], np.float32))
    np.testing.assert_allclose(heights, [[HEIGHT_RANGE[0] * HEIGHT_SCALE, HEIGHT_RANGE[1] * HEIGHT_SCALE]], rtol=1e-6)
