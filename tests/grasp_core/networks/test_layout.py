import math

import torch

from grasp_core.networks.layout import BLOCKS, EPSILON, STRIDE
from grasp_core.networks.refined import RefinedNetwork
from grasp_core.networks.regression import RegressionNetwork


def test_stride_is_the_product_of_the_convolutions_strides() -> None:
    network = RegressionNetwork()
    assert math.prod(layer.stride[0] for layer in (network.conv1, network.conv2, network.conv3)) == STRIDE
    assert math.prod(layer.stride[0] for layer in (network.up1, network.up2, network.up3)) == STRIDE


def test_blocks_and_epsilon_are_those_of_the_refined_network() -> None:
    network = RefinedNetwork(4)
    assert tuple(len(stage) for stage in network.stages) == BLOCKS  # type: ignore[arg-type]
    norms = [module for module in network.modules() if isinstance(module, torch.nn.BatchNorm2d)]
    assert {norm.eps for norm in norms} == {EPSILON}
