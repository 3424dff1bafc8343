from collections.abc import Callable
from pathlib import Path

import msgspec
import numpy as np
import pytest
from safetensors.numpy import save_file

from grasp_core.errors import ConfigError, MismatchError
from grasp_core.gripper import load_gripper
from grasp_core.networks.weights import CropSpec, View, Weights, load_weights, save_weights, shipped_weights

Maker = Callable[..., Path]


def test_round_trip_keeps_metadata_and_tensors(make_weights: Maker) -> None:
    path = make_weights(width=8, metrics={"auc": 0.5}, recipe={"objects": 3, "name": "x"}, physics="abc")
    checkpoint = load_weights(path)
    assert checkpoint.meta.width == 8
    assert checkpoint.meta.metrics == {"auc": 0.5}
    assert checkpoint.meta.recipe == {"objects": 3, "name": "x"}
    assert checkpoint.meta.physics == "abc"
    assert len(checkpoint.digest) == 12
    assert set(checkpoint.part("refined")) | set(checkpoint.part("regression"))
    assert checkpoint.part("refined")["fc.weight"].shape == (2, 64)
    assert all(array.dtype == np.float32 for array in checkpoint.state.values())
    assert not any("num_batches" in name for name in checkpoint.state)


def test_digest_follows_the_content(make_weights: Maker) -> None:
    same = load_weights(make_weights(name="a")).digest
    other = load_weights(make_weights(name="b")).digest
    assert same == load_weights(make_weights(name="a")).digest
    assert same != other


def test_matrices_are_stored_in_half_precision(make_weights: Maker) -> None:
    path = make_weights(width=16)
    assert path.stat().st_size < 2_000_000
    assert not path.with_name(path.name + ".part").exists()


def test_refuses_another_gripper_or_view(make_weights: Maker) -> None:
    meta = load_weights(make_weights()).meta
    gripper = load_gripper()
    meta.check(gripper)
    wide = msgspec.structs.replace(gripper, opening=0.09)
    with pytest.raises(MismatchError, match="gripper 'paper'"):
        meta.check(wide)
    with pytest.raises(MismatchError, match=r"0\.5 m"):
        meta.check(view=View(height=0.5))


def test_unknown_name_lists_the_shipped_ones() -> None:
    with pytest.raises(ConfigError, match="choose one of"):
        load_weights("no_such_weights")


def test_shipped_weights_load_and_fit_the_shipped_gripper() -> None:
    assert "default" in shipped_weights()
    for path in shipped_weights().values():
        load_weights(path).meta.check(load_gripper())  # raises where they do not fit


@pytest.mark.parametrize("content", [b"", b"not a tensor file at all"])
def test_damaged_file_is_named(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "broken.safetensors"
    path.write_bytes(content)
    with pytest.raises(ConfigError, match=r"broken\.safetensors"):
        load_weights(path)


def test_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"none\.safetensors"):
        load_weights(tmp_path / "none.safetensors")


def test_foreign_safetensors_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "foreign.safetensors"
    save_file({"a": np.zeros(3, np.float32)}, path)
    with pytest.raises(ConfigError, match="no metadata of this project"):
        load_weights(path)


def test_unknown_metadata_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "later.safetensors"
    save_file({"a": np.zeros(3, np.float32)}, path, {"grasp-workbench": '{"name": "x", "later": 1}'})
    with pytest.raises(ConfigError, match="metadata"):
        load_weights(path)


def test_both_networks_must_be_there_and_finite(tmp_path: Path) -> None:
    gripper = load_gripper()
    meta = Weights(name="x", gripper=gripper.name, gripper_digest=gripper.digest)
    with pytest.raises(ConfigError, match="refined network"):
        save_weights(tmp_path / "x.safetensors", {"regression.head.weight": np.zeros((1, 32, 1, 1))}, meta)
    with pytest.raises(ConfigError, match="not finite"):
        save_weights(tmp_path / "x.safetensors", {"refined.fc.weight": np.full((2, 8), 1e9)}, meta)
    with pytest.raises(ConfigError, match=r"\.safetensors"):
        save_weights(tmp_path / "x.bin", {}, meta)


def test_crop_spec_refuses_nonsense() -> None:
    with pytest.raises(ValueError, match="16 pixels"):
        CropSpec(size=4)
