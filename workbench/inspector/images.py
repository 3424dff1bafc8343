"""The 2D view: the canvas that was planned on with everything that the planner made of it, as SVG."""

from __future__ import annotations

import base64
import math
from collections.abc import Iterable

import cv2
import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import CANONICAL_HEIGHT
from grasp_core.grasp import to_image
from grasp_core.planning.crops import canvas_yaw
from grasp_core.planning.planner import Plan
from workbench import colours
from workbench.bridge import Bridge
from workbench.inspector.orders import Choice, Place
from workbench.inspector.state import State

_MOST_DOTS = 600
_STANDS = 0.008
"""Metres above the table from which on something stands there."""
_AROUND = 45
"""Pixels shown round it."""
_STEP = 60


def data_url(picture: NDArray[np.uint8], *, quick: bool = False) -> str:
    """RGB (H, W, 3) → a picture as a data URL: PNG, or a smaller JPEG where it is only seen for a moment."""
    ending, options = (".jpg", [cv2.IMWRITE_JPEG_QUALITY, 88]) if quick else (".png", [cv2.IMWRITE_PNG_COMPRESSION, 4])
    done, data = cv2.imencode(ending, cv2.cvtColor(picture, cv2.COLOR_RGB2BGR), options)
    if not done:
        raise ValueError("the picture cannot be encoded")
    kind = "jpeg" if quick else "png"
    return f"data:image/{kind};base64," + base64.b64encode(data.tobytes()).decode()


def _points(corners: NDArray[np.float64]) -> str:
    # Pixel centres are whole numbers; SVG's pixel (0, 0) has its centre at (0.5, 0.5).
    return " ".join(f"{u + 0.5:.1f},{v + 0.5:.1f}" for u, v in corners)


def tint(state: State, choice: Choice, score: float) -> str:
    """CSS colour of a candidate: of its score, or of its quality in physics."""
    if not state.by_physics:
        return colours.css(colours.score(score))
    trial = state.trials.get(choice)
    quality = None if trial is None else trial.quality
    return colours.css(colours.UNKNOWN if quality is None else colours.score(quality))


def rectangles(state: State, side: int, bridge: Bridge) -> str:
    """Candidates as rectangles on the canvas: thin along the opening, thick where the fingers stand; best on top."""
    scene = state.scene
    assert scene is not None
    plan = scene.sight.plans[side]
    assert plan is not None
    camera = plan.canvas.camera
    parts = []
    for index, candidate in reversed(list(enumerate(plan.candidates))):
        if candidate.score < state.least:
            continue
        shown = to_image(candidate.grasp, camera)
        jaw = shown.width / candidate.grasp.width * scene.gripper.finger.y
        corners = shown.rectangle(jaw)
        colour = tint(state, Choice(side, index), candidate.score)
        ends = f"M{_points(corners[[1]])}L{_points(corners[[2]])}M{_points(corners[[3]])}L{_points(corners[[0]])}"
        parts.append(
            f'<g class="gw-c gw-c{side}-{index}" data-candidate="{index}" {bridge.onclick(f"select:{side}.{index}")}>'
            f"<title>candidate {index + 1}: score {candidate.score:.2f}, heat {candidate.heat:.2f}; click to try it"
            f'</title><polygon points="{_points(corners)}" stroke="{colour}"/><path d="{ends}" stroke="{colour}"/>'
            f'<text x="{shown.u + 0.5:.1f}" y="{shown.v + 0.5:.1f}">{candidate.score:.2f}</text></g>'
        )
    return "".join(parts)


def window(plan: Plan) -> tuple[int, int, int, int]:
    """What of the canvas is shown: left, top, width, height in pixels: a square round all that stands on the table.

    At least 300 pixels and in steps, so that it stands still while an object is dragged; all where nothing stands.
    """
    image = plan.canvas
    height, width = image.depth.shape
    table = CANONICAL_HEIGHT if image.camera.world_from_camera is None else float(image.camera.pose[2, 3])
    v, u = np.nonzero(image.valid & (image.depth < table - _STANDS))
    if not len(u):
        return 0, 0, width, height
    (left, right), (top, bottom) = (np.percentile(axis, [0.5, 99.5]) for axis in (u, v))
    side = _STEP * np.ceil(max(right - left, bottom - top, 300 - 2 * _AROUND) / _STEP) + 2 * _AROUND
    side_u, side_v = round(min(side, width)), round(min(side, height))
    start = int(np.clip(_STEP * round(((left + right) / 2 - side_u / 2) / _STEP), 0, width - side_u))
    above = int(np.clip(_STEP * round(((top + bottom) / 2 - side_v / 2) / _STEP), 0, height - side_v))
    return start, above, side_u, side_v


def _dots(pixels: Iterable[Iterable[float]]) -> str:
    return "".join(f'<circle cx="{u + 0.5:.1f}" cy="{v + 0.5:.1f}" r="0.9"/>' for u, v in pixels)


def _place(place: Place | None, yaw: float) -> str:
    """A cross where the user asked, and the closing axis of the best angle there."""
    if place is None:
        return ""
    u, v = place.u + 0.5, place.v + 0.5
    cross = f"M{u - 5:.1f},{v}H{u + 5:.1f}M{u},{v - 5:.1f}V{v + 5:.1f}"
    line = ""
    if place.scores is not None and place.scores.best is not None:
        angle = place.scores.candidates[place.scores.best].grasp.angle - yaw
        du, dv = 37.5 * math.cos(angle), -37.5 * math.sin(angle)
        line = f'<path class="gw-axis" d="M{u - du:.1f},{v - dv:.1f}L{u + du:.1f},{v + dv:.1f}"/>'
    return f'<g class="gw-place">{line}<path d="{cross}"/></g>'


def depth_range(state: State, plan: Plan) -> tuple[float, float]:
    """Nearest and farthest depth that the colours tell apart, metres."""
    image, picture = plan.canvas, state.picture
    if (picture.near, picture.far) == (0.0, 1.0) or not image.valid.any():
        return colours.depth_range(image.depth, image.valid)
    values = image.depth[image.valid]
    low, span = float(values.min()), max(float(np.ptp(values)), 0.01)
    return low + picture.near * span, low + picture.far * span


def canvas(state: State, side: int, bridge: Bridge) -> str:
    """One plan's canvas: depth, quality map over it, region, samples, candidates; SVG."""
    scene = state.scene
    assert scene is not None
    plan = scene.sight.plans[side]
    assert plan is not None
    image, picture = plan.canvas, state.picture
    height, width = image.depth.shape
    near, far = depth_range(state, plan)
    quick = state.dragging
    every = 2 if quick else 1  # in a column this narrow, a moving picture looks the same with half the rows and columns
    depth, valid = image.depth[::every, ::every], image.valid[::every, ::every]
    base = data_url(colours.depth(depth, valid, near, far, picture.colours), quick=quick)
    size = f'width="{width}" height="{height}" style="image-rendering:pixelated'
    parts = [f'<image class="gw-depth-image" href="{base}" {size}"/>']
    if plan.quality_map.any():
        shown = colours.heat(plan.quality_map[::every, ::every], colours.heat_top(plan.quality_map))
        heat = data_url(shown, quick=quick)
        parts.append(f'<image class="gw-heat" href="{heat}" {size};opacity:{picture.opacity:.2f}"/>')
    if "samples" in picture.marks and len(plan.sampled):
        parts.append(f'<g class="gw-sampled">{_dots(np.asarray(plan.sampled, float)[:_MOST_DOTS])}</g>')
    if "region" in picture.marks and plan.region is not None:
        u, v, radius = (float(value) for value in plan.region)
        parts.append(
            f'<circle class="gw-region" cx="{u + 0.5:.1f}" cy="{v + 0.5:.1f}" r="{radius:.1f}">'
            f"<title>Region: grasps are sampled in it ({len(plan.sampled)} pixels)</title></circle>"
        )
    if "rectangles" in picture.marks:
        parts.append(rectangles(state, side, bridge))
    parts.append(_place(state.place, canvas_yaw(image.camera)))
    box = " ".join(str(value) for value in window(plan))
    return (
        f'<svg class="gw-view gw-depth" data-view="{side}" viewBox="{box}" {bridge.onpoint("ask")}>'
        f"{''.join(parts)}</svg>"
    )


def crop_picture(crop: NDArray[np.float32], context: float) -> str:
    """What the Refined Network saw of a candidate, with the fingers' inner faces; SVG.

    Args:
        crop: (S, S) of `crops.crops`: depth against the finger tips, in units of 5 cm.
        context: side of the crop in openings.
    """
    size = crop.shape[0]
    grey = (np.clip(0.5 - crop / 2.4, 0, 1) * 255).astype(np.uint8)
    shown = cv2.cvtColor(cv2.applyColorMap(grey, cv2.COLORMAP_CIVIDIS), cv2.COLOR_BGR2RGB)
    half = size / (2 * context)
    fingers = "".join(
        f'<path d="M{size / 2 + sign * half:.1f},{size / 2 - 4.5:.1f}V{size / 2 + 4.5:.1f}"/>' for sign in (-1, 1)
    )
    return (
        f'<svg class="gw-crop" viewBox="0 0 {size} {size}"><image href="{data_url(np.asarray(shown, np.uint8))}"'
        f' width="{size}" height="{size}" style="image-rendering:pixelated"/><g class="gw-jaws">{fingers}</g></svg>'
    )
