"""Between weights files and torch modules."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from grasp_core.errors import ConfigError
from grasp_core.networks.refined import RefinedNetwork
from grasp_core.networks.regression import RegressionNetwork
from grasp_core.networks.weights import Checkpoint


def tensors(network: nn.Module, prefix: str) -> dict[str, NDArray]:
    """A network's tensors as arrays, named `prefix.…`, for `save_weights`."""
    return {f"{prefix}.{name}": tensor.detach().cpu().numpy() for name, tensor in network.state_dict().items()}


def load_modules(checkpoint: Checkpoint) -> tuple[RegressionNetwork, RefinedNetwork]:
    """Both networks with the weights of a file.

    Raises:
        ConfigError: the tensors do not fit the networks.
    """
    regression, refined = RegressionNetwork(), RefinedNetwork(checkpoint.meta.width)
    for name, network in (("regression", regression), ("refined", refined)):
        given: dict[str, NDArray[np.float32]] = checkpoint.part(name)
        own = network.state_dict()
        wanted = {key: tuple(value.shape) for key, value in own.items() if value.is_floating_point()}
        if wanted != {key: value.shape for key, value in given.items()}:
            raise ConfigError(
                f"{checkpoint.path}: its {name} network has other layers than this version's; train the weights again"
            )
        network.load_state_dict({**own, **{key: torch.from_numpy(value) for key, value in given.items()}})
    return regression, refined
