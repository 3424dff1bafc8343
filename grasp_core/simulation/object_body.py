"""One object in the DART world.

An object is one rigid body with two sets of collision shapes: its convex parts, which meet fingers and other objects,
and small spheres ("feet") on the vertices of its convex hull, which meet the table and other objects. Parts against the
table box would give at most four contacts and let objects sink; spheres against fingers would be bumps.
"""

from __future__ import annotations

import math
import tempfile
from pathlib import Path

import dartpy as dart
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from grasp_core.errors import MeshError
from grasp_core.objects.asset import ObjectAsset
from grasp_core.simulation.gripper_model import isometry
from grasp_core.simulation.physics import Physics

_SOLE = 2e-4
"""Metres above its lowest point up to which an object stands on its vertices."""


def support_points(
    asset: ObjectAsset, most: int, pose: NDArray[np.float64] | None = None, standing: int = 8
) -> NDArray[np.float64]:
    """(K, 3) vertices of the hull, K ≤ `most`, that stand in for it on the table; object frame, metres.

    Starts from what the object stands on in its pose (4×4), if one is given, and from the extremes along 26 directions;
    then adds, one by one, the vertex that sticks out farthest from the hull of those chosen so far.

    Args:
        asset: the object.
        most: at most so many points.
        pose: where the object rests, so that the vertices that it rests on are among the points.
        standing: at most so many of those are taken, far from each other; more contacts only cost time.
    """
    hull = np.asarray(asset.hull.vertices, float)
    if len(hull) <= min(most, standing):
        return hull
    grid = np.array([[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z], float)
    chosen: list[int] = []
    blocked = np.zeros(len(hull), bool)
    if pose is not None:
        heights = hull @ pose[2, :3]
        soles = np.flatnonzero(heights < heights.min() + _SOLE)
        chosen = _far_apart(hull, soles, standing)
        blocked[soles] = True
        grid = grid @ pose[:3, :3]
    for index in np.argmax(hull @ grid.T, axis=0).tolist():
        if index not in chosen and not blocked[index] and len(chosen) < most:
            chosen.append(index)
    while len(chosen) < most:
        planes = ConvexHull(hull[chosen], qhull_options="QJ").equations
        out = (hull @ planes[:, :3].T + planes[:, 3]).max(axis=1)
        out[chosen] = -1.0
        out[blocked] = -1.0
        best = int(out.argmax())
        if out[best] < _SOLE:
            break
        chosen.append(best)
    return hull[chosen]


def _far_apart(points: NDArray[np.float64], among: NDArray[np.intp], most: int) -> list[int]:
    """Up to `most` of the points `among`: the farthest from their mean, then each the farthest from the others."""
    distance = np.linalg.norm(points[among] - points[among].mean(axis=0), axis=1)
    chosen: list[int] = []
    while len(chosen) < min(most, len(among)):
        best = int(distance.argmax())
        if chosen and distance[best] < _SOLE:
            break
        chosen.append(int(among[best]))
        distance = np.linalg.norm(points[among][:, None] - points[chosen], axis=2).min(axis=1)
    return chosen


def _load_parts(asset: ObjectAsset, name: str, mass: float) -> dart.dynamics.Skeleton:
    """A skeleton of one free body with the asset's parts as its collision shapes.

    DART takes meshes from files only, so the parts pass through a temporary URDF.
    """
    inertia = asset.unit_inertia * (mass / asset.volume)
    ixx, ixy, ixz, iyy, iyz, izz = inertia[np.triu_indices(3)]
    with tempfile.TemporaryDirectory() as folder:
        collisions = []
        for index, part in enumerate(asset.parts):
            lines = [f"v {x:.9g} {y:.9g} {z:.9g}" for x, y, z in part.vertices]
            lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in part.faces]
            file = Path(folder) / f"part_{index}.obj"
            file.write_text("\n".join(lines) + "\n")
            collisions.append(f'<collision><geometry><mesh filename="{file}"/></geometry></collision>')
        urdf = Path(folder) / "object.urdf"
        urdf.write_text(
            f'<robot name="{name}"><link name="{name}"><inertial><mass value="{mass:.12g}"/>'
            f'<inertia ixx="{ixx:.12g}" ixy="{ixy:.12g}" ixz="{ixz:.12g}" iyy="{iyy:.12g}" iyz="{iyz:.12g}"'
            f' izz="{izz:.12g}"/></inertial>{"".join(collisions)}</link></robot>'
        )
        skeleton = dart.utils.DartLoader().parseSkeleton(str(urdf))
    if skeleton is None or skeleton.getBodyNode(0).getNumShapeNodes() != len(asset.parts):
        raise MeshError(f"DART could not load the {len(asset.parts)} convex parts of {asset.name}; import it again")
    skeleton.setName(name)
    return skeleton


class ObjectBody:
    """One object in the world.

    Attributes:
        asset: what it is.
        mass: kg.
        skeleton: DART's skeleton of it.
        body: the body with the parts.
        feet: the massless body welded to it that carries the spheres.
    """

    def __init__(
        self, asset: ObjectAsset, index: int, physics: Physics, feet: NDArray[np.float64], *, parts: bool
    ) -> None:
        """Build the object with spheres at `feet` (K, 3); without `parts` it meets nothing but the table."""
        name = f"object_{index}"
        self.asset = asset
        self.mass = physics.mass(asset)
        self._height = np.array([0.0, 0.0, physics.table_height])
        if parts:
            self.skeleton = _load_parts(asset, name, self.mass)
        else:
            self.skeleton = dart.dynamics.Skeleton(name)
            self.skeleton.createFreeJointAndBodyNodePair()[1].setInertia(
                dart.dynamics.Inertia(self.mass, np.zeros(3), asset.unit_inertia * (self.mass / asset.volume))
            )
        self.body = self.skeleton.getBodyNode(0)
        for number, node in enumerate(self.body.getShapeNodes()):
            node.setName(f"{name}/part_{number}")
            node.getDynamicsAspect().setFrictionCoeff(physics.friction)
        _, self.feet = self.skeleton.createWeldJointAndBodyNodePair(self.body)
        self.feet.setInertia(dart.dynamics.Inertia(1e-9, np.zeros(3), np.eye(3) * 1e-15))
        sphere = dart.dynamics.SphereShape(physics.contact_radius)
        offset = np.eye(4)
        for number, point in enumerate(feet):
            node = self.feet.createShapeNode(sphere, f"{name}/foot_{number}")
            offset[:3, 3] = point
            node.setRelativeTransform(isometry(offset))
            node.createCollisionAspect()
            node.createDynamicsAspect().setFrictionCoeff(physics.friction)

    @property
    def pose(self) -> NDArray[np.float64]:
        """world_from_object, 4×4."""
        pose = np.array(self.body.getWorldTransform().matrix())
        pose[:3, 3] -= self._height
        return pose

    def place(self, world_from_object: NDArray[np.float64]) -> None:
        """Put the object there, at rest."""
        place = isometry(world_from_object, self._height)
        self.skeleton.setPositions(dart.dynamics.FreeJoint.convertToPositions(place))
        self.skeleton.setVelocities(np.zeros(6))
        self.skeleton.setAccelerations(np.zeros(6))

    @property
    def velocity(self) -> tuple[float, float, float, float, float, float]:
        """Linear (m/s) then angular (rad/s) velocity in the world."""
        vx, vy, vz = self.body.getLinearVelocity().tolist()
        wx, wy, wz = self.body.getAngularVelocity().tolist()
        return vx, vy, vz, wx, wy, wz

    @property
    def speed(self) -> tuple[float, float]:
        """Linear (m/s) and angular (rad/s) speed in the world."""
        velocity = self.velocity
        return math.hypot(*velocity[:3]), math.hypot(*velocity[3:])
