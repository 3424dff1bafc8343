"""Pictures of failures: what the planner saw, what it chose, and how the executions ended (OpenCV only)."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from grasp_core.camera import DepthImage
from grasp_core.evaluation.records import CandidateRecord, PlanRecord
from grasp_core.grasp import rectangle_corners, to_image
from grasp_core.lettering import plain
from grasp_core.planning.picture import write_picture
from grasp_core.planning.planner import Plan

Picture = NDArray[np.uint8]

_SHOWN = 8
_TALL = 480
"""Pixels: about the height of a picture without its caption."""
_AROUND = 70
"""Pixels around the objects that are shown: the fingers stand there."""
_GREEN, _AMBER, _RED = (80, 200, 60), (40, 170, 240), (60, 60, 230)
_WHITE, _GREY, _BLACK = (255, 255, 255), (150, 150, 150), (0, 0, 0)
_JAW = 0.02
"""Metres: drawn side of a rectangle across the closing axis."""


def draw_failure(path: Path, image: DepthImage, plan: Plan | None, record: PlanRecord) -> None:
    """Write one picture: depth with the executed grasps, the quality map beside it, the outcomes below.

    Args:
        path: of the PNG; its folder is made.
        image: as planned on.
        plan: of an image-based planner, with its quality map; None for scene planners.
        record: what was executed and how it ended.

    Raises:
        ImageError: the file cannot be written.
    """
    rows, columns = around_objects(image)
    zoom = max(1, round(_TALL / (rows.stop - rows.start)))
    depth = cv2.resize(depth_picture(image)[rows, columns], None, fx=zoom, fy=zoom, interpolation=cv2.INTER_NEAREST)
    panels = [np.asarray(depth, np.uint8)]
    for rank, candidate in reversed(list(enumerate(record.candidates[:_SHOWN]))):
        _draw_grasp(panels[0], image, candidate, (columns.start, rows.start), zoom, best=rank == 0)
    if plan is not None and plan.quality_map.any():
        panels.append(_fit(heat_picture(plan.quality_map), panels[0].shape[0]))
    picture = _captioned(np.concatenate(panels, axis=1), _lines(record))
    path.parent.mkdir(parents=True, exist_ok=True)
    write_picture(path, picture)


def around_objects(image: DepthImage) -> tuple[slice, slice]:
    """Rows and columns of an image around what stands more than 1 cm above the table; all of it where nothing does."""
    v, u = np.nonzero(image.valid & (image.points()[..., 2] > 0.01))
    height, width = image.depth.shape
    if not len(u):
        return slice(0, height), slice(0, width)
    # Noise far from the object stands above the table in places too: leave out the outermost shares.
    (top, bottom), (left, right) = (np.percentile(axis, [1, 99]).astype(int) for axis in (v, u))
    rows = slice(max(0, top - _AROUND), min(height, bottom + _AROUND))
    return rows, slice(max(0, left - _AROUND), min(width, right + _AROUND))


def contact_sheet(folder: Path, columns: int = 3, most: int = 30) -> Path | None:
    """Join the first pictures of a folder into `sheet.png` beside them; None if there are none.

    Where there are more, the sheet says how many and where they are.

    Raises:
        ImageError: the sheet cannot be written.
    """
    files = failures(folder)
    pictures = [read for path in files[:most] if (read := cv2.imread(str(path))) is not None]
    if not pictures:
        return None
    width = 480
    small = [
        cv2.resize(p, (width, round(p.shape[0] * width / p.shape[1])), interpolation=cv2.INTER_AREA) for p in pictures
    ]
    tall = max(p.shape[0] for p in small)
    cells = [cv2.copyMakeBorder(p, 2, tall - p.shape[0] + 2, 2, 2, cv2.BORDER_CONSTANT, value=_WHITE) for p in small]
    cells += [np.full_like(cells[0], 255)] * (-len(cells) % columns)
    rows = [np.concatenate(cells[start : start + columns], axis=1) for start in range(0, len(cells), columns)]
    sheet = np.concatenate(rows, axis=0).astype(np.uint8)
    if len(files) > most:
        line = f"{most} of {len(files)} pictures; the other {len(files) - most} are in the same folder, {folder.name}"
        sheet = _captioned(sheet, [line])
    path = folder / "sheet.png"
    write_picture(path, sheet)
    return path


def failures(folder: Path) -> list[Path]:
    """The pictures of a folder without their sheet, by name."""
    return sorted(path for path in folder.glob("*.png") if path.name != "sheet.png")


def depth_picture(image: DepthImage) -> Picture:
    """Depth in grey (H, W, 3), near is bright; invalid pixels are dark blue."""
    depth, valid = image.depth, image.valid
    low, high = np.percentile(depth[valid], [0.5, 99.5]) if valid.any() else (0.0, 1.0)
    grey = np.clip((high - depth) / max(high - low, 1e-6), 0, 1) * 215 + 40
    picture = np.repeat(grey.astype(np.uint8)[:, :, None], 3, axis=2)
    picture[~valid] = (90, 30, 20)
    return np.ascontiguousarray(picture)


def heat_picture(quality: NDArray[np.float32]) -> Picture:
    """A quality map in colours (H, W, 3), clipped to [0, 1] for display only."""
    return np.asarray(
        cv2.applyColorMap((np.clip(quality, 0, 1) * 255).astype(np.uint8), cv2.COLORMAP_VIRIDIS), np.uint8
    )


def _fit(picture: Picture, height: int) -> Picture:
    width = max(1, round(picture.shape[1] * height / picture.shape[0]))
    return np.asarray(cv2.resize(picture, (width, height), interpolation=cv2.INTER_NEAREST), np.uint8)


def _draw_grasp(
    picture: Picture, image: DepthImage, candidate: CandidateRecord, corner: tuple[int, int], zoom: int, *, best: bool
) -> None:
    """The rectangle of a grasp; the best one's sides where the fingers stand are thick. Colour says how it went."""
    grasp = to_image(candidate.grasp, image.camera)
    jaw = _JAW * grasp.width / candidate.grasp.width
    u, v = ((value - start + 0.5) * zoom for value, start in zip((grasp.u, grasp.v), corner, strict=True))
    corners = np.rint(rectangle_corners(u, v, grasp.angle, grasp.width * zoom, jaw * zoom)).astype(int)
    share = candidate.successes / max(1, len(candidate.outcomes))
    colour = _GREEN if share == 1 else _AMBER if share > 0 else _RED
    points = [(int(x), int(y)) for x, y in corners]
    cv2.polylines(picture, [corners.reshape(-1, 1, 2).astype(np.int32)], True, colour, 1, cv2.LINE_AA)
    if best:
        cv2.line(picture, points[1], points[2], colour, 3, cv2.LINE_AA)
        cv2.line(picture, points[3], points[0], colour, 3, cv2.LINE_AA)
        cv2.circle(picture, (round(u), round(v)), 3, _WHITE, -1, cv2.LINE_AA)


def _lines(record: PlanRecord) -> list[str]:
    lines = [f"{record.scene}   {record.planner}   {record.plan_ms:.0f} ms"]
    if not record.candidates:
        return [*lines, f"empty plan: {record.reason or 'no reason given'}"]
    for rank, candidate in enumerate(record.candidates[:_SHOWN], start=1):
        lines.append(f"{rank}  score {candidate.score:.3f}  {' '.join(candidate.outcomes)}")
    return lines


def _captioned(picture: Picture, lines: list[str]) -> Picture:
    step = 18
    caption = np.full((step * len(lines) + 8, picture.shape[1], 3), 255, np.uint8)
    for row, line in enumerate(lines):
        place = (6, step * (row + 1) - 2)
        colour = _BLACK if row else _GREY
        cv2.putText(caption, plain(line), place, cv2.FONT_HERSHEY_SIMPLEX, 0.42, colour, 1, cv2.LINE_AA)
    return np.concatenate([picture, caption], axis=0)
