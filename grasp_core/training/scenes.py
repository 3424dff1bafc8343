"""What the trainers read: canonical depth images with their labelled grasps, in memory.

A stored scene has one clean depth image with its object in the middle. Labels do not change when the whole scene is
turned and moved on the table, so each scene may be rendered again at other places, and by other cameras, tilted or with
the object aside, through the same rectification as in planning: what the networks meet in use, with true perspective
and true occlusion.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grasp_core import config
from grasp_core.camera import Camera, CameraIntrinsics, DepthImage, canonical_camera, look_down
from grasp_core.errors import MismatchError
from grasp_core.networks.weights import View
from grasp_core.planning.crops import grasp_pixels
from grasp_core.scene import Scene
from grasp_core.sensing.rectify import rectify
from grasp_core.sensing.renderer import Renderer

DEPTH_UNIT = 1e-4
"""Metres per unit of the depth kept in memory, as in the store."""

SIZE = canonical_camera().intrinsics.width
"""Side of the training images, pixels."""
_MARGIN = 10
"""Pixels that stay free between the scene and the border of another camera's image."""


class Views(config.Settings):
    """Further views of each training scene.

    Attributes:
        count: renderings besides the stored one.
        reach: the canonical camera stands aside of the scene by up to this much along x and y, metres.
        tilted: share of these views that are taken by another camera: tilted, higher or lower, of another focal
            length, and made canonical as in planning.
        aside: such a camera looks past the scene by up to this much along x and y, metres, but sees all of it.
        tilt: largest tilt, rad.
        height: least and greatest height of that camera, metres.
        focal: least and greatest focal length of that camera, pixels at 640×480.
    """

    count: int = 0
    reach: float = 0.08
    tilted: float = 0.5
    aside: float = 0.0
    tilt: float = 0.6
    height: tuple[float, float] = (0.55, 0.9)
    focal: tuple[float, float] = (450.0, 700.0)

    def __post_init__(self) -> None:
        if min(self.count, self.reach, self.aside) < 0 or not 0 <= self.tilted <= 1 or not 0 <= self.tilt < 1.2:
            raise ValueError("views: count, reach, aside are at least 0, tilted is a share, tilt lies in [0, 1.2) rad")
        for name in ("height", "focal"):
            low, high = getattr(self, name)
            if not 0 < low <= high:
                raise ValueError(f"views: {name} is a least and a greatest value above 0, not {low} and {high}")


@dataclass(frozen=True)
class GraspLabels:
    """Labelled grasps in the world.

    Attributes:
        positions: p (G, 3), metres.
        angles: φ (G,), rad.
        labels: (G,) in [0, 1]; NaN leaves the grasp out.
        colliding: (G,) bool, every attempt collided.
    """

    positions: NDArray[np.float64]
    angles: NDArray[np.float64]
    labels: NDArray[np.float64]
    colliding: NDArray[np.bool_]

    def moved(self, transform: NDArray[np.float64]) -> GraspLabels:
        """The grasps after the whole scene was moved by a 4×4 transform about the vertical."""
        yaw = math.atan2(transform[1, 0], transform[0, 0])
        positions = self.positions @ transform[:3, :3].T + transform[:3, 3]
        return GraspLabels(positions, self.angles + yaw, self.labels, self.colliding)


@dataclass(frozen=True)
class TrainingScene:
    """One canonical view of a scene and its labelled grasps.

    Attributes:
        name: of the scene.
        object: its object's name; splits and tables go by it.
        units: (H, W) uint16 canonical depth in `DEPTH_UNIT`, clean, without holes.
        camera: of that image: straight down from the canonical height.
        pixels: (G, 2) of the surface above p, as (u, v).
        angles: (G,) closing axes in the image, rad, counter-clockwise as displayed.
        depths: (G,) z-depth of p, metres.
        labels: (G,) in [0, 1].
        colliding: (G,) bool, every attempt collided.
    """

    name: str
    object: str
    units: NDArray[np.uint16]
    camera: Camera
    pixels: NDArray[np.float32]
    angles: NDArray[np.float32]
    depths: NDArray[np.float32]
    labels: NDArray[np.float32]
    colliding: NDArray[np.bool_]

    @property
    def stored(self) -> str:
        """Name of the stored scene that this is a view of."""
        return self.name.split("/")[0]

    @property
    def depth(self) -> NDArray[np.float32]:
        """(H, W) canonical depth, metres."""
        return self.units.astype(np.float32) * np.float32(DEPTH_UNIT)

    def openings(self, opening: float) -> NDArray[np.float32]:
        """(G,) pixels that an opening in metres spans at each grasp."""
        return np.asarray(self.camera.intrinsics.fx * opening / self.depths, np.float32)

    @property
    def perfect(self) -> NDArray[np.float32]:
        """(K, 2) pixels of the grasps of quality 1."""
        return self.pixels[self.labels >= 1.0]


def training_scene(name: str, object_name: str, image: DepthImage, grasps: GraspLabels) -> TrainingScene:
    """Find labelled grasps in their canonical depth image; those outside of it and those without label are left out.

    Raises:
        MismatchError: the image is no canonical view, or has holes.
    """
    pose, k, view = image.camera.pose, image.camera.intrinsics, View()
    down = np.allclose(pose[:3, 2], [0, 0, -1], atol=1e-6) and abs(pose[2, 3] - view.height) < 1e-6
    if not (down and k.fx == k.fy == view.focal and k.distortion is None and image.valid.all()):
        raise MismatchError(
            f"scene {name}: training reads canonical views without holes (straight down from {view.height} m, fx = fy ="
            f" {view.focal}); generate the dataset with the canonical camera"
        )
    labelled = np.isfinite(grasps.labels)
    u, v, angles, depths = grasp_pixels(image.depth, image.camera, grasps.positions[labelled], grasps.angles[labelled])
    inside = (u >= 0) & (v >= 0) & (u <= k.width - 1) & (v <= k.height - 1)
    return TrainingScene(
        name=name,
        object=object_name,
        units=np.clip(np.rint(image.depth / DEPTH_UNIT), 0, np.iinfo(np.uint16).max).astype(np.uint16),
        camera=image.camera,
        pixels=np.stack([u, v], axis=-1)[inside].astype(np.float32),
        angles=angles[inside].astype(np.float32),
        depths=depths[inside].astype(np.float32),
        labels=grasps.labels[labelled][inside].astype(np.float32),
        colliding=grasps.colliding[labelled][inside],
    )


def more_views(
    name: str, object_name: str, scene: Scene, grasps: GraspLabels, views: Views, rng: np.random.Generator
) -> Iterator[TrainingScene]:
    """Render a scene again, turned and moved at random, from straight above or by another camera and rectified."""
    renderer = Renderer(scene)
    straight = canonical_camera()
    for index in range(views.count):
        move = _about_vertical(rng.uniform(-np.pi, np.pi))
        if rng.random() < views.tilted:
            camera, reach = _other_camera(views, rng), views.aside
            while True:
                move[:2, 3] = rng.uniform(-reach, reach, 2)
                corners = _corners(scene, move)
                if reach < 0.01 or camera.sees(corners, _MARGIN):
                    break
                reach *= 0.9
            poses = [move @ placed.world_from_object for placed in scene.objects]
            over = (corners[:, :2].min(axis=0) + corners[:, :2].max(axis=0)) / 2
            over += rng.uniform(-views.reach, views.reach, 2)
            image = _middle(rectify(renderer.render(camera, poses)).above(over).image)
        else:
            move[:2, 3] = rng.uniform(-views.reach, views.reach, 2)
            image = renderer.render(straight, [move @ placed.world_from_object for placed in scene.objects])
        yield training_scene(f"{name}/{index + 1}", object_name, image, grasps.moved(move))


def one_view_each(scenes: Sequence[TrainingScene], rng: np.random.Generator) -> NDArray[np.intp]:
    """Indices of one view of every stored scene, drawn at random, in random order."""
    views: dict[str, list[int]] = {}
    for index, scene in enumerate(scenes):
        views.setdefault(scene.stored, []).append(index)
    return rng.permutation(np.array([rng.choice(indices) for indices in views.values()], np.intp))


def _other_camera(views: Views, rng: np.random.Generator) -> Camera:
    """A camera that looks at the world's origin from any side, within the bounds of the settings."""
    focal = rng.uniform(*views.focal)
    pose = look_down(rng.uniform(*views.height), tilt=rng.uniform(0, views.tilt))
    return Camera(
        CameraIntrinsics(focal, focal, 319.5, 239.5, 640, 480), _about_vertical(rng.uniform(-np.pi, np.pi)) @ pose
    )


def _corners(scene: Scene, move: NDArray[np.float64]) -> NDArray[np.float64]:
    """All vertices (N, 3) of a moved scene, world, metres."""
    vertices = np.concatenate([placed.vertices for placed in scene.objects])
    return np.asarray(vertices @ move[:3, :3].T + move[:3, 3])


def _about_vertical(yaw: float) -> NDArray[np.float64]:
    """4×4 rotation about the world's z axis."""
    c, s = math.cos(yaw), math.sin(yaw)
    turn = np.eye(4)
    turn[:2, :2] = [[c, -s], [s, c]]
    return turn


def _middle(canvas: DepthImage) -> DepthImage:
    """The `SIZE` pixels square of a canvas around the place below its camera, padded with bare table."""
    k = canvas.camera.intrinsics
    left, top = round(k.cx - (SIZE - 1) / 2), round(k.cy - (SIZE - 1) / 2)
    depth = np.full((SIZE, SIZE), canvas.camera.pose[2, 3], np.float32)
    rows = slice(max(top, 0), min(top + SIZE, k.height))
    columns = slice(max(left, 0), min(left + SIZE, k.width))
    depth[rows.start - top : rows.stop - top, columns.start - left : columns.stop - left] = canvas.depth[rows, columns]
    intrinsics = CameraIntrinsics(k.fx, k.fy, k.cx - left, k.cy - top, SIZE, SIZE)
    return DepthImage(depth, Camera(intrinsics, canvas.camera.pose), np.ones(depth.shape, np.bool_))
