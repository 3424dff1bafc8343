"""The Refined Network: ResNet18's topology on a small depth crop, two classes (paper section V.C, Fig. 6).

Basic blocks 2-2-2-2 with widths w, 2w, 4w, 8w (He et al. 2016). The stem is a 5×5 convolution of stride 2 and the
usual max pooling: crops of 48 px have little for the 7×7 of 224-pixel photographs to see.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn

from grasp_core.networks.layout import BLOCKS, EPSILON


class BasicBlock(nn.Module):
    """Two 3×3 convolutions and a shortcut: (N, C, H, W) → (N, D, H / stride, W / stride)."""

    def __init__(self, inputs: int, outputs: int, stride: int) -> None:
        super().__init__()
        self.conv1 = nn.Conv2d(inputs, outputs, 3, stride=stride, padding=1, bias=False)
        self.bn1 = nn.BatchNorm2d(outputs, EPSILON)
        self.conv2 = nn.Conv2d(outputs, outputs, 3, padding=1, bias=False)
        self.bn2 = nn.BatchNorm2d(outputs, EPSILON)
        self.shortcut: nn.Module = nn.Identity()
        if stride != 1 or inputs != outputs:
            self.shortcut = nn.Sequential(
                nn.Conv2d(inputs, outputs, 1, stride=stride, bias=False), nn.BatchNorm2d(outputs, EPSILON)
            )

    def forward(self, x: Tensor) -> Tensor:
        """The block."""
        y = torch.relu_(self.bn1(self.conv1(x)))
        return torch.relu_(self.bn2(self.conv2(y)) + self.shortcut(x))


class RefinedNetwork(nn.Module):
    """Crops (N, 1, S, S) of depth around a grasp, closing axis along the columns → logits (N, 2) of failure, success.

    Args:
        width: channels of the first stage; 64 is ResNet18, 16 the light default.
    """

    def __init__(self, width: int = 64) -> None:
        super().__init__()
        self.width = width
        self.conv = nn.Conv2d(1, width, 5, stride=2, padding=2, bias=False)
        self.bn = nn.BatchNorm2d(width, EPSILON)
        self.pool = nn.MaxPool2d(3, stride=2, padding=1)
        stages: list[nn.Module] = []
        inputs = width
        for stage, blocks in enumerate(BLOCKS):
            outputs = width << stage
            strides = [1 if stage == 0 else 2] + [1] * (blocks - 1)
            stages.append(
                nn.Sequential(*(BasicBlock(inputs if k == 0 else outputs, outputs, s) for k, s in enumerate(strides)))
            )
            inputs = outputs
        self.stages = nn.Sequential(*stages)
        self.fc = nn.Linear(inputs, 2)
        for module in self.modules():
            if isinstance(module, nn.Conv2d):
                nn.init.kaiming_normal_(module.weight, mode="fan_out", nonlinearity="relu")

    def forward(self, crops: Tensor) -> Tensor:
        """(N, 1, S, S) → logits (N, 2)."""
        x = self.pool(torch.relu_(self.bn(self.conv(crops))))
        logits: Tensor = self.fc(self.stages(x).mean(dim=(2, 3)))
        return logits
