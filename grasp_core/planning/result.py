"""The first and the last step of every image-based planner: from an image to a view, from candidates to a plan."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import DepthImage
from grasp_core.errors import ImageError
from grasp_core.planning.planner import Candidate, Plan
from grasp_core.planning.stages import Stages
from grasp_core.planning.view import TableView, ViewSettings, look


def begin(
    image: DepthImage, mask: NDArray[np.bool_] | None, settings: ViewSettings, stages: Stages, weights: str = ""
) -> TableView | Plan:
    """The view to plan on, or the empty plan that says why there is nothing to plan.

    Raises:
        ImageError: no depth image was given, or the mask does not fit it.
    """
    if not isinstance(image, DepthImage):
        raise ImageError(
            f"a planner takes a DepthImage, not {type(image).__name__}: read one with"
            " grasp_core.sensing.preprocess.read_depth(file, camera), or make one from an array of metres with"
            " DepthImage.from_array(array, camera)"
        )
    if mask is not None and (mask.dtype != np.bool_ or mask.shape != image.depth.shape):
        raise ImageError(
            f"the mask is {mask.dtype} of the shape {mask.shape}; it must be boolean and {image.depth.shape},"
            " the shape of the image"
        )
    none = np.zeros((0, 2))
    with stages.stage("rectify"):
        try:
            rectified, view = look(image, mask, settings)
        except ImageError as error:
            zeros = np.zeros(image.depth.shape, np.float32)
            missing = 1 - float(image.valid.mean())
            reason = f"image invalid: {error}"
            return Plan((), reason, image, zeros, None, none, (), stages.ms, image.camera, weights, missing)
    if isinstance(view, TableView):
        return view
    zeros = np.zeros(rectified.image.depth.shape, np.float32)
    return Plan(
        (), view, rectified.image, zeros, None, none, (), stages.ms, rectified.camera, weights, rectified.missing
    )


def finish(
    view: TableView,
    heat: NDArray[np.float32] | None,
    region: tuple[float, float, float] | None,
    sampled: NDArray[np.float64],
    candidates: tuple[Candidate, ...],
    scored: tuple[Candidate, ...],
    reason: str | None,
    stages: Stages,
    weights: str = "",
) -> Plan:
    """The plan: what was found on the window of a view, moved onto the whole canvas.

    Args:
        view: that was planned on.
        heat: quality map (h, w) of the window, or None.
        region: (u, v, radius) in the window, pixels.
        sampled: pixels (K, 2) of the window.
        candidates: the result, best first.
        scored: all that was scored.
        reason: why there are no candidates.
        stages: the clock.
        weights: name and digest.
    """
    canvas = view.rectified.image
    quality = np.zeros(canvas.depth.shape, np.float32)
    if heat is not None:
        quality[view.rows, view.columns] = heat
    origin = np.array([view.columns.start, view.rows.start], float)
    if region is not None:
        region = (float(region[0] + origin[0]), float(region[1] + origin[1]), float(region[2]))
    return Plan(
        candidates,
        reason,
        canvas,
        quality,
        region,
        sampled + origin,
        scored,
        stages.ms,
        view.rectified.camera,
        weights,
        view.rectified.missing,
    )
