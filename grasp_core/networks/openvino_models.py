"""Both networks as OpenVINO models, built layer by layer from their tensors: no torch, no conversion, no file.

The layers mirror `regression.py` and `refined.py`; a test compares their outputs. Normalisation is folded into the
convolution before it.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grasp_core.networks.layout import BLOCKS, EPSILON

# The library's telemetry opens connections on import; without that package the library falls back to a stub of its own.
if "openvino" not in sys.modules:
    sys.modules.setdefault("openvino_telemetry", None)  # type: ignore[arg-type]

import openvino
from openvino import opset13 as ops

Tensors = Mapping[str, NDArray[np.float32]]


def _conv(x: Any, weight: NDArray, bias: NDArray, stride: int) -> Any:
    pad = weight.shape[-1] // 2 if weight.shape[-1] != 9 else 3
    y = ops.convolution(x, ops.constant(weight), [stride] * 2, [pad] * 2, [pad] * 2, [1, 1])
    return ops.add(y, ops.constant(bias.reshape(1, -1, 1, 1)))


def _up(x: Any, weight: NDArray, bias: NDArray, stride: int, pad: int, extra: int) -> Any:
    y = ops.convolution_backprop_data(
        x,
        ops.constant(weight),
        [stride] * 2,
        pads_begin=[pad] * 2,
        pads_end=[pad] * 2,
        dilations=[1, 1],
        auto_pad="explicit",
        output_padding=[extra] * 2,
    )
    return ops.add(y, ops.constant(bias.reshape(1, -1, 1, 1)))


def regression_model(tensors: Tensors) -> openvino.Model:
    """The Regression Network: (N, 1, H, W) → (N, 1, H, W), H and W multiples of 12."""
    source = ops.parameter([-1, 1, -1, -1], np.float32, name="heights")
    x = source
    for name, stride in (("conv1", 3), ("conv2", 2), ("conv3", 2)):
        x = ops.relu(_conv(x, tensors[f"{name}.weight"], tensors[f"{name}.bias"], stride))
    for name, stride, pad, extra in (("up3", 2, 1, 1), ("up2", 2, 2, 1), ("up1", 3, 3, 0)):
        x = ops.relu(_up(x, tensors[f"{name}.weight"], tensors[f"{name}.bias"], stride, pad, extra))
    x = _conv(x, tensors["head.weight"], tensors["head.bias"], 1)
    return openvino.Model([x], [source], "regression")


def _folded(tensors: Tensors, conv: str, norm: str) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Weight and bias of a convolution with the batch normalisation behind it folded in."""
    scale = tensors[f"{norm}.weight"] / np.sqrt(tensors[f"{norm}.running_var"] + EPSILON)
    weight = tensors[f"{conv}.weight"] * scale.reshape(-1, 1, 1, 1)
    return weight, tensors[f"{norm}.bias"] - tensors[f"{norm}.running_mean"] * scale


def _block(x: Any, tensors: Tensors, name: str, stride: int) -> Any:
    y = ops.relu(_conv(x, *_folded(tensors, f"{name}.conv1", f"{name}.bn1"), stride))
    y = _conv(y, *_folded(tensors, f"{name}.conv2", f"{name}.bn2"), 1)
    if f"{name}.shortcut.0.weight" in tensors:
        x = _conv(x, *_folded(tensors, f"{name}.shortcut.0", f"{name}.shortcut.1"), stride)
    return ops.relu(ops.add(y, x))


def refined_model(tensors: Tensors, size: int) -> openvino.Model:
    """The Refined Network: crops (N, 1, size, size) → P of both classes (N, 2)."""
    source = ops.parameter([-1, 1, size, size], np.float32, name="crops")
    x = ops.relu(_conv(source, *_folded(tensors, "conv", "bn"), 2))
    x = ops.max_pool(x, [2, 2], [1, 1], [1, 1], [1, 1], [3, 3]).output(0)
    for stage, blocks in enumerate(BLOCKS):
        for block in range(blocks):
            x = _block(x, tensors, f"stages.{stage}.{block}", 2 if stage and not block else 1)
    x = ops.reduce_mean(x, ops.constant(np.array([2, 3], np.int64)), keep_dims=False)
    x = ops.matmul(x, ops.constant(tensors["fc.weight"]), False, True)
    x = ops.softmax(ops.add(x, ops.constant(tensors["fc.bias"].reshape(1, -1))), 1)
    return openvino.Model([x], [source], "refined")


def native_bf16() -> bool:
    """Whether the processor computes in bfloat16 by itself."""
    return "BF16" in openvino.Core().get_property("CPU", "OPTIMIZATION_CAPABILITIES")


_KERNELS = 32
"""Kernels that are kept for sizes that come again; large images have many sizes. By default a process that had met 200
sizes took 571 MB instead of 340, and was no faster."""


def compile_models(
    regression: Tensors, refined: Tensors, size: int, *, threads: int | None, precision: str
) -> tuple[openvino.InferRequest, openvino.InferRequest]:
    """Both networks compiled for low latency on the CPU.

    Args:
        regression: its tensors.
        refined: its tensors.
        size: side of the crops, pixels.
        threads: CPU threads, all cores when None.
        precision: "f32" or "bf16".
    """
    options = {
        "PERFORMANCE_HINT": "LATENCY",
        "NUM_STREAMS": "1",
        "INFERENCE_PRECISION_HINT": precision,
        "CPU_RUNTIME_CACHE_CAPACITY": str(_KERNELS),
    }
    if threads is not None:
        options["INFERENCE_NUM_THREADS"] = str(threads)
    core = openvino.Core()
    models = regression_model(regression), refined_model(refined, size)
    first, second = (core.compile_model(model, "CPU", options).create_infer_request() for model in models)
    return first, second
