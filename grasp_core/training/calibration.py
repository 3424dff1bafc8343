"""Temperature scaling (Guo et al. 2017): one number that makes scores probabilities, folded into the last layer."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import ArrayLike
from torch import nn

from grasp_core.errors import GraspError

_RANGE = (0.05, 20.0)
_GOLDEN = (5**0.5 - 1) / 2


def log_loss(margins: ArrayLike, labels: ArrayLike, temperature: float = 1.0) -> float:
    """Mean cross-entropy of P(class 1) = sigmoid(margin / temperature) against labels in [0, 1], nats."""
    m, y = np.asarray(margins, float) / temperature, np.asarray(labels, float)
    return float(np.mean(np.logaddexp(0.0, m) - y * m))


def fit_temperature(margins: ArrayLike, labels: ArrayLike) -> float:
    """The temperature that minimises the cross-entropy on held-out grasps.

    Args:
        margins: logit of class 1 minus logit of class 0, (N,).
        labels: (N,) in [0, 1].

    Raises:
        GraspError: no grasps, or as many margins as labels are not given.
    """
    m, y = np.asarray(margins, float), np.asarray(labels, float)
    if m.shape != y.shape or m.ndim != 1 or not len(m):
        raise GraspError(f"calibration needs as many margins as labels and at least one, not {m.shape} and {y.shape}")
    low, high = np.log(_RANGE[0]), np.log(_RANGE[1])
    a, b = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    losses = [log_loss(m, y, float(np.exp(x))) for x in (a, b)]
    while high - low > 1e-4:  # the loss is convex in 1/T, hence has one minimum in log T
        if losses[0] < losses[1]:
            high, b = b, a
            a = high - _GOLDEN * (high - low)
            losses = [log_loss(m, y, float(np.exp(a))), losses[0]]
        else:
            low, a = a, b
            b = low + _GOLDEN * (high - low)
            losses = [losses[1], log_loss(m, y, float(np.exp(b)))]
    return float(np.exp((low + high) / 2))


def fold_temperature(last: nn.Linear, temperature: float) -> None:
    """Divide the logits of a last layer by a temperature, in place."""
    with torch.no_grad():
        last.weight.div_(temperature)
        last.bias.div_(temperature)
