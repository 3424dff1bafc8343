import numpy as np
import pytest

from grasp_core.networks.regression import RegressionNetwork

pytest.importorskip("openvino")
import torch

from grasp_core.networks.openvino_models import compile_models, refined_model, regression_model
from grasp_core.networks.refined import RefinedNetwork


def arrays(network: torch.nn.Module) -> dict[str, np.ndarray]:
    return {name: tensor.numpy() for name, tensor in network.state_dict().items()}


def test_models_equal_the_torch_modules_layer_for_layer() -> None:
    torch.manual_seed(1)
    regression, refined = RegressionNetwork().eval(), RefinedNetwork(8)
    with torch.no_grad():
        regression.head.weight.mul_(30)
        for _ in range(3):
            refined(3 * torch.randn(16, 1, 32, 32))
    refined.eval()
    first, second = compile_models(arrays(regression), arrays(refined), 32, threads=1, precision="f32")
    image, crops = torch.randn(2, 1, 60, 84), 3 * torch.randn(5, 1, 32, 32)
    with torch.no_grad():
        wanted_map, wanted = regression(image), torch.softmax(refined(crops), 1)
    assert float(wanted_map.std()) > 0.01
    assert float(wanted.std()) > 0.01
    np.testing.assert_allclose(first.infer([image.numpy()])[0], wanted_map.numpy(), atol=1e-4)
    np.testing.assert_allclose(second.infer([crops.numpy()])[0], wanted.numpy(), atol=1e-4)


def test_models_state_their_shapes() -> None:
    model = regression_model(arrays(RegressionNetwork()))
    assert model.input(0).partial_shape.to_string() == "[?,1,?,?]"
    assert refined_model(arrays(RefinedNetwork(4)), 48).output(0).partial_shape.to_string() == "[?,2]"
