"""Candidates of a grasp: the region (Eq. 6), pixels and angles in it, what the gripper can reach, and diversity.

A `Batch` holds many candidates as arrays; everything here works on all of them at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from grasp_core import config
from grasp_core.camera import Camera
from grasp_core.grasp import Grasp, ImageGrasp
from grasp_core.gripper import Gripper
from grasp_core.planning.crops import canvas_yaw, deepen, grasp_positions, sample
from grasp_core.planning.planner import Candidate
from grasp_core.planning.view import TableView
from grasp_core.sensing.lookup import look_up

_REACH = 0.003
"""Metres: a surface counts as in the way from this far above the finger tips on; less is noise."""
_SPACING = 0.005
"""Metres, at most, between points of a footprint."""


@dataclass(frozen=True, eq=False)
class Batch:
    """Candidates on the window of a view, one a row.

    Attributes:
        u: column (N,) of the surface point, window pixels.
        v: row (N,).
        angle: of the closing axis on the canvas, rad (N,).
        depth: z-depth of p from the canonical camera, metres (N,).
        position: p in the world, metres (N, 3).
    """

    u: NDArray[np.float64]
    v: NDArray[np.float64]
    angle: NDArray[np.float64]
    depth: NDArray[np.float64]
    position: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.u)

    def __getitem__(self, which: NDArray | slice) -> Batch:
        return Batch(self.u[which], self.v[which], self.angle[which], self.depth[which], self.position[which])

    @classmethod
    def join(cls, batches: Sequence[Batch]) -> Batch:
        """All candidates of several batches, in order."""
        return cls(*(np.concatenate(parts) for parts in zip(*(vars(b).values() for b in batches), strict=True)))


def make_batch(view: TableView, u: ArrayLike, v: ArrayLike, angle: ArrayLike) -> Batch:
    """Candidates at window pixels (u, v) with angles on the canvas, each (N,); depths follow from the rule."""
    u, v, angle = (np.asarray(array, float) for array in (u, v, angle))
    rule = view.settings.depth_rule
    depth = deepen(sample(view.surface, u, v), view.camera, rule)
    return Batch(u, v, angle, depth, grasp_positions(view.surface, view.camera, u, v, rule))


def best_region(
    heat: NDArray[np.float32], places: NDArray[np.bool_], radius: float
) -> tuple[int, int, NDArray[np.bool_]] | None:
    """The region of Eq. 6: the place of the highest heat, and all places within `radius` pixels of it.

    Returns:
        (u, v, boolean (H, W) of the region's places), or None when there is no place.
    """
    if not places.any():
        return None
    best = int(np.argmax(np.where(places, heat, -np.inf)))
    v, u = divmod(best, heat.shape[1])
    reach = int(np.ceil(radius))
    rows = slice(max(v - reach, 0), v + reach + 1)
    columns = slice(max(u - reach, 0), u + reach + 1)
    y, x = np.ogrid[rows.start : min(rows.stop, heat.shape[0]), columns.start : min(columns.stop, heat.shape[1])]
    region = np.zeros_like(places)
    region[rows, columns] = places[rows, columns] & ((x - u) ** 2 + (y - v) ** 2 <= radius**2)
    return u, v, region


def sample_pixels(
    heat: NDArray[np.float32], region: NDArray[np.bool_], count: int, rng: np.random.Generator
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """At most `count` different pixels of a region, drawn in proportion to their heat.

    Returns:
        u and v, each (K,), in the order in which they were drawn.
    """
    inside = np.flatnonzero(region)
    weight = np.maximum(heat.reshape(-1)[inside].astype(float), 0)
    weight += 0.05 * max(float(weight.max(initial=0)), 1e-6)  # cold pixels are sampled too, less often
    # the largest of log w + Gumbel noise are a draw without replacement in proportion to w
    keys = np.log(weight) + rng.gumbel(size=len(inside))
    chosen = inside[np.argsort(-keys)[:count]]
    v, u = np.divmod(chosen, region.shape[1])
    return u.astype(float), v.astype(float)


def spread_angles(pixels: int, angles: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Angles (pixels, angles) in [−π/2, π/2): evenly spread for each pixel, from a phase and in an order of its own."""
    step = np.pi / angles
    order = rng.permuted(np.tile(np.arange(angles), (pixels, 1)), axis=1)
    return (order + rng.random((pixels, 1))) * step - np.pi / 2


def reachable(batch: Batch, view: TableView, gripper: Gripper) -> NDArray[np.bool_]:
    """Boolean (N,): whether the open gripper comes straight down to p without meeting the surface that was seen.

    Fingers, rod and base are compared with the depth image under their footprints. Where something hides a place from
    the camera, it may be as full as what hides it is high: the lower ends of all of them must be in sight.
    """
    across, down = _placing(batch, view)
    left = np.arange(len(batch))
    for (footprint, above), surface in zip(_footprints(gripper), (view.smooth, view.crests, view.crests), strict=True):
        for clear in (partial(_above_surface, surface=surface), _in_sight):
            left = left[clear(batch.depth[left] - above, across[left], down[left], footprint, view)]
    free = np.zeros(len(batch), np.bool_)
    free[left] = True
    return free


class PoseNoise(config.Settings):
    """How far the robot strays from the pose that it is told (Eq. 4), as far as planning cares.

    Attributes:
        sigma_p: standard deviation of each coordinate of p, metres.
        sigma_phi: of φ, rad.
        draws: poses that are looked at around each grasp; 0 looks at none.
    """

    sigma_p: float = 0.0025
    sigma_phi: float = 0.044
    draws: int = 16

    def __post_init__(self) -> None:
        if self.sigma_p < 0 or self.sigma_phi < 0 or self.draws < 0:
            told = f"{self.sigma_p}, {self.sigma_phi} and {self.draws}"
            raise ValueError(f"sigma_p, sigma_phi and draws must be at least 0, not {told}")


def reach_share(batch: Batch, view: TableView, gripper: Gripper, noise: PoseNoise) -> NDArray[np.float32]:
    """Share (N,) of the poses around each grasp, drawn as the robot strays, that are `reachable` too.

    The same draws serve all grasps, in opposite pairs, so that equal grasps get equal shares.
    """
    if not noise.draws or not len(batch):
        return np.ones(len(batch), np.float32)
    half = np.random.default_rng(0).standard_normal((-(-noise.draws // 2), 4))
    draws = np.concatenate([half, -half])[: noise.draws]
    strayed = batch[np.repeat(np.arange(len(batch)), len(draws))]
    right, away, up, turn = np.tile(draws * [*[noise.sigma_p] * 3, noise.sigma_phi], (len(batch), 1)).T
    strayed = replace(
        strayed,
        angle=strayed.angle + turn,
        depth=strayed.depth - up,
        position=strayed.position + np.stack([right, away, up], axis=-1),
    )
    free = reachable(strayed, view, gripper).reshape(len(batch), len(draws))
    return free.mean(axis=1, dtype=np.float32)


def cleared(
    scores: NDArray[np.float32], batch: Batch, view: TableView, gripper: Gripper, noise: PoseNoise, threshold: float
) -> NDArray[np.float32]:
    """Scores (N,) of reachable grasps: what a network says of them, times the share of poses around that are free.

    What the network alone holds below the threshold stays as it is and is not looked at further.
    """
    good, found = scores >= threshold, scores.copy()
    found[good] *= reach_share(batch[good], view, gripper, noise)
    return found


@lru_cache(maxsize=8)
def _footprints(gripper: Gripper) -> tuple[tuple[NDArray[np.float32], float], ...]:
    """Points (3, P) under fingers, rod and base, and how far above p they count from, metres.

    Rows are ones, metres along the closing axis and metres across it; see `_placing`. Points are at most `_SPACING`
    apart; those under rod and base keep half of it from the border, for `TableView.crests` reach as far.
    """
    half, finger, rod, base = gripper.opening / 2, gripper.finger, gripper.rod, gripper.base
    sides = _spread(half, half + finger.x)
    jaws = np.concatenate([-sides[::-1], sides]), _spread(-finger.y / 2, finger.y / 2)
    bars = [[_spread(-(side - _SPACING) / 2, (side - _SPACING) / 2) for side in (box.x, box.y)] for box in (rod, base)]
    heights = (_REACH, finger.z, finger.z + rod.z)
    found = []
    for axes, above in zip((jaws, *bars), heights, strict=True):
        along, across = (grid.ravel() for grid in np.meshgrid(*axes))
        found.append((np.stack([np.ones_like(along), along, across]).astype(np.float32), above))
    return tuple(found)


def _spread(low: float, high: float) -> NDArray[np.float64]:
    """Numbers from `low` to `high`, metres, at most `_SPACING` apart; the middle where that is the wrong way round."""
    if high <= low:
        return np.array([(low + high) / 2])
    return np.linspace(low, high, int(np.ceil((high - low) / _SPACING - 1e-6)) + 1)


def _placing(batch: Batch, view: TableView) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """What takes footprint points to metres right of and down from the place under the canonical camera, (N, 3) each.

    Columns go with rows of a footprint: p itself, along and across the closing axis.
    """
    yaw = canvas_yaw(view.camera)
    x, y = (batch.position[:, :2] - view.camera.pose[:2, 3]).T
    cos, sin = np.cos(batch.angle), np.sin(batch.angle)
    right, down = np.cos(yaw) * x + np.sin(yaw) * y, np.sin(yaw) * x - np.cos(yaw) * y
    return np.stack([right, cos, sin], 1).astype(np.float32), np.stack([down, -sin, cos], 1).astype(np.float32)


def _above_surface(
    depth: NDArray[np.float64],
    across: NDArray[np.float32],
    down: NDArray[np.float32],
    footprint: NDArray[np.float32],
    view: TableView,
    surface: NDArray[np.float32],
) -> NDArray[np.bool_]:
    """Boolean (N,): whether all points of a footprint at z-depths (N,) lie above a surface (h, w) on the view's window.

    Those above the highest place of the surface are not looked up; see `_placing` for `across` and `down`.
    """
    clear = surface.min() > depth
    low = np.flatnonzero(~clear)
    k, depth = view.camera.intrinsics, depth[low, None]
    focal = (k.fx / depth).astype(np.float32)
    u, v = (focal * (offset[low] @ footprint) + np.float32(middle) for offset, middle in ((across, k.cx), (down, k.cy)))
    clear[low] = (look_up(surface, u, v, outside=np.inf) > depth).all(axis=1)
    return clear


def _in_sight(
    depth: NDArray[np.float64],
    across: NDArray[np.float32],
    down: NDArray[np.float32],
    footprint: NDArray[np.float32],
    view: TableView,
) -> NDArray[np.bool_]:
    """Boolean (N,): whether the input's camera sees all points of a footprint at z-depths (N,)."""
    height = view.camera.pose[2, 3] - depth
    clear = view.rectified.tallest <= height
    low = np.flatnonzero(~clear)
    hidden = view.rectified.hides(across[low] @ footprint, down[low] @ footprint, height[low, None])
    clear[low] = ~hidden.any(axis=1)
    return clear


def distinct(
    position: NDArray[np.float64],
    angle: NDArray[np.float64],
    order: NDArray[np.intp],
    least_distance: float,
    least_angle: float,
    most: int,
) -> NDArray[np.intp]:
    """The first `most` of `order` that are far enough, in p or in φ, from all chosen before.

    Args:
        position: p of all, metres (N, 3).
        angle: of their closing axes, rad (N,).
        order: indices, best first.
        least_distance: metres between two p.
        least_angle: rad between two closing axes.
        most: how many.
    """
    chosen: list[int] = []
    left = order
    while len(left) and len(chosen) < most:
        best, left = int(left[0]), left[1:]
        chosen.append(best)
        near = np.linalg.norm(position[left] - position[best], axis=1) < least_distance
        turned = np.abs((angle[left] - angle[best] + np.pi / 2) % np.pi - np.pi / 2)
        left = left[~(near & (turned < least_angle))]
    return np.array(chosen, np.intp)


def to_candidates(
    batch: Batch, scores: NDArray, heats: NDArray, view: TableView, gripper: Gripper
) -> tuple[Candidate, ...]:
    """The candidates as grasps of the world and of the input image, in the order of the batch."""
    camera = view.rectified.camera
    angles = batch.angle + canvas_yaw(view.camera)
    grasps = [
        Grasp((x, y, z), angle, gripper.opening)
        for (x, y, z), angle in zip(batch.position.tolist(), angles.tolist(), strict=True)
    ]
    images = image_grasps(batch.position, angles, gripper.opening, camera)
    return tuple(
        Candidate(grasp, seen, score, heat)
        for grasp, seen, score, heat in zip(grasps, images, scores.tolist(), heats.tolist(), strict=True)
    )


def image_grasps(positions: NDArray, angles: NDArray, width: float, camera: Camera) -> list[ImageGrasp]:
    """`grasp_core.grasp.to_image` for many grasps (p (N, 3), φ (N,)) of one width at once."""
    if not len(positions):
        return []
    projected = camera.project(positions)
    axes = np.stack([np.cos(angles), np.sin(angles)], axis=-1)[:, :, None]
    du, dv = (camera.horizontal_jacobian(positions) @ axes)[:, :, 0].T
    return [
        ImageGrasp(*row)
        for row in zip(
            projected[:, 0].tolist(),
            projected[:, 1].tolist(),
            np.arctan2(-dv, du).tolist(),
            (np.hypot(du, dv) * width).tolist(),
            projected[:, 2].tolist(),
            strict=True,
        )
    ]
