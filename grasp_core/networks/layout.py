"""Numbers that the torch modules and the OpenVINO models share; importing them needs neither."""

STRIDE = 12
"""Pixels of the image per cell of the Regression Network's innermost layer: images are padded to a multiple of it."""

BLOCKS = (2, 2, 2, 2)
"""Basic blocks in each stage of the Refined Network: ResNet18."""

EPSILON = 1e-5
"""What batch normalisation adds to the variance."""
