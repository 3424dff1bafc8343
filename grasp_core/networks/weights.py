"""Weights files: both networks in one safetensors file, with what they were made for in its metadata.

Matrices are stored in half precision, vectors (biases, normalisation) in single. The tensors are named `regression.*`
and `refined.*`. Nothing here needs torch.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import metadata, resources
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save

from grasp_core import config
from grasp_core.camera import CANONICAL_HEIGHT, canonical_camera
from grasp_core.errors import ConfigError, MismatchError
from grasp_core.gripper import Gripper

State = Mapping[str, NDArray]
"""Tensor name → array."""

_KEY = "grasp-workbench"
_REQUIRED = {"regression.head.weight": 4, "refined.fc.weight": 2}


class CropSpec(config.Settings):
    """How a grasp candidate is cut out of the canonical depth.

    Attributes:
        size: side of the square crop, pixels.
        context: side of the square in the scene, in gripper openings at the grasp's depth.
    """

    size: int = 48
    context: float = 1.4

    def __post_init__(self) -> None:
        if self.size < 16 or self.context <= 0:
            raise ValueError(f"a crop needs at least 16 pixels and a context above 0, not {self.size}, {self.context}")


class View(config.Settings):
    """The view that the networks know: a camera straight down, `height` metres up, `focal` pixels."""

    height: float = CANONICAL_HEIGHT
    focal: float = canonical_camera().intrinsics.fx


class Weights(config.Settings):
    """What a weights file says about itself.

    Attributes:
        name: what people call these weights.
        gripper: name of the gripper whose grasps the labels judged.
        gripper_digest: its digest.
        view: the canonical view.
        crop: the Refined Network's input.
        width: channels of the Refined Network's first stage.
        physics: digest of the physics settings that made the labels, "" when unknown.
        recipe: the data: recipe name, numbers of objects, scenes and grasps, and the training settings.
        metrics: name → value on validation objects (and test objects, `test_` before the name).
        code: version of this package that trained them.
    """

    name: str
    gripper: str
    gripper_digest: str
    view: View = View()
    crop: CropSpec = CropSpec()
    width: int = 16
    physics: str = ""
    recipe: dict[str, str | int | float] = msgspec.field(default_factory=dict)
    metrics: dict[str, float] = msgspec.field(default_factory=dict)
    code: str = ""

    def check(self, gripper: Gripper | None = None, view: View | None = None) -> None:
        """Refuse another gripper or canonical view than these weights were made for.

        Raises:
            MismatchError: they differ; the message says how.
        """
        if gripper is not None and gripper.digest != self.gripper_digest:
            raise MismatchError(
                f"the weights '{self.name}' judge grasps of the gripper '{self.gripper}' ({self.gripper_digest}),"
                f" not of '{gripper.name}' ({gripper.digest}); use that gripper, or train weights for this one"
            )
        if self.view != (view or View()):
            wanted = view or View()
            raise MismatchError(
                f"the weights '{self.name}' know a view from {self.view.height} m with focal length {self.view.focal}"
                f" px, not from {wanted.height} m with {wanted.focal} px; train weights for this view"
            )


@dataclass(frozen=True)
class Checkpoint:
    """Loaded weights.

    Attributes:
        meta: what the file says about itself.
        state: tensor name → float32 array, names as in the file.
        digest: hash of the file.
        path: the file.
    """

    meta: Weights
    state: dict[str, NDArray[np.float32]]
    digest: str
    path: Path

    def part(self, network: str) -> dict[str, NDArray[np.float32]]:
        """The tensors of "regression" or "refined", without that prefix."""
        prefix = network + "."
        return {name[len(prefix) :]: array for name, array in self.state.items() if name.startswith(prefix)}


def code_version() -> str:
    """Version of this package, for the metadata."""
    return metadata.version("grasp-workbench")


def shipped_weights() -> dict[str, Path]:
    """Name → file of the weights that come with the package."""
    folder = Path(str(resources.files("grasp_core.networks"))) / "weights"
    return {path.stem: path for path in sorted(folder.glob("*.safetensors"))}


def save_weights(path: Path, state: State, meta: Weights) -> Path:
    """Write a weights file, whole or not at all.

    Args:
        path: the file; its name must end in .safetensors.
        state: tensors of both networks; counters of integer type are left out.
        meta: the metadata.

    Raises:
        ConfigError: wrong name, missing network, not finite, or the file cannot be written.
    """
    if path.suffix != ".safetensors":
        raise ConfigError(f"{path}: a weights file's name ends in .safetensors")
    stored: dict[str, NDArray] = {}
    for name, array in state.items():
        if array.dtype.kind != "f":
            continue
        with np.errstate(over="ignore"):
            kept = array.astype(np.float16 if array.ndim > 1 else np.float32)
        if not np.isfinite(kept).all():
            raise ConfigError(f"{path}: the tensor {name} is not finite in the stored precision; train again")
        stored[name] = np.ascontiguousarray(kept)
    _require_both(stored, path)
    data = save(stored, {_KEY: msgspec.json.encode(meta).decode()})
    part = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part.write_bytes(data)
        os.replace(part, path)
    except OSError as error:
        raise ConfigError(f"{path}: cannot be written ({error.strerror})") from error
    return path


def load_weights(name: str | Path = "default") -> Checkpoint:
    """Read shipped weights by name, or a file whose name ends in .safetensors.

    Raises:
        ConfigError: no such weights, or a file that is damaged or holds something else.
    """
    path = Path(name).expanduser()
    if path.suffix != ".safetensors":
        shipped = shipped_weights()
        if str(name) not in shipped:
            raise ConfigError(
                f"no weights are called '{name}'; choose one of: {', '.join(shipped) or '(none shipped)'}, or give a"
                " path that ends in .safetensors"
            )
        path = shipped[str(name)]
    try:
        digest = hashlib.sha256(path.read_bytes()).hexdigest()[:12]
        with safe_open(path, framework="numpy") as file:
            text = (file.metadata() or {}).get(_KEY)
            state = {key: file.get_tensor(key).astype(np.float32) for key in file.keys()}  # noqa: SIM118
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read ({error.strerror or error})") from error
    except SafetensorError as error:
        raise ConfigError(f"{path}: is no safetensors file ({error}); fetch or train the weights again") from error
    if text is None:
        raise ConfigError(f"{path}: holds no metadata of this project; make weights with `grasp-core train`")
    try:
        meta = msgspec.json.decode(text, type=Weights)
    except msgspec.ValidationError as error:
        raise ConfigError(f"{path}: metadata: {error}; the file comes from another version of this project") from error
    _require_both(state, path)
    return Checkpoint(meta, state, digest, path)


def _require_both(state: State, path: Path) -> None:
    for name, ndim in _REQUIRED.items():
        if name not in state or state[name].ndim != ndim:
            raise ConfigError(f"{path}: holds no {name.split('.')[0]} network ({name} is missing); pack both networks")
