from collections.abc import Callable
from pathlib import Path

import pytest
import torch

from grasp_core.gripper import load_gripper
from grasp_core.networks.modules import tensors
from grasp_core.networks.refined import RefinedNetwork
from grasp_core.networks.regression import RegressionNetwork
from grasp_core.networks.weights import CropSpec, Weights, save_weights

Maker = Callable[..., Path]


def random_networks(width: int) -> tuple[RegressionNetwork, RefinedNetwork]:
    """Untrained networks whose normalisation has seen data and whose outputs vary."""
    torch.manual_seed(3)
    regression, refined = RegressionNetwork(), RefinedNetwork(width)
    refined.train()
    with torch.no_grad():
        for _ in range(5):
            refined(2 * torch.randn(32, 1, 48, 48) + 0.5)
        refined.fc.weight.mul_(4)
        regression.head.weight.mul_(20)
    return regression.eval(), refined.eval()


@pytest.fixture
def make_weights(tmp_path: Path) -> Maker:
    def make(width: int = 8, name: str = "tiny", size: int = 48, **meta: object) -> Path:
        gripper = load_gripper()
        regression, refined = random_networks(width)
        state = {**tensors(regression, "regression"), **tensors(refined, "refined")}
        told = {"gripper": gripper.name, "gripper_digest": gripper.digest, "crop": CropSpec(size=size), **meta}
        return save_weights(tmp_path / f"{name}.safetensors", state, Weights(name=name, width=width, **told))  # type: ignore[arg-type]

    return make
