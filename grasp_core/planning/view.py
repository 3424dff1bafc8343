"""What every image-based planner starts from: the canonical view, and the places in it where a grasp may be."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import cv2
import msgspec
import numpy as np
from numpy.typing import NDArray

from grasp_core import config
from grasp_core.camera import CANONICAL_HEIGHT, Camera, DepthImage
from grasp_core.planning.crops import DepthRule, nearest, without_strays
from grasp_core.sensing.rectify import Rectified, rectify

_MARGIN = 96
"""Pixels around the places in the window: what a crop there can reach."""
_SIGHT = 48
"""Pixels from which the Regression Network takes its value at one."""
_LEAST_WINDOW = 300
"""Pixels: the training size."""
_STEP = 36
"""Pixels: windows grow in steps, so that a network meets few sizes; a multiple of its stride."""
_ASIDE = 0.05
"""Metres from below the camera to the middle of the places from which on the camera is moved over it: training views
stand aside by as much, and moving what stands above the table takes time."""
_RIM = 3
"""Pixels: what comes this near to the border of the canvas is cut off."""
_STEP_DEPTH = 0.012
"""Metres over 3 pixels (steeper than about 77°) that end a surface."""
_PIECE_AREA = 1500
"""Canvas pixels, 27 cm²."""
_PIECE_REACH = np.ones((25, 25), np.uint8)
"""Neighbourhood, pixels: 1.6 cm to each side."""
_SQUARE = np.ones((3, 3), np.uint8)


class ViewSettings(config.Settings):
    """What counts as a thing that may be grasped.

    Attributes:
        least_height: above the table, metres; fingers end 8 mm above it and pass over what is lower.
        least_area: of a connected raised area, canvas pixels (1.8 mm² each); smaller ones are noise.
        depth_rule: how deep grasps reach.
    """

    least_height: float = 0.008
    least_area: int = 40
    depth_rule: DepthRule = DepthRule()

    def __post_init__(self) -> None:
        if self.least_height <= 0 or self.least_area < 0:
            raise ValueError(
                f"least_height must be above 0 and least_area at least 0, not {self.least_height}, {self.least_area}"
            )


@dataclass(frozen=True, eq=False)
class TableView:
    """The canonical view, and a window of it that holds all places where a grasp may be.

    Attributes:
        rectified: the whole canvas.
        settings: what it was made with.
        rows: of the window on the canvas.
        columns: of the window.
        places: boolean (h, w) of the window: where grasps may be centred.
        camera: straight down, of the window.
    """

    rectified: Rectified
    settings: ViewSettings
    rows: slice
    columns: slice
    places: NDArray[np.bool_]
    camera: Camera

    @property
    def core(self) -> tuple[slice, slice]:
        """Rows and columns of the window that decide the quality map of the places: they reach as far as it looks."""
        rows, columns = np.flatnonzero(self.places.any(axis=1)), np.flatnonzero(self.places.any(axis=0))
        height, width = self.places.shape
        return _stretch(rows, height, _SIGHT, 0), _stretch(columns, width, _SIGHT, 0)

    @property
    def depth(self) -> NDArray[np.float32]:
        """The window's depth (h, w), metres, without holes."""
        return self.rectified.image.depth[self.rows, self.columns]

    @cached_property
    def smooth(self) -> NDArray[np.float32]:
        """The same without stray pixels: its 3×3 median."""
        return without_strays(self.depth)

    @cached_property
    def crests(self) -> NDArray[np.float32]:
        """The nearest depths within 2 pixels (about 3 mm): a thin mast is not missed between points 5 mm apart."""
        return nearest(self.smooth, 5)

    @cached_property
    def surface(self) -> NDArray[np.float32]:
        """The window's `surface_map`: depths that grasps take theirs from."""
        return nearest(self.smooth, 3)


def look(
    image: DepthImage, mask: NDArray[np.bool_] | None, settings: ViewSettings
) -> tuple[Rectified, TableView | str]:
    """The canonical view of an image with the places to grasp, or the reason why there are none.

    Places are pixels that were seen and stand above the table: those under the mask, or without one those of every
    thing that the image does not cut off at its border (only where it cuts off all things, those too).

    Raises:
        ImageError: no table plane, a camera that does not look at the table, or a mask that does not fit.
    """
    rectified = rectify(image)
    middle = rectified.middle(_whole_raised(rectified, mask, settings))
    if np.linalg.norm(middle - rectified.canvas.pose[:2, 3]) > _ASIDE:
        rectified = rectified.above(middle)
    places = _places(rectified, mask, settings)
    if not places.any():
        if mask is not None and not mask.any():
            return rectified, "the mask is empty: it is false (black) everywhere, so that nothing may be grasped"
        where = "" if mask is None else " under the mask"
        return rectified, (
            f"no object above the table: nothing seen{where} stands more than"
            f" {settings.least_height * 1000:.0f} mm above it"
        )
    rows = _stretch(np.flatnonzero(places.any(axis=1)), places.shape[0], _MARGIN, _LEAST_WINDOW)
    columns = _stretch(np.flatnonzero(places.any(axis=0)), places.shape[1], _MARGIN, _LEAST_WINDOW)
    canvas = rectified.canvas
    k = msgspec.structs.replace(
        canvas.intrinsics,
        cx=canvas.intrinsics.cx - columns.start,
        cy=canvas.intrinsics.cy - rows.start,
        width=columns.stop - columns.start,
        height=rows.stop - rows.start,
    )
    return rectified, TableView(
        rectified, settings, rows, columns, places[rows, columns], Camera(k, canvas.world_from_camera)
    )


def _places(rectified: Rectified, mask: NDArray[np.bool_] | None, settings: ViewSettings) -> NDArray[np.bool_]:
    """Boolean (H, W) of the canvas: where grasps may be centred; see `look`."""
    raised = (rectified.image.depth < CANONICAL_HEIGHT - settings.least_height) & rectified.seen
    if mask is not None:
        return raised & rectified.carry(mask)
    return _whole_things(rectified, raised, settings.least_area)


def _whole_raised(rectified: Rectified, mask: NDArray[np.bool_] | None, settings: ViewSettings) -> NDArray[np.bool_]:
    """Boolean (H, W) of the turned view: about what the places show, to put the canonical camera over."""
    raised = rectified.turned > settings.least_height
    if mask is not None:
        return raised & rectified.turn_mask(mask)
    inside = _bounds(raised)
    if inside is not None:
        count, labels = _components(raised[inside])
        large = np.bincount(labels.reshape(-1), minlength=count) >= settings.least_area
        large[0] = False
        whole = large.copy()
        whole[labels[rectified.rim[inside]]] = False
        raised[inside] = (whole if whole.any() else large)[labels]
    return raised


def _whole_things(rectified: Rectified, raised: NDArray[np.bool_], least_area: int) -> NDArray[np.bool_]:
    """Raised pixels (H, W) in areas of at least that many, without surfaces that reach the border of the input image.

    A surface ends at a step in depth, so that what merely touches a cut-off thing stays. Small areas left close to one
    are taken for its torn-off pieces.
    """
    places = np.zeros_like(raised)
    inside = _bounds(raised)
    if inside is None:
        return places
    things = _large(raised[inside], least_area)
    at_border = np.zeros_like(raised)
    start, target = rectified.moved
    at_border.reshape(-1)[target[rectified.rim.reshape(-1)[start]]] = True
    for side in (at_border[:_RIM], at_border[-_RIM:], at_border[:, :_RIM], at_border[:, -_RIM:]):
        side[:] = True
    at_border = at_border[inside] & things
    if at_border.any():
        whole = _without_cut(things, at_border, rectified.image.depth[inside], least_area)
        things = whole if whole.any() else things
    places[inside] = things
    return places


def _without_cut(
    things: NDArray[np.bool_], at_border: NDArray[np.bool_], depth: NDArray[np.float32], least_area: int
) -> NDArray[np.bool_]:
    """Things (h, w) without the surfaces that hold a pixel `at_border`, and without their pieces."""
    step = cv2.dilate(depth, _SQUARE) - cv2.erode(depth, _SQUARE)
    count, labels = _components(things & (step < _STEP_DEPTH))
    cut = np.zeros(count, bool)
    cut[labels[at_border]] = True
    cut[0] = False
    lost = (cut[labels] | at_border).view(np.uint8)
    whole = things & (cv2.dilate(lost, _SQUARE, iterations=2) == 0)
    count, labels = _components(whole)
    near = np.zeros(count, bool)
    near[labels[cv2.dilate(lost, _PIECE_REACH) > 0]] = True
    large = np.bincount(labels.reshape(-1), minlength=count) >= np.where(near, _PIECE_AREA, least_area)
    large[0] = False
    return np.asarray(large[labels])


def _large(mask: NDArray[np.bool_], least_area: int) -> NDArray[np.bool_]:
    """The connected areas of a mask that have at least that many pixels."""
    count, labels = _components(mask)
    large = np.bincount(labels.reshape(-1), minlength=count) >= least_area
    large[0] = False
    return np.asarray(large[labels])


def _bounds(mask: NDArray[np.bool_]) -> tuple[slice, slice] | None:
    """Rows and columns that hold all true pixels, with a border of one where there is room; None for none."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    if not len(rows):
        return None
    return slice(max(rows[0] - 1, 0), rows[-1] + 2), slice(max(columns[0] - 1, 0), columns[-1] + 2)


def _components(mask: NDArray[np.bool_]) -> tuple[int, NDArray[np.int32]]:
    """Number of connected areas with the background, and the label (H, W) of every pixel."""
    image = np.ascontiguousarray(mask).view(np.uint8)
    count, labels = cv2.connectedComponents(image, connectivity=8, ltype=cv2.CV_32S)
    return count, np.asarray(labels, np.int32)


def _stretch(inside: NDArray[np.intp], size: int, margin: int, least: int) -> slice:
    """Stretch of an axis that holds the indices `inside` with a margin, in steps of sizes where there is room."""
    low, high = int(inside[0]) - margin, int(inside[-1]) + 1 + margin
    want = high - low
    want = min(max(want + -want % _STEP, least), size)
    start = min(max((low + high - want) // 2, 0), size - want)
    return slice(start, start + want)
