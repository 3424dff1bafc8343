"""The gripper in DART: a base that is driven, its rod, and two fingers of two compliant pads each.

The base moves along z as told (a velocity-driven joint); x, y and φ are set once per attempt. Each finger is split
across its width into two pads on prismatic joints of their own, each pushed with half the force and tied to its twin by
a spring: a single box against a mesh resists no torsion about the closing axis.
"""

from __future__ import annotations

import dartpy as dart
import numpy as np
from numpy.typing import NDArray

from grasp_core.gripper import Gripper
from grasp_core.simulation.physics import Physics

_PARKED = 5.0
"""Metres above the table, where the gripper waits between attempts."""

FINGERS = ("left_finger", "right_finger")


def isometry(transform: NDArray[np.float64], shift: NDArray[np.float64] | float = 0.0) -> dart.math.Isometry3:
    """DART's form of a 4×4 transform, shifted by (3,) metres."""
    result = dart.math.Isometry3()
    result.set_rotation(np.ascontiguousarray(transform[:3, :3]))
    result.set_translation(transform[:3, 3] + shift)
    return result


class GripperModel:
    """A gripper built from the boxes of its `Gripper`.

    The joint value of a pad is its finger's travel: 0 fully open, half the opening at the centre plane, where it stops.

    Attributes:
        spec: the gripper it was built from.
        skeleton: DART's skeleton; its first degree of freedom is the lift, then two pads left, two pads right.
        base: body with rod and base block.
        pads: the four pads' bodies.
    """

    def __init__(self, spec: Gripper, physics: Physics) -> None:
        self.spec = spec
        self._stiffness = physics.pad_stiffness
        self._height = np.array([0.0, 0.0, physics.table_height])
        self._push = spec.force / 2
        # A force F against a drag of F / speed gives the finger its speed limit without ever weakening its grip. The
        # drag is part of the command: as a damping coefficient DART would treat it implicitly and scale the grip
        # force by m / (m + c dt) (20 N commanded, 6.8 N felt).
        self._drag = spec.force / spec.speed / 2
        self.skeleton = dart.dynamics.Skeleton("gripper")
        self._joint, self.base = self.skeleton.createPrismaticJointAndBodyNodePair()
        self._joint.setAxis([0.0, 0.0, 1.0])
        self._joint.setActuatorType(dart.dynamics.VELOCITY)
        boxes = spec.boxes()
        for name in ("rod", "base"):
            box, centre = boxes[name]
            self._shape(self.base, name, box.size, centre, physics.friction)
        self.pads: list[dart.dynamics.BodyNode] = []
        for name in FINGERS:
            box, centre = boxes[name]
            inward = -np.sign(centre[0])
            size = np.array([box.x, box.y / 2, box.z])
            moment = spec.finger_mass / 2 / 12 * np.diag((size**2).sum() - size**2)
            for half in (-1, 1):
                joint, body = self.skeleton.createPrismaticJointAndBodyNodePair(self.base)
                joint.setAxis([inward, 0.0, 0.0])
                place = np.eye(4)
                place[:3, 3] = centre
                place[1, 3] += half * box.y / 4
                joint.setTransformFromParentBodyNode(isometry(place))
                joint.setPositionLowerLimit(0, 0.0)
                joint.setPositionUpperLimit(0, spec.opening / 2)
                joint.setLimitEnforcement(True)
                body.setInertia(dart.dynamics.Inertia(spec.finger_mass / 2, np.zeros(3), moment))
                self._shape(body, f"{name}/{'front' if half < 0 else 'back'}", size, np.zeros(3), physics.friction)
                self.pads.append(body)

    @staticmethod
    def _shape(
        body: dart.dynamics.BodyNode, name: str, size: object, centre: NDArray[np.float64], friction: float
    ) -> None:
        node = body.createShapeNode(dart.dynamics.BoxShape(np.asarray(size, float)), name)
        offset = np.eye(4)
        offset[:3, 3] = centre
        node.setRelativeTransform(isometry(offset))
        node.createCollisionAspect()
        node.createDynamicsAspect().setFrictionCoeff(friction)

    @property
    def bodies(self) -> list[dart.dynamics.BodyNode]:
        """Base and pads."""
        return [self.base, *self.pads]

    def park(self) -> None:
        """Wait far above the table, open and at rest."""
        place = np.eye(4)
        place[2, 3] = _PARKED
        self.place(place, (0.0, 0.0))

    def place(self, world_from_gripper: NDArray[np.float64], travel: tuple[float, float], speed: float = 0.0) -> None:
        """Stand at a pose (4×4, z up), not lifted.

        Args:
            world_from_gripper: the pose.
            travel: of the left and the right finger, metres.
            speed: at which both fingers close, m/s.
        """
        self._joint.setTransformFromParentBodyNode(isometry(world_from_gripper, self._height))
        left, right = travel
        self.skeleton.setPositions(np.array([0.0, left, left, right, right]))
        self.skeleton.setVelocities(np.array([0.0, speed, speed, speed, speed]))
        self.skeleton.setAccelerations(np.zeros(5))
        self.skeleton.resetGeneralizedForces()

    def command(self, lift_speed: float) -> None:
        """Command the next step: close with full force while the base rises at `lift_speed`, m/s."""
        _, a, b, c, d = self.skeleton.getPositions().tolist()
        _, va, vb, vc, vd = self.skeleton.getVelocities().tolist()
        left = self._stiffness * (a - b)
        right = self._stiffness * (c - d)
        push, drag = self._push, self._drag
        self.skeleton.setCommands(
            [
                lift_speed,
                push - drag * va - left,
                push - drag * vb + left,
                push - drag * vc - right,
                push - drag * vd + right,
            ]
        )

    @property
    def lift(self) -> float:
        """How far the base has risen, m."""
        return float(self.skeleton.getPosition(0))

    @property
    def rising(self) -> float:
        """Speed of the base along z, m/s."""
        return float(self.skeleton.getVelocity(0))

    @property
    def travel(self) -> tuple[float, float]:
        """How far each finger has closed from fully open (left, right), m."""
        _, a, b, c, d = self.skeleton.getPositions().tolist()
        return (a + b) / 2, (c + d) / 2
