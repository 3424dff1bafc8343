import pytest
import torch

from grasp_core.networks.regression import RegressionNetwork


def test_six_layers_with_the_paper_s_kernels() -> None:
    network = RegressionNetwork()
    convolutions = [m for m in network.children() if isinstance(m, torch.nn.Conv2d | torch.nn.ConvTranspose2d)][:6]
    assert [m.kernel_size[0] for m in convolutions] == [9, 5, 3, 3, 5, 9]
    assert [m.stride[0] for m in convolutions] == [3, 2, 2, 2, 2, 3]
    assert [m.out_channels for m in convolutions] == [32, 16, 8, 8, 16, 32]


@pytest.mark.parametrize("shape", [(300, 300), (301, 257), (12, 40), (7, 5)])
def test_any_size_comes_back(shape: tuple[int, int]) -> None:
    assert RegressionNetwork()(torch.zeros(2, 1, *shape)).shape == (2, 1, *shape)


def test_map_moves_with_the_image() -> None:
    """A shift by one innermost cell shifts the map by as much: layers and their twins share centres."""
    network = RegressionNetwork().eval()
    image = torch.zeros(1, 1, 240, 240)
    image[..., 100:130, 110:125] = 1.0
    with torch.no_grad():
        quality = network(image)
        shifted = network(torch.roll(image, (12, 24), dims=(2, 3)))
    inner = torch.roll(quality, (12, 24), dims=(2, 3))[..., 60:200, 60:200]
    torch.testing.assert_close(shifted[..., 60:200, 60:200], inner, atol=1e-6, rtol=1e-5)


def test_map_is_centred_on_what_it_sees() -> None:
    """With positive kernels, a symmetric blob gives a map whose centre of mass is the blob's, within 2 px."""
    network = RegressionNetwork().eval()
    for name, parameter in network.named_parameters():
        parameter.data.fill_(0.05 if name.endswith("weight") else 0.0)
    image = torch.zeros(1, 1, 240, 240)
    image[..., 97:146, 97:146] = 1.0
    with torch.no_grad():
        quality = network(image)[0, 0]
    rows = torch.arange(240, dtype=torch.float32)
    centre = (quality.sum(1) * rows).sum() / quality.sum()
    assert abs(float(centre) - 121.0) < 2.0
