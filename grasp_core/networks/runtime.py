"""Running both networks at planning time: OpenVINO on the CPU without torch where it is installed, else torch.

A runtime takes and gives numpy arrays, may be called from several threads, and warms itself up when loaded.
"""

from __future__ import annotations

import importlib.util
import threading
from abc import ABC, abstractmethod
from pathlib import Path
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from grasp_core.errors import ConfigError, ImageError
from grasp_core.networks.weights import Checkpoint, Weights, load_weights

Array = NDArray[np.float32]
Backend = Literal["auto", "openvino", "torch"]
Precision = Literal["auto", "f32", "bf16"]

_SIDES = (180, 240, 300)
"""Pixels, multiples of `STRIDE`: images are filled up to squares of these. OpenVINO takes 13 ms, nearly half a plan, to
make itself ready for a size that it has not met, and keeps 2 MB of it; so networks meet few sizes."""
_STEP = 60
"""Pixels, a multiple of `STRIDE`: sides of larger images are filled up to multiples of it."""
_BLOCK, _PORTION = 64, 16
"""Crops: OpenVINO scores blocks of 64, of which the last one is filled up to a multiple of 16."""


class Runtime(Protocol):
    """Both networks, loaded.

    Attributes:
        meta: of the weights.
        digest: of the weights file.
        backend: "openvino" or "torch", with "-bf16" or "-cuda" where it is not single precision on the CPU.
    """

    meta: Weights
    digest: str
    backend: str

    def quality_map(self, x: Array) -> Array:
        """Heights in network units (`inputs.regression_input`) (N, H, W) → quality maps (N, H, W), unbounded."""
        ...

    def scores(self, crops: Array) -> Array:
        """Crops (N, S, S) → P(class 1) (N,), in [0, 1]."""
        ...


def load_runtime(
    weights: str | Path = "default",
    backend: Backend = "auto",
    *,
    threads: int | None = None,
    precision: Precision = "f32",
) -> Runtime:
    """Load weights and make them ready to run.

    Args:
        weights: shipped name or path of a .safetensors file.
        backend: "auto" takes OpenVINO where it is installed, else torch (on CUDA where there is a device).
        threads: CPU threads; all cores when None.
        precision: "bf16" is several times faster on processors that have it; scores then differ by up to 0.03. "auto"
            takes it with OpenVINO on such a processor, else "f32".

    Raises:
        ConfigError: no such weights or backend.
    """
    if threads is not None and threads < 1:
        raise ConfigError(f"threads must be at least 1, not {threads}")
    checkpoint = load_weights(weights)
    if backend == "auto":
        backend = "openvino" if importlib.util.find_spec("openvino") else "torch"
    runtime: _Base
    if backend == "openvino":
        runtime = OpenVinoRuntime(checkpoint, threads, precision)
    elif backend == "torch":
        runtime = TorchRuntime(checkpoint, threads, "f32" if precision == "auto" else precision)
    else:
        raise ConfigError(f"no inference backend is called '{backend}'; choose one of: auto, openvino, torch")
    runtime.warm_up()
    return runtime


def _filled(height: int, width: int) -> tuple[int, int]:
    """Height and width that an image is filled up to."""
    larger = max(height, width)
    for side in _SIDES:
        if larger <= side:
            return side, side
    return height + -height % _STEP, width + -width % _STEP


class _Base(ABC):
    """Shapes, padding and locking that both backends share."""

    def __init__(self, checkpoint: Checkpoint, backend: str) -> None:
        self.meta = checkpoint.meta
        self.digest = checkpoint.digest
        self.backend = backend
        self._lock = threading.Lock()

    def quality_map(self, x: Array) -> Array:
        """See `Runtime`.

        Raises:
            ImageError: x is not (N, H, W).
        """
        if x.ndim != 3:
            raise ImageError(f"quality maps are made of images (N, H, W), not of shape {x.shape}; add the first axis")
        count, height, width = x.shape
        if x.size == 0:
            return np.zeros(x.shape, np.float32)
        padded = np.zeros((count, 1, *_filled(height, width)), np.float32)
        padded[:, 0, :height, :width] = x
        with self._lock:
            return np.ascontiguousarray(self._regression(padded)[:, 0, :height, :width])

    def scores(self, crops: Array) -> Array:
        """See `Runtime`.

        Raises:
            ImageError: crops are not (N, S, S) with the S of the weights.
        """
        size = self.meta.crop.size
        if crops.ndim != 3 or crops.shape[1:] != (size, size):
            raise ImageError(f"these weights score crops (N, {size}, {size}), not of shape {crops.shape}")
        if len(crops) == 0:
            return np.zeros(0, np.float32)
        batch = np.ascontiguousarray(crops, np.float32)[:, None]
        with self._lock:
            return np.ascontiguousarray(self._refined(batch)[:, 1])

    def warm_up(self) -> None:
        """Run each network once at each of its usual sizes, so that the first plan is as fast as the next."""
        for side in _SIDES:
            self.quality_map(np.zeros((1, side, side), np.float32))
        for count in range(_PORTION, _BLOCK + 1, _PORTION):
            self.scores(np.zeros((count, self.meta.crop.size, self.meta.crop.size), np.float32))

    @abstractmethod
    def _regression(self, x: Array) -> Array: ...

    @abstractmethod
    def _refined(self, x: Array) -> Array: ...


class OpenVinoRuntime(_Base):
    """OpenVINO on the CPU, tuned for latency."""

    def __init__(self, checkpoint: Checkpoint, threads: int | None = None, precision: Precision = "f32") -> None:
        from grasp_core.networks.openvino_models import compile_models, native_bf16

        if precision == "auto":
            precision = "bf16" if native_bf16() else "f32"
        super().__init__(checkpoint, "openvino" if precision == "f32" else f"openvino-{precision}")
        self._regression_request, self._refined_request = compile_models(
            checkpoint.part("regression"),
            checkpoint.part("refined"),
            self.meta.crop.size,
            threads=threads,
            precision=precision,
        )

    def _regression(self, x: Array) -> Array:
        return np.asarray(self._regression_request.infer([x], share_inputs=True)[0])

    def _refined(self, x: Array) -> Array:
        scores = np.empty((len(x), 2), np.float32)
        for start in range(0, len(x), _BLOCK):
            block = x[start : start + _BLOCK]
            count = len(block)
            block = np.pad(block, ((0, -count % _PORTION), (0, 0), (0, 0), (0, 0)))
            scores[start : start + count] = self._refined_request.infer([block], share_inputs=True)[0][:count]
        return scores


class TorchRuntime(_Base):
    """Torch on CUDA where there is a device, else on the CPU."""

    def __init__(self, checkpoint: Checkpoint, threads: int | None = None, precision: Precision = "f32") -> None:
        import torch

        from grasp_core.networks.modules import load_modules

        device = "cuda" if torch.cuda.is_available() else "cpu"
        super().__init__(checkpoint, "torch" if device == "cpu" else f"torch-{device}")
        if threads is not None:
            torch.set_num_threads(threads)
        self._torch = torch
        self._device = device
        self._type = torch.bfloat16 if precision == "bf16" else torch.float32
        self._modules = tuple(
            module.eval().to(device, self._type).to(memory_format=torch.channels_last)  # type: ignore[call-overload]
            for module in load_modules(checkpoint)
        )

    def _run(self, module: int, x: Array) -> Array:
        torch = self._torch
        with torch.inference_mode():
            moved = torch.from_numpy(x).to(self._device, self._type, memory_format=torch.channels_last)
            y = self._modules[module](moved)
            y = y.float() if module == 0 else torch.softmax(y.float(), 1)
            return np.asarray(y.cpu().numpy())

    def _regression(self, x: Array) -> Array:
        return self._run(0, x)

    def _refined(self, x: Array) -> Array:
        return self._run(1, x)
