"""The simulated depth camera: exact z-depth of objects and table by ray casting.

Embree casts the rays through embreex's own scene object (three times faster than through trimesh); where embreex has no
wheel, trimesh's own ray tracer does, slowly. The table is the plane z = 0 and is intersected analytically. An object
keeps its ray-cast scene in its own frame, and the rays are moved into it: new poses build nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from grasp_core.camera import Camera, DepthImage
from grasp_core.objects.asset import ObjectAsset
from grasp_core.scene import Scene
from grasp_core.sensing.rays import pixel_rays


class Caster(Protocol):
    """Casts rays that share one origin at one mesh."""

    def __call__(self, origin: NDArray[np.float32], rays: NDArray[np.float32]) -> NDArray[np.float32]:
        """Origin (3,) and rays (N, 3) in the mesh's frame → distances (N,) in ray lengths, inf where nothing is met."""
        ...


def embree_caster(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> Caster:
    """A caster on Embree; distances are exact to about 1e-7 of the farthest coordinate.

    Raises:
        ImportError: embreex is not installed.
    """
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    scene = EmbreeScene()
    TriangleMesh(scene, np.ascontiguousarray(vertices, np.float32), np.ascontiguousarray(faces, np.int32))

    def cast(origin: NDArray[np.float32], rays: NDArray[np.float32]) -> NDArray[np.float32]:
        distances = scene.run(np.broadcast_to(origin, rays.shape), rays, query="DISTANCE")
        distances[distances > 1e30] = np.inf
        return distances

    return cast


def trimesh_caster(vertices: NDArray[np.float64], faces: NDArray[np.int32]) -> Caster:
    """A caster on trimesh's own ray tracer (needs rtree): the fallback where Embree is missing."""
    import trimesh
    from trimesh.ray.ray_triangle import RayMeshIntersector

    tracer = RayMeshIntersector(trimesh.Trimesh(vertices, faces, process=False))

    def cast(origin: NDArray[np.float32], rays: NDArray[np.float32]) -> NDArray[np.float32]:
        distances = np.full(len(rays), np.inf, np.float32)
        points, index, _ = tracer.intersects_location(np.broadcast_to(origin, rays.shape), rays, multiple_hits=True)
        if len(index):
            along = np.linalg.norm(points - origin, axis=1) / np.linalg.norm(rays[index], axis=1)
            np.minimum.at(distances, index, along.astype(np.float32))
        return distances

    return cast


def make_caster(asset: ObjectAsset) -> Caster:
    """The fastest caster that this machine has, on an asset's visual mesh."""
    try:
        return embree_caster(asset.vertices, asset.faces)
    except ImportError:
        return trimesh_caster(asset.vertices, asset.faces)


class Renderer:
    """Renders one scene's objects again and again, at other poses or from other cameras.

    Attributes:
        scene: the scene that it was made for.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        casters: dict[int, Caster] = {}
        for placed in scene.objects:
            if id(placed.asset) not in casters:
                casters[id(placed.asset)] = make_caster(placed.asset)
        self._casters = [casters[id(placed.asset)] for placed in scene.objects]

    def render(self, camera: Camera | None = None, poses: Sequence[ArrayLike] | None = None) -> DepthImage:
        """Exact z-depth (H, W) of the objects and the table.

        Args:
            camera: with its pose; the scene's by default.
            poses: world_from_object, 4×4, one for each object of the scene; the scene's by default.

        Returns:
            The depth image; pixels that see neither object nor table are invalid.

        Raises:
            GraspError: the camera has no pose.
        """
        camera = camera or self.scene.camera
        if poses is None:
            poses = [placed.world_from_object for placed in self.scene.objects]
        depth = _table_depth(camera)
        rays = pixel_rays(camera.intrinsics)
        for placed, caster, pose in zip(self.scene.objects, self._casters, poses, strict=True):
            object_from_camera = np.linalg.inv(np.asarray(pose, float)) @ camera.pose
            rows, columns = _window(placed.asset, object_from_camera, camera)
            part = rays[rows, columns]
            if not part.size:
                continue
            turned = part.reshape(-1, 3) @ object_from_camera[:3, :3].T.astype(np.float32)
            met = caster(object_from_camera[:3, 3].astype(np.float32), turned).reshape(part.shape[:2])
            np.fmin(depth[rows, columns], met, out=depth[rows, columns])
        valid = np.isfinite(depth) & np.isfinite(rays[:, :, 0])
        depth[~valid] = 0
        return DepthImage(depth, camera, valid)


def render(scene: Scene, camera: Camera | None = None) -> DepthImage:
    """Exact z-depth of a scene, once; use a `Renderer` for several views or poses of the same objects.

    Raises:
        GraspError: the camera has no pose.
    """
    return Renderer(scene).render(camera)


def _table_depth(camera: Camera) -> NDArray[np.float32]:
    """z-depth (H, W) of the plane z = 0, inf where a ray does not meet it."""
    rays = pixel_rays(camera.intrinsics)
    down = (rays @ -camera.pose[2, :3].astype(np.float32)).astype(np.float64)
    with np.errstate(divide="ignore"):
        depth = camera.pose[2, 3] / down
    return np.where((down > 1e-9) & (depth > 0), depth, np.inf).astype(np.float32)


def _window(asset: ObjectAsset, object_from_camera: NDArray[np.float64], camera: Camera) -> tuple[slice, slice]:
    """Rows and columns that can see the object: the bounds of its projected vertices; all where that is unsafe."""
    k = camera.intrinsics
    points = (asset.vertices - object_from_camera[:3, 3]) @ object_from_camera[:3, :3]
    if k.distortion is not None or len(points) == 0 or points[:, 2].min() < 1e-3:
        return slice(0, k.height), slice(0, k.width)
    u = k.fx * points[:, 0] / points[:, 2] + k.cx
    v = k.fy * points[:, 1] / points[:, 2] + k.cy

    def bounds(values: NDArray[np.float64], size: int) -> slice:
        low, high = int(np.floor(values.min())) - 1, int(np.ceil(values.max())) + 2
        return slice(min(max(low, 0), size), min(max(high, 0), size))

    return bounds(v, k.height), bounds(u, k.width)
