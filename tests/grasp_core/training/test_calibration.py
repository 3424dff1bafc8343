import numpy as np
import pytest
import torch

from grasp_core.errors import GraspError
from grasp_core.training.calibration import fit_temperature, fold_temperature, log_loss
from grasp_core.training.metrics import ece


@pytest.mark.parametrize("factor", [0.3, 1.0, 4.0])
def test_finds_the_factor_that_spoiled_the_margins(factor: float) -> None:
    rng = np.random.default_rng(0)
    true = rng.normal(0, 2, 30_000)
    labels = (rng.random(len(true)) < 1 / (1 + np.exp(-true))).astype(float)
    temperature = fit_temperature(true * factor, labels)
    assert temperature == pytest.approx(factor, rel=0.05)
    assert ece(1 / (1 + np.exp(-true * factor / temperature)), labels) < 0.02


def test_no_other_temperature_is_better() -> None:
    rng = np.random.default_rng(1)
    margins = rng.normal(0, 3, 500)
    labels = np.clip(1 / (1 + np.exp(-margins / 2)) + rng.normal(0, 0.1, 500), 0, 1)
    best = fit_temperature(margins, labels)
    others = [log_loss(margins, labels, t) for t in (0.5 * best, 0.9 * best, 1.1 * best, 2 * best)]
    assert min(others) >= log_loss(margins, labels, best)


def test_folding_divides_the_logits() -> None:
    layer = torch.nn.Linear(5, 2)
    x = torch.randn(3, 5)
    before = layer(x).detach()
    fold_temperature(layer, 2.5)
    torch.testing.assert_close(layer(x).detach(), before / 2.5)


def test_needs_grasps() -> None:
    with pytest.raises(GraspError, match="at least one"):
        fit_temperature([], [])
