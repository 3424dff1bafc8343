"""Pictures of samples: thumbnails, the image with the rectangle that can be dragged, and the network's crop."""

from __future__ import annotations

import base64
import math

import cv2
import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import DepthImage
from grasp_core.grasp import Grasp, to_image
from grasp_core.gripper import Gripper
from grasp_core.networks.weights import CropSpec
from grasp_core.planning.crops import CROP_RANGE, crops, grasp_pixels
from workbench import colours

THUMB = 104
"""Side of a thumbnail, pixels of the page."""
_REACH = 1.35
"""Side of what a thumbnail shows, in openings of the grasp."""
_WINDOW = 2.0
"""Side of what the sample's image shows, in openings of the gripper."""


def data_url(picture: NDArray[np.uint8], quality: int = 82) -> str:
    """RGB (H, W, 3) → a JPEG as a data URL."""
    done, data = cv2.imencode(".jpg", cv2.cvtColor(picture, cv2.COLOR_RGB2BGR), [cv2.IMWRITE_JPEG_QUALITY, quality])
    if not done:
        raise ValueError("the picture cannot be encoded")
    return "data:image/jpeg;base64," + base64.b64encode(data.tobytes()).decode()


def coloured(image: DepthImage) -> NDArray[np.uint8]:
    """A depth image as RGB (H, W, 3)."""
    near, far = colours.depth_range(image.depth, image.valid)
    return colours.depth(image.depth, image.valid, near, far)


def thumbnail(picture: NDArray[np.uint8], image: DepthImage, grasp: Grasp, gripper: Gripper) -> str:
    """The image around a grasp with its rectangle, as a data URL; `picture` is the whole image, coloured."""
    shown = to_image(grasp, image.camera)
    side = max(_REACH * shown.width, 40.0)
    scale = THUMB / side
    move = np.array([[scale, 0, THUMB / 2 - scale * shown.u], [0, scale, THUMB / 2 - scale * shown.v]])
    cut = cv2.warpAffine(picture, move, (THUMB, THUMB), flags=cv2.INTER_LINEAR, borderValue=(20, 22, 26))
    corners = shown.rectangle(shown.width / grasp.width * gripper.finger.y) @ move[:, :2].T + move[:, 2]
    points = np.rint(corners * 8).astype(np.int32)
    cv2.polylines(cut, [points[:, None]], True, (255, 255, 255), 1, cv2.LINE_AA, 3)
    for first, second in ((1, 2), (3, 0)):  # where the fingers stand
        cv2.line(cut, points[first].tolist(), points[second].tolist(), (90, 170, 250), 2, cv2.LINE_AA, 3)
    return data_url(np.asarray(cut, np.uint8))


def crop_picture(image: DepthImage, grasp: Grasp, gripper: Gripper) -> str:
    """What the Refined Network sees of a grasp, as a data URL: near is bright, the depth of p is the middle."""
    u, v, angle, depth = grasp_pixels(image.depth, image.camera, np.array([grasp.position]), [grasp.angle])
    cut = crops(image.depth, image.camera, u, v, angle, depth, CropSpec(), gripper.opening)[0]
    grey = np.asarray((CROP_RANGE - cut) / (2 * CROP_RANGE) * 255, np.uint8)
    large = cv2.resize(cv2.applyColorMap(grey, cv2.COLORMAP_BONE), (THUMB, THUMB), interpolation=cv2.INTER_NEAREST)
    return data_url(cv2.cvtColor(large, cv2.COLOR_BGR2RGB).astype(np.uint8), 90)


def rectangle(image: DepthImage, grasp: Grasp, gripper: Gripper, look: str, more: str = "") -> str:
    """A grasp's rectangle as SVG: thin along the opening, thick where the fingers stand."""
    shown = to_image(grasp, image.camera)
    corners = shown.rectangle(shown.width / grasp.width * gripper.finger.y) + 0.5
    points = [f"{u:.2f},{v:.2f}" for u, v in corners]
    ends = f"M{points[1]}L{points[2]}M{points[3]}L{points[0]}"
    return f'<g class="gw-c {look}" {more}><polygon points="{" ".join(points)}"/><path d="{ends}"/></g>'


def sample_svg(image: DepthImage, grasp: Grasp, gripper: Gripper, edited: Grasp | None) -> str:
    """The image around a sample with its rectangle; an edited one can be dragged and turned by its handle."""
    height, width = image.depth.shape
    shown = to_image(grasp, image.camera)
    side = min(_WINDOW * shown.width / grasp.width * gripper.opening, width, height)
    left = float(np.clip(shown.u - side / 2, 0, width - side))
    top = float(np.clip(shown.v - side / 2, 0, height - side))
    marks = rectangle(image, grasp, gripper, "gw-sample" if edited is None else "gw-before")
    if edited is not None:
        marks += _handles(image, edited, gripper)
    return (
        f'<svg class="gw-view gw-sampleview" data-view="sample" viewBox="{left:.1f} {top:.1f} {side:.1f} {side:.1f}">'
        f'<image href="{data_url(coloured(image), 92)}" width="{width}" height="{height}"'
        f' style="image-rendering:pixelated"/>{marks}</svg>'
    )


def _handles(image: DepthImage, grasp: Grasp, gripper: Gripper) -> str:
    """The edited rectangle: dragging it moves it, dragging the knob at its end turns and widens it."""
    shown = to_image(grasp, image.camera)
    u, v = shown.u + 0.5, shown.v + 0.5
    end_u = u + math.cos(shown.angle) * shown.width / 2
    end_v = v - math.sin(shown.angle) * shown.width / 2
    start = (
        "event.preventDefault();event.stopPropagation();this.setPointerCapture(event.pointerId);"
        "this.gwFrom=gwAt(this.ownerSVGElement,event).split(',').map(Number)"
    )
    follow = (
        "if(this.gwFrom){const p=gwAt(this.ownerSVGElement,event).split(',').map(Number);"
        "this.setAttribute('transform','translate('+(p[0]-this.gwFrom[0])+' '+(p[1]-this.gwFrom[1])+')')}"
    )
    move = (
        "if(this.gwFrom){const p=gwAt(this.ownerSVGElement,event).split(',').map(Number);"
        "gwSend('cdrag:'+(p[0]-this.gwFrom[0]).toFixed(1)+','+(p[1]-this.gwFrom[1]).toFixed(1));this.gwFrom=null}"
    )
    knob = "if(this.gwFrom){gwSend('cend:'+gwAt(this.ownerSVGElement,event));this.gwFrom=null}"
    drag = f'onpointerdown="{start}" onpointermove="{follow}"'
    place = f'cx="{end_u:.2f}" cy="{end_v:.2f}" r="3.4"'
    return (
        rectangle(image, grasp, gripper, "gw-edited", f'data-edited="1" {drag} onpointerup="{move}"')
        + f'<circle class="gw-knob" data-knob="1" {place} {drag} onpointerup="{knob}">'
        "<title>turn and widen</title></circle>"
    )
