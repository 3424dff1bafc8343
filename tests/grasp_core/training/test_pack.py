from pathlib import Path

import numpy as np
import pytest
import torch

from grasp_core.errors import ConfigError, MismatchError
from grasp_core.gripper import load_gripper
from grasp_core.networks.refined import RefinedNetwork
from grasp_core.networks.regression import RegressionNetwork
from grasp_core.networks.runtime import load_runtime
from grasp_core.networks.weights import CropSpec
from grasp_core.training.pack import Part, load_part, pack, save_part


def part(network: str, physics: str = "p") -> Part:
    gripper = load_gripper()
    return Part(
        network=network,  # type: ignore[arg-type]
        gripper=gripper.name,
        gripper_digest=gripper.digest,
        physics=physics,
        crop=CropSpec(size=32),
        width=4,
        recipe={"objects": 3},
        metrics={"auc": 0.5},
    )


def test_packs_two_networks_that_run(tmp_path: Path) -> None:
    torch.manual_seed(0)
    regression, refined = RegressionNetwork().eval(), RefinedNetwork(4).eval()
    save_part(tmp_path, regression, part("regression"))
    save_part(tmp_path, refined, part("refined"))
    meta = pack(tmp_path, tmp_path, tmp_path / "tiny.safetensors")
    assert meta.name == "tiny"
    assert meta.metrics == {"regression_auc": 0.5, "refined_auc": 0.5}
    assert meta.recipe["refined_objects"] == 3
    runtime = load_runtime(tmp_path / "tiny.safetensors", threads=1)
    assert runtime.meta == meta
    crops = np.random.default_rng(0).normal(size=(5, 32, 32)).astype(np.float32)
    with torch.no_grad():
        wanted = torch.softmax(refined(torch.from_numpy(crops)[:, None]), 1)[:, 1].numpy()
    np.testing.assert_allclose(runtime.scores(crops), wanted, atol=0.005)  # half precision storage


def test_refuses_networks_of_different_physics(tmp_path: Path) -> None:
    save_part(tmp_path, RegressionNetwork(), part("regression"))
    save_part(tmp_path, RefinedNetwork(4), part("refined", physics="other"))
    with pytest.raises(MismatchError, match="physics"):
        pack(tmp_path, tmp_path, tmp_path / "x.safetensors")


def test_missing_and_damaged_networks_are_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="grasp-core train refined"):
        load_part(tmp_path, "refined")
    (tmp_path / "refined.safetensors").write_bytes(b"nothing")
    with pytest.raises(ConfigError, match="no trained network"):
        load_part(tmp_path, "refined")
