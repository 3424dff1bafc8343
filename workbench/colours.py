"""The colours of the workbench: one for each score, outcome and part, the same in scene, images and lists."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

_SCORE = np.array([[214, 69, 65], [238, 155, 62], [242, 209, 92], [120, 200, 140], [38, 190, 170]], float)
"""Low to high: red over amber to teal, apart for colour-blind eyes too."""

OUTCOMES: dict[str, tuple[int, int, int]] = {
    "SUCCESS": (38, 190, 170),
    "COLLISION": (214, 69, 65),
    "MISSED": (139, 155, 180),
    "SLIPPED": (238, 155, 62),
    "UNSTABLE": (178, 120, 220),
}
"""Of each outcome of an attempt."""


class Themed(NamedTuple):
    """A colour in the dark theme and in the light one."""

    dark: tuple[int, int, int]
    light: tuple[int, int, int]


OBJECT = (205, 160, 105)
TABLE = Themed((52, 57, 64), (196, 202, 210))
GRID = Themed((74, 79, 86), (158, 166, 176))
SHADE = Themed((31, 34, 39), (152, 159, 169))
"""Of shadows on the table."""
FINGER = (84, 150, 230)
FRAME = (150, 158, 170)
UNKNOWN = (128, 136, 148)
"""Of candidates that physics has said nothing of."""
GHOST = (150, 130, 235)
"""Of the attempt that another one is compared with."""
FORCE = (255, 92, 170)
"""Of contact forces."""
STAGES = ("#5aaaeb", "#7bc8a4", "#f2b134", "#c98bdb", "#e4857a", "#8d9db6", "#b5cf6b", "#e7969c")
"""Of the stages of a plan, in order."""


def score(values: ArrayLike) -> NDArray[np.uint8]:
    """Scores (N,) or one score in [0, 1] → RGB (N, 3) or (3,); beyond the range the ends' colours."""
    place = np.clip(np.nan_to_num(np.asarray(values, float)), 0, 1) * (len(_SCORE) - 1)
    low = np.minimum(place.astype(int), len(_SCORE) - 2)
    part = (place - low)[..., None]
    return np.rint(_SCORE[low] * (1 - part) + _SCORE[low + 1] * part).astype(np.uint8)


def lit(colour: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """RGB for things under the scene's lights, which wash colours out: deeper, so that they look as in lists."""
    return np.rint(255 * (colour / 255.0) ** 1.9).astype(np.uint8)


def css(colour: ArrayLike) -> str:
    """RGB → `#rrggbb`."""
    red, green, blue = (int(value) for value in np.asarray(colour).reshape(3))
    return f"#{red:02x}{green:02x}{blue:02x}"


@lru_cache(maxsize=16)
def score_gradient() -> str:
    """The score colours as a CSS gradient from left to right."""
    return f"linear-gradient(90deg,{','.join(css(colour) for colour in _SCORE)})"


def depth_range(depth: NDArray[np.float32], valid: NDArray[np.bool_]) -> tuple[float, float]:
    """Nearest and farthest depth worth showing, metres (percentiles, so that single pixels do not set them)."""
    values = depth[valid]
    if not len(values):
        return 0.0, 1.0
    near, far = (float(value) for value in np.percentile(values[:: max(1, len(values) // 10_000)], [0.2, 99.5]))
    return near, max(far, near + 0.01)


DEPTH_MAPS: dict[str, int] = {
    "bone": cv2.COLORMAP_BONE,
    "viridis": cv2.COLORMAP_VIRIDIS,
    "turbo": cv2.COLORMAP_TURBO,
    "ocean": cv2.COLORMAP_OCEAN,
}
"""Colour maps for depth."""
UNMEASURED = (84, 32, 96)
"""Of pixels without depth."""


def depth(
    values: NDArray[np.float32], valid: NDArray[np.bool_], near: float, far: float, name: str = "bone"
) -> NDArray[np.uint8]:
    """Depth (H, W), metres → RGB (H, W, 3): near is bright; what was not measured is violet."""
    grey = (np.clip((far - values) / (far - near), 0, 1) * 255).astype(np.uint8)
    shown = _mapped(grey, name)
    shown[~valid] = UNMEASURED
    return shown


def _mapped(grey: NDArray[np.uint8], name: str) -> NDArray[np.uint8]:
    known = DEPTH_MAPS.get(name, cv2.COLORMAP_BONE)
    shown = cv2.cvtColor(cv2.applyColorMap(grey, known), cv2.COLOR_BGR2RGB)
    return (shown.astype(np.uint16) * 215 // 255 + 20).astype(np.uint8)


@lru_cache(maxsize=16)
def depth_gradient(name: str) -> str:
    """The depth colours as a CSS gradient, far at the left."""
    row = _mapped(np.linspace(0, 255, 9).astype(np.uint8)[None], name)[0]
    return f"linear-gradient(90deg,{','.join(css(colour) for colour in row)})"


def heat_top(values: NDArray[np.float32]) -> float:
    """Where the colours of a quality map end: its largest value, rounded up to 0.05, in [0.05, 1]."""
    return float(np.clip(np.ceil(np.nan_to_num(values).max() * 20) / 20, 0.05, 1.0))


def heat(values: NDArray[np.float32], top: float = 1.0) -> NDArray[np.uint8]:
    """Quality map (H, W) → RGB (H, W, 3), clipped to [0, top] for display only."""
    grey = (np.clip(np.nan_to_num(values) / top, 0, 1) * 255).astype(np.uint8)
    return np.ascontiguousarray(cv2.cvtColor(cv2.applyColorMap(grey, cv2.COLORMAP_INFERNO), cv2.COLOR_BGR2RGB))


@lru_cache(maxsize=16)
def heat_gradient() -> str:
    """The heat colours as a CSS gradient from left to right."""
    row = heat(np.linspace(0, 1, 9, dtype=np.float32)[None])[0]
    return f"linear-gradient(90deg,{','.join(css(colour) for colour in row)})"
