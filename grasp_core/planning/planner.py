"""What a planner is: a callable from one depth image to a plan, and how to get one by name.

An empty plan is a result, not an exception: it says why it is empty.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import msgspec
import numpy as np
from numpy.typing import NDArray

from grasp_core import config
from grasp_core.camera import Camera, DepthImage
from grasp_core.errors import ConfigError
from grasp_core.grasp import Grasp, ImageGrasp
from grasp_core.gripper import Gripper, load_gripper

if TYPE_CHECKING:
    from grasp_core.networks.runtime import Runtime
    from grasp_core.planning.image_planner import ImagePlanner


@dataclass(frozen=True)
class Candidate:
    """A grasp that a planner considered.

    Attributes:
        grasp: in the world of the plan's camera.
        image: the same in the pixels of the input image.
        score: P(class 1) of the Refined Network, or what a baseline ranks by; in [0, 1].
        heat: the quality map at its place, 0 where a planner has none.
    """

    grasp: Grasp
    image: ImageGrasp
    score: float
    heat: float = 0.0


@dataclass(frozen=True, eq=False)
class Plan:
    """What a planner found.

    Attributes:
        candidates: the result, best first.
        reason: why there is none, or None.
        canvas: the canonical view that was planned on, of the whole table that was seen; the image itself where it
            could not be made canonical.
        quality_map: float32 (H, W) over the canvas, unbounded; zeros where it was not computed.
        region: (u, v, radius) on the canvas, pixels, of the region that was searched last; None where there is none.
        sampled: (K, 2) canvas pixels (u, v) that were sampled.
        scored: all that was scored, best first; the candidates are some of them.
        stages_ms: stage → milliseconds.
        camera: the input's, with the pose that was given or found; without one where none was found.
        weights: name and digest of the weights, "" without networks.
        missing: share of the input's pixels that were missing and filled.
    """

    candidates: tuple[Candidate, ...]
    reason: str | None
    canvas: DepthImage
    quality_map: NDArray[np.float32]
    region: tuple[float, float, float] | None
    sampled: NDArray[np.float64]
    scored: tuple[Candidate, ...]
    stages_ms: dict[str, float]
    camera: Camera
    weights: str
    missing: float

    @property
    def total_ms(self) -> float:
        """Milliseconds of all stages."""
        return sum(self.stages_ms.values())


class Planner(Protocol):
    """Plans grasps from one depth image; the same generator state gives the same plan (unless time runs out)."""

    def __call__(
        self,
        image: DepthImage,
        *,
        mask: NDArray[np.bool_] | None = None,
        budget_ms: float | None = None,
        rng: np.random.Generator,
    ) -> Plan:
        """Plan.

        Args:
            image: of any camera; without a pose the table plane is found first.
            mask: boolean (H, W) of the image; grasps are centred where it is true.
            budget_ms: the best found within this time is returned; no limit when None. What cannot be cut short is the
                making of the canonical view, the quality map, and one chunk of 16 grasps (antipodal: all its pairs).
            rng: all chance comes from it.

        Raises:
            ImageError: no depth image was given, or the mask does not fit it.
            GraspError: the budget is not above 0.
        """
        ...


PLANNERS: dict[str, tuple[str, str]] = {
    "cascade": ("grasp_core.planning.cascade", "CascadePlanner"),
    "exhaustive": ("grasp_core.planning.baselines.exhaustive", "ExhaustivePlanner"),
    "random": ("grasp_core.planning.baselines.random", "RandomPlanner"),
    "centroid": ("grasp_core.planning.baselines.centroid", "CentroidPlanner"),
    "antipodal": ("grasp_core.planning.baselines.antipodal", "AntipodalPlanner"),
}
"""Kind of planner → (module, class). Each class has `settings_type` and `make(settings, gripper, ...)`."""


def needs_networks(name: str | Path) -> bool:
    """Whether planners of this name run the networks.

    Raises:
        ConfigError: no such planner.
    """
    return _read(name)[0] in ("cascade", "exhaustive")


def make_planner(
    name: str | Path = "cascade",
    *,
    gripper: Gripper | None = None,
    weights: str | Path = "default",
    runtime: Runtime | None = None,
    changes: Mapping[str, Any] | None = None,
) -> ImagePlanner[Any]:
    """A planner by name.

    Args:
        name: of a shipped planner, or a .yaml file of planner settings; its key `planner` says which kind it is.
        gripper: the shipped one by default.
        weights: shipped name or path; for planners with networks.
        runtime: networks that are loaded already; takes the place of `weights`.
        changes: name of a setting → its value in place of the file's; those that this kind does not have are left out.

    Raises:
        ConfigError: no such planner, settings or weights, or a value that a setting cannot have.
        MismatchError: the weights are for another gripper.
    """
    kind, values = _read(name)
    module, class_ = PLANNERS[kind]
    maker: Any = getattr(importlib.import_module(module), class_)
    if changes:
        known = msgspec.structs.fields(maker.settings_type)
        values.update({field.name: changes[field.name] for field in known if field.name in changes})
    settings = config.convert(values, maker.settings_type, str(config.locate("planners", name)))
    planner: ImagePlanner[Any] = maker.make(settings, gripper or load_gripper(), weights=weights, runtime=runtime)
    return planner


def _read(name: str | Path) -> tuple[str, dict[str, Any]]:
    """Kind and settings of a planner file."""
    path = config.locate("planners", name)
    values = config.read_yaml(path)
    kind = values.pop("planner", None) if isinstance(values, dict) else None
    if kind not in PLANNERS:
        raise ConfigError(f"{path}: planner: must be one of: {', '.join(PLANNERS)}, not {kind!r}")
    return kind, values
