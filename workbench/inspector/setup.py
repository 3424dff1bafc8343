"""The settings of the inspector: what plans, what sees, what tries; each with its unit, range and a hint."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import msgspec

from grasp_core import config


class Setup(config.Settings):
    """How scenes are seen, planned on and tried; all of it goes into links. Ranges and hints are in `FIELDS`.

    Attributes:
        planner: name of the planner.
        beside: of a second one on the same image; "" for none.
        weights: name of shipped weights.
        pixels: m, sampled in the region.
        angles: tried at each pixel.
        scored: most grasps that the Refined Network scores in a region.
        radius: R_i, in gripper openings.
        threshold: t.
        candidates: n.
        gripper: shipped name.
        camera: shipped name.
        height: of the camera above the table, metres; 0 leaves a camera file's own pose.
        tilt: of the camera from straight down, degrees.
        sigma_u: χ_u of Eq. 5, pixels.
        sigma_v: χ_v, pixels.
        sigma_d: χ_d, metres.
        seed: of image noise and sampling.
        sigma_p: of Eq. 4, metres.
        sigma_phi: of Eq. 4, degrees.
        attempts: in a trial.
    """

    planner: str = "cascade"
    beside: str = ""
    weights: str = "default"
    pixels: int = 64
    angles: int = 12
    scored: int = 64
    radius: float = 0.3333
    threshold: float = 0.5
    candidates: int = 10
    gripper: str = "paper"
    camera: str = "canonical"
    height: float = 0.7
    tilt: float = 0.0
    sigma_u: float = 0.5
    sigma_v: float = 0.5
    sigma_d: float = 0.001
    seed: int = 0
    sigma_p: float = 0.0025
    sigma_phi: float = 2.5
    attempts: int = 5

    def __post_init__(self) -> None:
        for name, field in FIELDS.items():
            value = getattr(self, name)
            if isinstance(field, Choice):
                if value not in field.options and not (value == "" and name == "beside"):
                    raise ValueError(f"{field.label}: '{str(value)[:40]}' is none of {', '.join(field.options)}")
            elif not (math.isfinite(value) and field.low <= value <= field.high):
                span = f"{field.low:g} to {field.high:g} {field.unit}".rstrip()
                raise ValueError(f"{field.label} runs from {span}, not {value:g}")

    @property
    def plans(self) -> dict[str, Any]:
        """The settings of planners, by their names there."""
        return {name: getattr(self, name) for name in PLANNING}

    @property
    def planners(self) -> tuple[str, ...]:
        """Of one plan each, the main one first."""
        return (self.planner, self.beside) if self.beside else (self.planner,)

    @property
    def sees(self) -> tuple[Any, ...]:
        """What decides the picture of a scene."""
        return self.camera, self.height, self.tilt, self.sigma_u, self.sigma_v, self.sigma_d, self.seed

    @property
    def tries(self) -> tuple[Any, ...]:
        """What decides the outcome of a trial, besides scene and grasp."""
        return self.gripper, self.sigma_p, self.sigma_phi


@dataclass(frozen=True)
class Number:
    """A setting that is a number.

    Attributes:
        label: for people, with its symbol.
        unit: what it is measured in.
        hint: one sentence.
        low: smallest value.
        high: largest value.
        step: of its slider, in the unit.
        scale: units per value of the setting (1000 where metres are shown as mm).
        group: heading that it stands under.
    """

    label: str
    unit: str
    hint: str
    low: float
    high: float
    step: float
    scale: float = 1.0
    group: str = "planner"


@dataclass(frozen=True)
class Choice:
    """A setting that is one of some names.

    Attributes:
        label: for people.
        hint: one sentence.
        options: the names.
        group: heading that it stands under.
    """

    label: str
    hint: str
    options: tuple[str, ...]
    group: str = "planner"


def _shipped(kind: str) -> tuple[str, ...]:
    return tuple(config.shipped(kind))


def _weights() -> tuple[str, ...]:
    from grasp_core.networks.weights import shipped_weights

    return tuple(shipped_weights()) or ("default",)


PLANNING = ("pixels", "angles", "scored", "radius", "threshold", "candidates")
"""Settings that planners share by name."""
FIELDS: dict[str, Number | Choice] = {
    "planner": Choice("Planner", "What plans grasps from the depth image", _shipped("planners")),
    "beside": Choice("Beside it", "A second planner on the same image, to compare", _shipped("planners")),
    "weights": Choice("Weights", "Of both networks", _weights()),
    "pixels": Number("m pixels", "", "Pixels sampled in the region", 1, 512, 1),
    "angles": Number("Angles", "", "Tried at each pixel, spread over half a turn", 1, 36, 1),
    "scored": Number("Scored", "", "Most grasps scored by the Refined Network", 1, 1024, 1),
    "radius": Number("R_i", "openings", "Radius of the region round the best place", 0.05, 3, 0.01),
    "threshold": Number("t least", "", "Least score of a candidate, of planners with networks", 0, 1, 0.01),
    "candidates": Number("n best", "", "Most candidates that are returned", 1, 100, 1),
    "gripper": Choice("Gripper", "Plans and executes; weights fit one only", _shipped("grippers"), "gripper, camera"),
    "camera": Choice("Camera", "Its intrinsics", _shipped("cameras"), "gripper, camera"),
    "height": Number("Height", "m", "Of the camera above the table", 0.3, 1.5, 0.01, group="gripper, camera"),
    "tilt": Number("Tilt", "°", "Of the camera from straight down", 0, 50, 1, group="gripper, camera"),
    "sigma_u": Number("σ_u", "px", "Noise along image rows (Eq. 5)", 0, 5, 0.1, group="image noise"),
    "sigma_v": Number("σ_v", "px", "Noise along image columns (Eq. 5)", 0, 5, 0.1, group="image noise"),
    "sigma_d": Number("σ_d", "mm", "Noise of the depth (Eq. 5)", 0, 0.02, 0.1, 1000, "image noise"),
    "seed": Number("Seed", "", "Of image noise and of sampling", 0, 9999, 1, group="image noise"),
    "sigma_p": Number("σ_p", "mm", "How far executed grasps stray (Eq. 4)", 0, 0.02, 0.1, 1000, "trial"),
    "sigma_phi": Number("σ_φ", "°", "How far their angle strays (Eq. 4)", 0, 20, 0.1, group="trial"),
    "attempts": Number("Attempts", "", "In a trial", 1, 20, 1, group="trial"),
}  # fmt: skip
"""Every setting, in the order in which they are shown."""


def changed(setup: Setup, name: str, value: Any) -> Setup:
    """The same settings with another value of one of them.

    Raises:
        ValueError: no such setting, or a value that it cannot have.
    """
    return decoded({**msgspec.to_builtins(setup), name: value})


def decoded(values: Mapping[str, Any]) -> Setup:
    """Settings from plain values; texts are read as numbers where numbers belong.

    Raises:
        ValueError: an unknown setting, or a value that it cannot have.
    """
    try:
        return msgspec.convert(dict(values), Setup, strict=False)
    except msgspec.ValidationError as error:
        raise ValueError(str(error)) from error


def differences(setup: Setup) -> dict[str, Any]:
    """What is not as shipped, by name."""
    return {name: getattr(setup, name) for name in FIELDS if getattr(setup, name) != getattr(DEFAULT, name)}


DEFAULT = Setup()
