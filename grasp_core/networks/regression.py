"""The Regression Network: six layers that map a depth image to a quality map (paper section V.B, Fig. 5).

Kernels, strides and channels follow GG-CNN (Morrison et al. 2018) without its angle and width maps. Every layer and its
transposed twin have the same centres, so pixel (u, v) of the map speaks of pixel (u, v) of the image.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn
from torch.nn import functional

from grasp_core.networks.inputs import regression_input
from grasp_core.networks.layout import STRIDE

__all__ = ["RegressionNetwork", "regression_input"]


class RegressionNetwork(nn.Module):
    """Heights (N, 1, H, W) in network units → quality map (N, 1, H, W), unbounded; any H and W."""

    def __init__(self) -> None:
        super().__init__()
        self.conv1 = nn.Conv2d(1, 32, 9, stride=3, padding=3)
        self.conv2 = nn.Conv2d(32, 16, 5, stride=2, padding=2)
        self.conv3 = nn.Conv2d(16, 8, 3, stride=2, padding=1)
        self.up3 = nn.ConvTranspose2d(8, 8, 3, stride=2, padding=1, output_padding=1)
        self.up2 = nn.ConvTranspose2d(8, 16, 5, stride=2, padding=2, output_padding=1)
        self.up1 = nn.ConvTranspose2d(16, 32, 9, stride=3, padding=3)
        self.head = nn.Conv2d(32, 1, 1)
        for layer in self.children():
            nn.init.xavier_uniform_(layer.weight, gain=1.0)  # type: ignore[arg-type]
            nn.init.zeros_(layer.bias)  # type: ignore[arg-type]

    def forward(self, heights: Tensor) -> Tensor:
        """(N, 1, H, W) → (N, 1, H, W); borders are padded with empty table."""
        height, width = heights.shape[-2:]
        x = functional.pad(heights, (0, -width % STRIDE, 0, -height % STRIDE))
        for layer in (self.conv1, self.conv2, self.conv3, self.up3, self.up2, self.up1):
            x = torch.relu(layer(x))
        quality: Tensor = self.head(x)
        return quality[..., :height, :width]
