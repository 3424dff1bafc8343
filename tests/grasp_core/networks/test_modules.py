from collections.abc import Callable
from pathlib import Path

import msgspec
import pytest
import torch

from grasp_core.errors import ConfigError
from grasp_core.networks.modules import load_modules
from grasp_core.networks.weights import Checkpoint, load_weights


def test_loaded_networks_compute_what_was_saved(make_weights: Callable[..., Path]) -> None:
    first = load_modules(load_weights(make_weights(name="a")))
    second = load_modules(load_weights(make_weights(name="b")))
    crops = torch.randn(4, 1, 48, 48)
    torch.testing.assert_close(first[1].eval()(crops), second[1].eval()(crops))
    assert float(first[1].state_dict()["bn.running_var"].mean()) != 1.0


def test_wrong_width_is_refused(make_weights: Callable[..., Path]) -> None:
    checkpoint = load_weights(make_weights(width=8))
    wrong = Checkpoint(
        msgspec.structs.replace(checkpoint.meta, width=16), checkpoint.state, checkpoint.digest, checkpoint.path
    )
    with pytest.raises(ConfigError, match="refined network has other layers"):
        load_modules(wrong)
