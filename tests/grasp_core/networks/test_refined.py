import pytest
import torch

from grasp_core.networks.refined import BasicBlock, RefinedNetwork


@pytest.mark.parametrize(("width", "millions"), [(16, 0.70), (64, 11.17)])
def test_parameters_of_both_widths(width: int, millions: float) -> None:
    network = RefinedNetwork(width)
    assert sum(p.numel() for p in network.parameters()) / 1e6 == pytest.approx(millions, abs=0.01)
    assert sum(isinstance(m, BasicBlock) for m in network.modules()) == 8


@pytest.mark.parametrize("size", [32, 48, 64])
def test_two_logits_for_every_crop(size: int) -> None:
    assert RefinedNetwork(8)(torch.zeros(3, 1, size, size)).shape == (3, 2)


def test_learns_to_tell_two_patterns_apart() -> None:
    torch.manual_seed(0)
    network = RefinedNetwork(4)
    crops = torch.zeros(32, 1, 48, 48)
    crops[:16, :, 20:28, :] = 1.0
    crops[16:, :, :, 20:28] = 1.0
    crops += 0.05 * torch.randn_like(crops)
    labels = torch.arange(32) // 16
    optimizer = torch.optim.Adam(network.parameters(), 1e-2)
    losses = []
    for _ in range(12):
        loss = torch.nn.functional.cross_entropy(network(crops), labels)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        losses.append(float(loss.detach()))
    assert losses[-1] < 0.2 * losses[0]
