"""From finished training runs to one weights file.

Each trained network is kept in its run folder as `NAME.safetensors` in full precision with its own metadata; packing
joins a Regression and a Refined Network that were made for the same gripper and physics.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Literal

import msgspec
import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save
from torch import nn

from grasp_core import config
from grasp_core.errors import ConfigError, MismatchError
from grasp_core.networks.modules import tensors
from grasp_core.networks.weights import CropSpec, View, Weights, code_version, save_weights

Network = Literal["regression", "refined"]
_KEY = "grasp-workbench-part"


class Part(config.Settings):
    """What a trained network says about itself; the fields mean what they mean in `Weights`."""

    network: Network
    gripper: str
    gripper_digest: str
    physics: str
    view: View = View()
    crop: CropSpec = CropSpec()
    width: int = 0
    recipe: dict[str, str | int | float] = msgspec.field(default_factory=dict)
    metrics: dict[str, float] = msgspec.field(default_factory=dict)


def save_part(folder: Path, network: nn.Module, part: Part) -> Path:
    """Keep a trained network in its run folder."""
    path = folder / f"{part.network}.safetensors"
    state = {name: np.ascontiguousarray(array) for name, array in tensors(network, part.network).items()}
    text = msgspec.json.encode(part).decode()
    temporary = path.with_name(path.name + ".part")
    temporary.write_bytes(save(state, {_KEY: text}))
    os.replace(temporary, path)
    return path


def load_part(folder: Path, network: Network) -> tuple[Part, dict[str, NDArray]]:
    """Read a trained network of a run folder.

    Raises:
        ConfigError: it was not trained there, or the file is damaged.
    """
    path = folder / f"{network}.safetensors"
    if not path.is_file():
        raise ConfigError(f"{path}: is not there; run `grasp-core train {network} --out {folder}` first")
    try:
        with safe_open(path, framework="numpy") as file:
            part = msgspec.json.decode((file.metadata() or {})[_KEY], type=Part)
            return part, {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    except (SafetensorError, OSError, KeyError, msgspec.DecodeError) as error:
        raise ConfigError(f"{path}: holds no trained network ({error}); train it again") from error


def pack(regression: Path, refined: Path, out: Path, name: str | None = None) -> Weights:
    """Join the networks of two run folders (or one) into a weights file.

    Args:
        regression: run folder of the Regression Network.
        refined: run folder of the Refined Network.
        out: the file; its name ends in .safetensors.
        name: what people call the weights; the file's name when None.

    Returns:
        The metadata that was written; metrics and recipe entries carry the network's name before theirs.

    Raises:
        ConfigError: a network is missing, or the file cannot be written.
        MismatchError: the networks were made for different grippers, views or physics.
    """
    first, first_state = load_part(regression, "regression")
    second, second_state = load_part(refined, "refined")
    for field in ("gripper_digest", "view", "physics"):
        if getattr(first, field) != getattr(second, field):
            raise MismatchError(
                f"{regression} and {refined}: the networks differ in {field} ({getattr(first, field)},"
                f" {getattr(second, field)}); train both on the same data"
            )
    meta = Weights(
        name=name or out.stem,
        gripper=second.gripper,
        gripper_digest=second.gripper_digest,
        view=second.view,
        crop=second.crop,
        width=second.width,
        physics=second.physics,
        recipe={f"{part.network}_{key}": value for part in (first, second) for key, value in part.recipe.items()},
        metrics={f"{part.network}_{key}": value for part in (first, second) for key, value in part.metrics.items()},
        code=code_version(),
    )
    save_weights(out, {**first_state, **second_state}, meta)
    return meta
