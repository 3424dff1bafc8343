"""Who touches whom: contacts between fingers and objects, and what they say about a finger's hold."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from grasp_core.simulation.evidence import FingerContact, contact_kind, triple
from grasp_core.simulation.gripper_model import FINGERS


@dataclass(frozen=True)
class Touch:
    """One contact between a finger and an object: world frame, metres and N; the force acts on the object."""

    finger: int
    object: int
    point: NDArray[np.float64]
    normal: NDArray[np.float64]
    force: NDArray[np.float64]


class ContactReader:
    """Reads DART's contacts; knows every shape that belongs to a finger or an object.

    DART hands out the same Python object for a shape for as long as one is kept, so shapes are told apart by identity;
    asking each for its name takes ten times as long.
    """

    def __init__(self, shapes: Iterable[Any], height: float) -> None:
        """Keep the shape nodes of a world; their names begin with "left_finger/", "right_finger/" or "object_N/".

        Args:
            shapes: all of them.
            height: of z = 0 above DART's origin, metres.
        """
        self._height = np.array([0.0, 0.0, height])
        self._fingers: dict[Any, int] = {}
        self._objects: dict[Any, int] = {}
        for shape in shapes:
            owner = shape.getName().split("/")[0]
            if owner in FINGERS:
                self._fingers[shape] = FINGERS.index(owner)
            elif owner.startswith("object_"):
                self._objects[shape] = int(owner.removeprefix("object_"))

    def touches(self, contacts: Iterable[Any]) -> list[Touch]:
        """Contacts between fingers and objects that press; normals point out of the object.

        Where the native detector finds no depth, it reports a contact at DART's origin: none of a finger's.
        """
        found = []
        for contact in contacts:
            point = contact.point
            if not contact.force.any() or not point.any():
                continue
            first = contact.collisionObject1.getShapeFrame()
            second = contact.collisionObject2.getShapeFrame()
            # DART's normal and force point from the second body to the first.
            if second in self._fingers and first in self._objects:
                finger, item, sign = self._fingers[second], self._objects[first], 1.0
            elif first in self._fingers and second in self._objects:
                finger, item, sign = self._fingers[first], self._objects[second], -1.0
            else:
                continue
            found.append(Touch(finger, item, point - self._height, -sign * contact.normal, sign * contact.force))
        return found


def strain(found: Sequence[Touch], friction: float) -> float:
    """Share of its friction that the more strained finger uses: tangential over μ times normal force, 1 at most."""
    worst = 0.0
    for finger in (0, 1):
        forces = np.array([touch.force for touch in found if touch.finger == finger]).reshape(-1, 3)
        normals = np.array([touch.normal for touch in found if touch.finger == finger]).reshape(-1, 3)
        pressure = -(forces * normals).sum(axis=1)
        sliding = forces.sum(axis=0) + pressure @ normals
        worst = max(worst, float(np.linalg.norm(sliding)) / max(friction * float(pressure.sum()), 1e-6))
    return worst


def contact_kinds(found: Sequence[Touch], world_from_gripper: NDArray[np.float64]) -> list[str]:
    """How the contacts of each finger that has some spread over its face: "face", "edge" or "point"."""
    kinds = []
    for finger in (0, 1):
        points = [touch.point for touch in found if touch.finger == finger]
        if points:
            kinds.append(contact_kind(np.array(points) @ world_from_gripper[:3, :3]))
    return kinds


def finger_contacts(
    found: list[Touch], world_from_gripper: NDArray[np.float64]
) -> tuple[FingerContact | None, FingerContact | None]:
    """Sum up contacts per finger (left, right); the object with the larger force counts, None where there is none."""
    rotation, origin = world_from_gripper[:3, :3], world_from_gripper[:3, 3]
    result: list[FingerContact | None] = []
    for finger in (0, 1):
        mine = [touch for touch in found if touch.finger == finger]
        if not mine:
            result.append(None)
            continue
        pressure: dict[int, float] = {}
        for touch in mine:
            pressure[touch.object] = pressure.get(touch.object, 0.0) - float(touch.force @ touch.normal)
        item = max(pressure, key=lambda index: pressure[index])
        mine = [touch for touch in mine if touch.object == item]
        normals = np.array([touch.normal for touch in mine])
        forces = np.array([touch.force for touch in mine])
        points = (np.array([touch.point for touch in mine]) - origin) @ rotation
        strength = -(forces * normals).sum(axis=1)
        weights = np.clip(strength, 1e-9, None)
        weights /= weights.sum()
        normal = weights @ normals
        normal /= max(float(np.linalg.norm(normal)), 1e-9)
        sliding = forces.sum(axis=0) + (strength[:, None] * normals).sum(axis=0)
        result.append(
            FingerContact(
                item,
                round(float(strength.sum()), 4),
                round(float(np.linalg.norm(sliding)), 4),
                triple(normal @ rotation),
                triple(weights @ points),
                contact_kind(points),
            )
        )
    return result[0], result[1]
