"""The 2D views: depth image and quality map as SVG, with candidate rectangles that can be clicked."""

from __future__ import annotations

import base64
from collections.abc import Callable, Iterable

import cv2
import numpy as np
from numpy.typing import NDArray

from grasp_core.grasp import to_image
from grasp_core.gripper import Gripper
from workbench import colours
from workbench.inspector.orders import OpenedScene

OnClick = Callable[[str], str]
"""`verb:argument` → an `onclick` attribute."""


def data_url(picture: NDArray[np.uint8]) -> str:
    """RGB (H, W, 3) → a PNG as a data URL."""
    done, data = cv2.imencode(".png", cv2.cvtColor(picture, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_PNG_COMPRESSION, 4])
    if not done:
        raise ValueError("the picture cannot be encoded")
    return "data:image/png;base64," + base64.b64encode(data.tobytes()).decode()


def _points(corners: NDArray[np.float64]) -> str:
    # Pixel centres are whole numbers; SVG's pixel (0, 0) has its centre at (0.5, 0.5).
    return " ".join(f"{u + 0.5:.1f},{v + 0.5:.1f}" for u, v in corners)


def rectangles(opened: OpenedScene, gripper: Gripper, onclick: OnClick) -> str:
    """Candidates as rectangles on the canvas: thin along the opening, thick where the fingers stand; best on top."""
    camera = opened.plan.canvas.camera
    parts = []
    for index, candidate in reversed(list(enumerate(opened.plan.candidates))):
        shown = to_image(candidate.grasp, camera)
        jaw = shown.width / candidate.grasp.width * gripper.finger.y
        corners = shown.rectangle(jaw)
        colour = colours.css(colours.score(candidate.score))
        ends = f"M{_points(corners[[1]])}L{_points(corners[[2]])}M{_points(corners[[3]])}L{_points(corners[[0]])}"
        parts.append(
            f'<g class="gw-c gw-c{index}" data-candidate="{index}" {onclick(f"select:{index}")}>'
            f"<title>candidate {index + 1}: score {candidate.score:.2f}, heat {candidate.heat:.2f}; click to try it"
            f'</title><polygon points="{_points(corners)}" stroke="{colour}"/><path d="{ends}" stroke="{colour}"/></g>'
        )
    return "".join(parts)


def window(opened: OpenedScene) -> tuple[int, int, int, int]:
    """What of the canvas is shown: left, top, width, height in pixels, round the candidates and the region.

    At least three fifths of the canvas, so that the surroundings stay in sight; all of it without candidates.
    """
    plan = opened.plan
    height, width = plan.canvas.depth.shape
    places = [to_image(candidate.grasp, plan.canvas.camera) for candidate in plan.candidates]
    if not places:
        return 0, 0, width, height
    u, v = np.array([(place.u, place.v) for place in places]).T
    reach = max(place.width for place in places) * 0.75
    side_u = int(np.clip(np.ptp(u) + 2 * reach, 0.6 * width, width))
    side_v = int(np.clip(np.ptp(v) + 2 * reach, 0.6 * height, height))
    side = max(side_u / width, side_v / height)
    side_u, side_v = round(side * width), round(side * height)
    left = int(np.clip((u.min() + u.max()) / 2 - side_u / 2, 0, width - side_u))
    top = int(np.clip((v.min() + v.max()) / 2 - side_v / 2, 0, height - side_v))
    return left, top, side_u, side_v


def _frame(kind: str, picture: NDArray[np.uint8], marks: str, shown: tuple[int, int, int, int]) -> str:
    height, width = picture.shape[:2]
    box = " ".join(str(value) for value in shown)
    return (
        f'<svg class="gw-view gw-{kind}" data-view="{kind}" viewBox="{box}">'
        f'<image href="{data_url(picture)}" width="{width}" height="{height}" style="image-rendering:pixelated"/>'
        f"{marks}</svg>"
    )


def _legend(left: str, gradient: str, right: str) -> str:
    return f'<div class="gw-legend"><span>{left}</span><i style="background:{gradient}"></i><span>{right}</span></div>'


def depth_view(opened: OpenedScene, gripper: Gripper, onclick: OnClick) -> str:
    """The canvas that was planned on, with the candidates; HTML."""
    canvas = opened.plan.canvas
    near, far = colours.depth_range(canvas.depth, canvas.valid)
    picture = colours.depth(canvas.depth, canvas.valid, near, far)
    gradient = "linear-gradient(90deg,#14141f,#56707c,#dfe7e7)"
    return (
        '<figure><figcaption title="What the planner was given, in its straight-down view">Depth and candidates'
        f"</figcaption>{_frame('depth', picture, rectangles(opened, gripper, onclick), window(opened))}"
        f"{_legend(f'{far:.3f} m', gradient, f'{near:.3f} m')}</figure>"
    )


def _dots(pixels: Iterable[Iterable[float]]) -> str:
    return "".join(f'<circle cx="{u + 0.5:.1f}" cy="{v + 0.5:.1f}" r="0.9"/>' for u, v in pixels)


def quality_view(opened: OpenedScene) -> str:
    """The quality map with the region and the sampled pixels; HTML. Where there is none it says so."""
    plan = opened.plan
    values = plan.quality_map
    if not values.any():
        nothing = '<div class="gw-nothing">This planner made no quality map.</div>'
        return f"<figure><figcaption>Quality map</figcaption>{nothing}</figure>"
    marks = ""
    if len(plan.sampled):
        marks += f'<g class="gw-sampled">{_dots(np.asarray(plan.sampled, float)[:600])}</g>'
    if plan.region is not None:
        u, v, radius = (float(value) for value in plan.region)
        told = f"Region: grasps are sampled in it ({len(plan.sampled)} pixels)"
        marks += (
            f'<circle class="gw-region" cx="{u + 0.5:.1f}" cy="{v + 0.5:.1f}" r="{radius:.1f}">'
            f"<title>{told}</title></circle>"
        )
    hint = "The Regression Network's guess of how good a grasp at each pixel can be"
    top = colours.heat_top(values)
    shown = _frame("quality", colours.heat(values, top), marks, window(opened))
    return (
        f'<figure><figcaption title="{hint}">Quality map <small>with region and samples</small></figcaption>{shown}'
        f"{_legend('0', colours.heat_gradient(), f'{top:.2f}')}</figure>"
    )
