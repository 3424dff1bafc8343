"""The DART world of a scene: table, objects and, for trials, the gripper."""

from __future__ import annotations

from collections.abc import Sequence

import dartpy as dart
import numpy as np
from numpy.typing import NDArray

from grasp_core.gripper import Gripper
from grasp_core.objects.asset import ObjectAsset
from grasp_core.simulation.contacts import ContactReader, Touch
from grasp_core.simulation.gripper_model import GripperModel, isometry
from grasp_core.simulation.object_body import ObjectBody, support_points
from grasp_core.simulation.physics import Physics, load_physics

__all__ = ["Physics", "World", "load_physics"]

_TABLE = 1.0
"""Metres: half the side of the table, and its thickness."""
_Z = 5
"""Which position of a free joint is its height."""
_MANY = 400
"""Feet of an object whose pose is not known beforehand."""


class World:
    """Table, objects and, if one is given, a gripper, ready to be stepped.

    The table's top lies one sphere radius below z = 0, so that an object's own vertices rest at z = 0. Poses and
    contact points are given and told in this frame; in DART it lies `Physics.table_height` above the origin.

    Attributes:
        world: DART's world.
        objects: bodies in the order of the assets.
        gripper: the gripper or None.
    """

    def __init__(
        self,
        assets: Sequence[ObjectAsset],
        physics: Physics,
        gripper: Gripper | None = None,
        *,
        poses: Sequence[NDArray[np.float64]] | None = None,
        parts: bool = True,
    ) -> None:
        """Build the world.

        Args:
            assets: of the objects.
            physics: what the world is made of.
            gripper: none for a world that only settles.
            poses: where the objects rest (4×4 each); without them every vertex of a hull can touch the table.
            parts: whether objects meet fingers and each other; on the table alone they need not.
        """
        self.physics = physics
        self.world = dart.simulation.World()
        self.world.setTimeStep(physics.time_step)
        self.world.setGravity([0.0, 0.0, -physics.gravity])
        # DART sends bodies slower than 1 cm/s to sleep after 0.5 s: a slow slip would stop there.
        awake = self.world.getDeactivationOptions()
        awake.mEnabled = False
        self.world.setDeactivationOptions(awake)
        detectors = {"native": dart.collision.DARTCollisionDetector, "fcl": dart.collision.FCLCollisionDetector}
        self.world.getConstraintSolver().setCollisionDetector(detectors[physics.detector]())
        table = self._table()
        self.objects: list[ObjectBody] = []
        for index, asset in enumerate(assets):
            pose, most = (None, _MANY) if poses is None else (poses[index], physics.contact_points)
            self.objects.append(ObjectBody(asset, index, physics, support_points(asset, most, pose), parts=parts))
        for item in self.objects:
            self.world.addSkeleton(item.skeleton)
        self._pushes: dict[int, NDArray[np.float64]] = {}
        self.gripper = None
        if gripper is not None:
            self.gripper = GripperModel(gripper, physics)
            self.world.addSkeleton(self.gripper.skeleton)
        self._separate(table)
        skeletons = [self.world.getSkeleton(index) for index in range(self.world.getNumSkeletons())]
        bodies = [body for skeleton in skeletons for body in skeleton.getBodyNodes()]
        detector = self.world.getConstraintSolver().getCollisionDetector()
        self._shapes = self.world.getConstraintSolver().getCollisionGroup()
        # All that touch come apart when these move apart: the table, all objects but one, the gripper.
        self._heights = [(table.getSkeleton(), 0), *((item.skeleton, _Z) for item in self.objects[1:])]
        if self.gripper is not None:
            self._heights.append((self.gripper.skeleton, 0))
        self._no_shapes = detector.createCollisionGroup()
        self._no_contacts = dart.collision.CollisionOption(False)
        self._contacts = ContactReader(
            (shape for body in bodies for shape in body.getShapeNodes()), physics.table_height
        )

    def _table(self) -> dart.dynamics.BodyNode:
        skeleton = dart.dynamics.Skeleton("table")
        joint, body = skeleton.createPrismaticJointAndBodyNodePair()  # it moves for `_forget` alone
        joint.setAxis([0.0, 0.0, 1.0])
        place = np.eye(4)
        place[2, 3] = self.physics.table_height - _TABLE / 2 - self.physics.contact_radius
        joint.setTransformFromParentBodyNode(isometry(place))
        node = body.createShapeNode(dart.dynamics.BoxShape([2 * _TABLE, 2 * _TABLE, _TABLE]), "table")
        node.createCollisionAspect()
        node.createDynamicsAspect().setFrictionCoeff(self.physics.friction)
        skeleton.setMobile(False)
        self.world.addSkeleton(skeleton)
        return body

    def _separate(self, table: dart.dynamics.BodyNode) -> None:
        """Leave out the pairs that must not touch: parts and table, feet and gripper, feet and feet.

        Feet do meet the parts of other objects: parts alone would let stacked objects sink through each other.
        """
        pairs = self.world.getConstraintSolver().getCollisionOption().collisionFilter
        grip = self.gripper.bodies if self.gripper else []
        for body in grip:
            pairs.addBodyNodePairToBlackList(table, body)
        for item in self.objects:
            pairs.addBodyNodePairToBlackList(table, item.body)
            for body in grip:
                pairs.addBodyNodePairToBlackList(item.feet, body)
            for other in self.objects:
                if other is not item:
                    pairs.addBodyNodePairToBlackList(item.feet, other.feet)

    def rewind(self, poses: Sequence[NDArray[np.float64]]) -> None:
        """Start afresh with the objects at rest at these poses (4×4), whatever happened before."""
        solver = self.world.getConstraintSolver()
        self.world.reset()
        self._pushes.clear()
        if self.gripper is not None:
            self.gripper.park()
        for item, pose in zip(self.objects, poses, strict=True):
            item.place(pose)
        # The constraint solver knows last step's contacts, too; those of a step of another length it drops.
        self._forget()
        solver.setTimeStep(self.physics.time_step / 2)
        solver.solve()
        solver.setTimeStep(self.physics.time_step)
        solver.clearLastCollisionResult()

    def step(self) -> None:
        """Advance by one time step, the gripper left alone."""
        self._forget()
        self.world.step()

    def _forget(self) -> None:
        """Make the native detector forget the contacts that it knows and the impulses that they carried.

        It keeps four contacts a pair of shapes and tells them apart by their places in the frame of the shape that
        lies lower in memory; from their impulses DART's second solver starts where Dantzig's method stops short. So
        the last bits, rarely a verdict, would hang on addresses. Contacts of shapes that moved apart are dropped.
        """
        known = [skeleton.getPosition(index) for skeleton, index in self._heights]
        for apart, ((skeleton, index), height) in enumerate(zip(self._heights, known, strict=True), 1):
            skeleton.setPosition(index, height + apart)
        self._shapes.collide(self._no_shapes, self._no_contacts)
        for (skeleton, index), height in zip(self._heights, known, strict=True):
            skeleton.setPosition(index, height)

    def advance(self, steps: int, speed: float = 0.0, acceleration: float = 0.0) -> None:
        """Close with full force for some steps while the base rises: at `speed` before the first, then accelerating."""
        command, forget, step = self._gripper.command, self._forget, self.world.step
        gain = acceleration * self.physics.time_step
        for _ in range(steps):
            speed += gain
            command(speed)
            for index, force in self._pushes.items():  # DART forgets them after a step
                self.objects[index].body.addExtForce(force)
            forget()
            step()

    def push(self, index: int, force: NDArray[np.float64]) -> None:
        """Push an object with a force (3,) at its centre of mass, world, N, from now on; a rewind ends it."""
        self._pushes[index] = np.asarray(force, float)

    def grip(self, world_from_gripper: NDArray[np.float64], travel: tuple[float, float]) -> None:
        """Put the gripper at a pose (4×4, z up), each finger at its travel from fully open, metres, and closing."""
        self._gripper.place(world_from_gripper, travel, self.spec.speed)

    @property
    def _gripper(self) -> GripperModel:
        assert self.gripper is not None, "this world was made without a gripper"
        return self.gripper

    @property
    def spec(self) -> Gripper:
        """The gripper's description."""
        return self._gripper.spec

    @property
    def lift(self) -> float:
        """How far the gripper's base has risen, metres."""
        return self._gripper.lift

    @property
    def rising(self) -> float:
        """How fast it rises, m/s."""
        return self._gripper.rising

    @property
    def travel(self) -> tuple[float, float]:
        """How far each finger has closed from fully open (left, right), metres."""
        return self._gripper.travel

    def touched(self) -> tuple[bool, bool]:
        """Whether the left and the right finger touch an object: nothing else can touch them."""
        found = self.world.getLastCollisionResult()
        a, b, c, d = map(found.inCollision, self._gripper.pads)
        return a or b, c or d

    def touches(self) -> list[Touch]:
        """Every contact of the last step between a finger and an object."""
        return self._contacts.touches(self.world.getLastCollisionResult().getContacts())

    @property
    def time(self) -> float:
        """Seconds since the last rewind."""
        return float(self.world.getTime())

    @property
    def diverged(self) -> bool:
        """Whether the solver lost it: not a number, or an object faster than anything that 20 N can do."""
        for item in self.objects:
            linear, angular = item.speed
            if not (linear < 20.0 and angular < 500.0):
                return True
        return False
