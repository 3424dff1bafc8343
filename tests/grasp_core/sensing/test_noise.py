import msgspec
import numpy as np
import pytest

from grasp_core.camera import DepthImage, canonical_camera
from grasp_core.config import shipped
from grasp_core.errors import ConfigError
from grasp_core.sensing.noise import ImageNoise, add_noise, depth_edges, load_noise

NONE = ImageNoise(sigma_u=0, sigma_v=0, sigma_d=0)


def step_image(size: int = 200) -> DepthImage:
    depth = np.full((size, size), 0.7, np.float32)
    depth[:, : size // 2] = 0.6
    return DepthImage.from_array(depth, canonical_camera(size))


def with_(**changes) -> ImageNoise:
    return msgspec.structs.replace(NONE, **changes)


def test_shipped_noise_loads_and_none_changes_nothing():
    assert set(shipped("noise")) >= {"none", "paper", "rich"}
    image = step_image()
    for name in shipped("noise"):
        load_noise(name)
    same = add_noise(image, load_noise("none"), np.random.default_rng(0))
    assert np.array_equal(same.depth, image.depth) and same.valid.all()
    assert load_noise() == ImageNoise()


def test_depth_noise_has_its_standard_deviation_and_leaves_the_input_alone():
    image = step_image()
    before = image.depth.copy()
    noisy = add_noise(image, with_(sigma_d=0.002), np.random.default_rng(1))
    assert np.std(noisy.depth - image.depth) == pytest.approx(0.002, rel=0.03)
    assert np.array_equal(image.depth, before)


def test_pixel_noise_moves_edges_and_invents_no_depth():
    image = step_image()
    noisy = add_noise(image, with_(sigma_u=0.5, sigma_v=0.5), np.random.default_rng(2))
    assert set(np.unique(noisy.depth)) == set(np.unique(image.depth))
    changed = np.nonzero(noisy.depth != image.depth)[1]
    assert len(changed) > 20 and np.abs(changed - 99.5).max() <= 3
    # χ_u of 0.5 px carries a pixel beside the edge over it with probability P(χ_u > 0.5) = 0.159
    assert np.mean(noisy.depth[:, 99] != image.depth[:, 99]) == pytest.approx(0.159, abs=0.08)


def test_seed_zero_is_a_seed():
    image, noise = step_image(), ImageNoise()
    one, two, other = (add_noise(image, noise, np.random.default_rng(seed)).depth for seed in (0, 0, 1))
    assert np.array_equal(one, two) and not np.array_equal(one, other)


def test_edge_dropout_loses_its_share_of_edge_pixels_only():
    image = step_image()
    noisy = add_noise(image, with_(edge_dropout=0.5), np.random.default_rng(3))
    lost = np.nonzero(~noisy.valid)[1]
    assert set(lost) == {99, 100}
    assert len(lost) == pytest.approx(200, abs=50)
    assert (noisy.depth[~noisy.valid] == 0).all()


def test_edges_are_not_seen_across_holes():
    image = step_image(10)
    valid = image.valid.copy()
    valid[:, 4:6] = False
    assert not depth_edges(image.depth, valid, 0.01)[:, [0, 1, 2, 8, 9]].any()
    assert depth_edges(image.depth, image.valid, 0.01)[:, 4:6].all()


def test_correlated_noise_has_its_deviation_and_correlation():
    image = step_image()
    noisy = add_noise(image, with_(field_sigma=0.005, field_length=4), np.random.default_rng(4))
    error = (noisy.depth - image.depth).astype(float)
    assert error.std() == pytest.approx(0.005, rel=0.1)
    assert np.corrcoef(error[:, :-4].ravel(), error[:, 4:].ravel())[0, 1] == pytest.approx(np.exp(-0.5), abs=0.1)
    assert abs(np.corrcoef(error[:, :-16].ravel(), error[:, 16:].ravel())[0, 1]) < 0.1


def test_gain_scales_the_whole_image():
    image = step_image()
    gains = [
        add_noise(image, with_(gain_sigma=0.03), np.random.default_rng(seed)).depth / image.depth for seed in range(60)
    ]
    assert all(np.ptp(gain) < 1e-6 for gain in gains)
    assert np.std([gain[0, 0] for gain in gains]) == pytest.approx(0.03, rel=0.35)


def test_holes_travel_with_the_jitter_and_stay_holes():
    image = step_image()
    holed = DepthImage.from_array(np.where(np.arange(200)[:, None] < 50, np.nan, image.depth), image.camera)
    noisy = add_noise(holed, ImageNoise(), np.random.default_rng(5))
    assert not noisy.valid[:46].any() and noisy.valid[54:].all()


@pytest.mark.parametrize(
    "field, value", [("sigma_d", -1.0), ("edge_dropout", 1.5), ("field_length", 0.5), ("edge_step", 0.0)]
)
def test_impossible_settings_are_refused(field, value, tmp_path):
    path = tmp_path / "noise.yaml"
    path.write_text(f"{field}: {value}\n")
    with pytest.raises(ConfigError, match=field):
        load_noise(path)
