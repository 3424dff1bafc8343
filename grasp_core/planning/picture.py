"""A picture of a plan: depth with the scored rectangles, and the quality map on the canonical canvas (OpenCV only)."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import Camera, DepthImage
from grasp_core.errors import ImageError
from grasp_core.lettering import plain
from grasp_core.planning.planner import Candidate, Plan

Picture = NDArray[np.uint8]

_SHOWN = 60
"""Scored grasps that are drawn faintly, the best of them."""
_JAW = 0.2
"""Side of a drawn rectangle across the closing axis, of its opening: 2 cm fingers, 10 cm opening."""
_TALL = 0.15
"""Metres: what is higher is drawn white."""
_BAND = 22
"""Pixels of the line of text under each panel."""
_WHITE, _GREY, _BLACK = (255, 255, 255), (170, 170, 170), (0, 0, 0)


def draw_plan(plan: Plan, image: DepthImage) -> Picture:
    """BGR picture of a plan.

    On the left the input's depth, as height above the table where that is known, with faint rectangles for all that was
    scored and brighter ones for the candidates, red (0) over yellow to green (1) by score; the best one lies on top,
    thick and white, with the fingers' sides in its colour. On the right the quality map over the canonical depth, with
    the region and the sampled pixels.
    """
    depth = _grey(_nearness(image, plan.camera), image.valid)
    for candidate in reversed(plan.scored[:_SHOWN]):
        _rectangle(depth, candidate, bright=0.5, thickness=1)
    for candidate in reversed(plan.candidates[1:]):
        _rectangle(depth, candidate, bright=0.8, thickness=1)
    if plan.candidates:
        _best(depth, plan.candidates[0])
        best = plan.candidates[0].image
        cv2.circle(depth, (round(best.u), round(best.v)), 3, _WHITE, -1, cv2.LINE_AA)
        text = f"{len(plan.candidates)} grasps, best {plan.candidates[0].score:.3f}, {plan.total_ms:.0f} ms"
    else:
        text = f"no grasp: {plan.reason}"
    heat = _heat(plan)
    height = max(depth.shape[0], heat.shape[0])
    peak = f"quality map, highest {float(plan.quality_map.max()):.2f}"
    return np.hstack([_panel(depth, text, height), _panel(heat, peak, height)])


def save_picture(path: str | Path, plan: Plan, image: DepthImage) -> None:
    """Write `draw_plan` to an image file.

    Raises:
        ImageError: the file cannot be written.
    """
    write_picture(path, draw_plan(plan, image))


def write_picture(path: str | Path, picture: Picture) -> None:
    """Write a picture to an image file.

    Raises:
        ImageError: the file cannot be written.
    """
    try:
        written = cv2.imwrite(str(path), picture)
    except cv2.error:
        written = False
    if not written:
        raise ImageError(f"{path}: cannot be written; give a name that ends in .png in a folder that exists")


def _nearness(image: DepthImage, camera: Camera) -> NDArray[np.float32]:
    """What is drawn bright where it is high (H, W): height above the table, or nearness without a pose, metres."""
    if camera.world_from_camera is None:
        return -image.depth
    return image.with_camera(camera).points()[:, :, 2].astype(np.float32)


def _grey(height: NDArray[np.float32], valid: NDArray[np.bool_]) -> Picture:
    low, high = np.percentile(height[valid], [5, 99]) if valid.any() else (0.0, 1.0)
    high = min(high, low + _TALL)
    grey = np.clip((height - low) / max(high - low, 1e-6), 0, 1) ** 0.7 * 215 + 40
    picture = np.repeat(grey.astype(np.uint8)[:, :, None], 3, axis=2)
    picture[~valid] = (80, 20, 20)
    return np.ascontiguousarray(picture)


def _heat(plan: Plan) -> Picture:
    canvas = _grey(-plan.canvas.depth, plan.canvas.valid)
    # Stretched to the map's own peak and clipped for display only.
    share = np.clip(plan.quality_map / max(float(plan.quality_map.max()), 0.05), 0, 1)[:, :, None]
    colour = cv2.applyColorMap((share[:, :, 0] * 255).astype(np.uint8), cv2.COLORMAP_INFERNO)
    picture = np.ascontiguousarray((canvas * (1 - 0.7 * share) * 0.7 + colour * share).clip(0, 255).astype(np.uint8))
    for u, v in np.rint(plan.sampled).astype(int).tolist():
        if 0 <= u < picture.shape[1] and 0 <= v < picture.shape[0]:
            picture[v, u] = (255, 255, 0)
    if plan.region is not None:
        u, v, radius = plan.region
        cv2.circle(picture, (round(u), round(v)), round(radius), _WHITE, 1, cv2.LINE_AA)
    return picture


def _rectangle(picture: Picture, candidate: Candidate, *, bright: float, thickness: int) -> None:
    grasp = candidate.image
    corners = np.rint(grasp.rectangle(_JAW * grasp.width)).astype(np.int32)
    score = min(max(candidate.score, 0.0), 1.0)
    colour = tuple(bright * value for value in (40.0, 255 * min(1, 2 * score), 255 * min(1, 2 - 2 * score)))
    cv2.polylines(picture, [corners.reshape(-1, 1, 2)], True, colour, 1, cv2.LINE_AA)
    points = corners.tolist()
    for start, end in ((points[1], points[2]), (points[3], points[0])):
        cv2.line(picture, start, end, colour, thickness, cv2.LINE_AA)


def _best(picture: Picture, candidate: Candidate) -> None:
    """The best grasp on top of all others: black around white, with its fingers' sides in the colour of its score."""
    corners = np.rint(candidate.image.rectangle(_JAW * candidate.image.width)).astype(np.int32).reshape(-1, 1, 2)
    for colour, thickness in ((_BLACK, 7), (_WHITE, 3)):
        cv2.polylines(picture, [corners], True, colour, thickness, cv2.LINE_AA)
    _rectangle(picture, candidate, bright=1.0, thickness=5)


def _panel(picture: Picture, text: str, height: int) -> Picture:
    panel = np.full((height + _BAND, picture.shape[1], 3), 255, np.uint8)
    panel[: picture.shape[0], : picture.shape[1]] = picture
    panel[picture.shape[0] : height] = _GREY
    cv2.putText(panel, plain(text), (6, height + 15), cv2.FONT_HERSHEY_SIMPLEX, 0.42, _BLACK, 1, cv2.LINE_AA)
    return panel
