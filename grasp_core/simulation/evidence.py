"""What a trial says about one attempt: the outcome, and the numbers and words that make it believable."""

from __future__ import annotations

from enum import StrEnum

import msgspec
import numpy as np
from numpy.typing import NDArray

_PATCH = 0.003
"""Metres: contacts spread wider than this along a direction of the finger's face fill it in that direction."""


class Outcome(StrEnum):
    """How an attempt ended."""

    SUCCESS = "SUCCESS"
    COLLISION = "COLLISION"
    MISSED = "MISSED"
    SLIPPED = "SLIPPED"
    UNSTABLE = "UNSTABLE"


class FingerContact(msgspec.Struct, frozen=True):
    """How one finger holds an object.

    Attributes:
        object: index in the scene.
        force: sum of the normal forces, N.
        friction: size of the sum of the tangential forces, N.
        normal: unit vector out of the object's surface, gripper frame, mean weighted by force.
        point: centre of the contacts weighted by force, gripper frame, metres.
        kind: "face", "edge" or "point": how far the contacts spread over the finger.
    """

    object: int
    force: float
    friction: float
    normal: tuple[float, float, float]
    point: tuple[float, float, float]
    kind: str


class Comfort(msgspec.Struct, frozen=True):
    """How far the object moved in the gripper's frame between the pose before closing and the end of the lift.

    Attributes:
        distance: metres.
        rotation: rad.
    """

    distance: float
    rotation: float


class Withstood(msgspec.Struct, frozen=True):
    """What a grasp withstood when the object was shaken after the lift, and where that ended.

    Attributes:
        axis: of the gripper along which it was shaken: "x" (closing axis), "y" or "z" (up).
        direction: unit vector of that axis, world.
        acceleration: the largest that was withstood both ways, m/s²; 0 if none was.
        force: that on the object, N.
        slipped: acceleration at which the object slipped, negative against `direction`; 0 if it was lost before it was
            shaken, None if it withstood the most that was asked for.
    """

    axis: str
    direction: tuple[float, float, float]
    acceleration: float
    force: float
    slipped: float | None


class Evidence(msgspec.Struct, frozen=True, kw_only=True):
    """Why an attempt ended as it did.

    Attributes:
        words: the outcome in one sentence.
        object: index of the object that was grasped, touched or met, None if there was none.
        body: part of the gripper that collided, or None.
        place: where the collision was or where the object was lost, world metres, or None.
        time: of the loss, s of dynamics, or None: those begin where a finger may first meet something, and the way to
            there, which a recording shows, takes its length over the closing speed.
        lift: height reached with the object in the grip, metres.
        travel: way of the left and right finger from the opening w, metres.
        left: how the left finger held the object when it last held, or touched it where the other one did not; or None.
        right: likewise.
        clearance: lowest point of the object above the table at the end, metres, or None.
        withstood: how far the held object was shaken, if it was.
    """

    words: str
    object: int | None = None
    body: str | None = None
    place: tuple[float, float, float] | None = None
    time: float | None = None
    lift: float = 0.0
    travel: tuple[float, float] = (0.0, 0.0)
    left: FingerContact | None = None
    right: FingerContact | None = None
    clearance: float | None = None
    withstood: Withstood | None = None


def triple(values: NDArray[np.float64]) -> tuple[float, float, float]:
    """Three plain floats, rounded to a micrometre or so for reading."""
    a, b, c = (round(float(value), 6) for value in values)
    return a, b, c


def contact_kind(points: NDArray[np.float64]) -> str:
    """How contacts (N, 3) in the gripper frame spread over a finger's face: "face", "edge" or "point"."""
    flat = points[:, 1:] - points[:, 1:].mean(axis=0)
    if len(flat) < 2:
        return "point"
    spread = np.sqrt(np.clip(np.linalg.eigvalsh(flat.T @ flat / len(flat)), 0, None)) * 2
    return ("point", "edge", "face")[int((spread > _PATCH).sum())]


def millimetres(length: float) -> str:
    """A length for people: "0.4 mm", "12 mm", "8.3 cm"."""
    mm = length * 1000
    if abs(mm) >= 30:
        return f"{mm / 10:.1f} cm"
    return f"{mm:.0f} mm" if abs(mm) >= 3 else f"{mm:.1f} mm"


def withstood_words(withstood: Withstood) -> str:
    """What was withstood, e.g. "withstood 14 m/s² (1.0 N) along z both ways, slipped at -16 m/s²"."""
    words = (
        f"withstood {withstood.acceleration:g} m/s² ({withstood.force:.2g} N) along {withstood.axis} both ways"
        if withstood.acceleration
        else f"withstood no shaking along {withstood.axis}"
    )
    if withstood.slipped is None:
        return f"{words}, the most that was asked for"
    end = f", slipped at {withstood.slipped:g} m/s²" if withstood.slipped else ": lost as the lift ended"
    return words + end


def hold_words(left: FingerContact | None, right: FingerContact | None) -> str:
    """Which finger held less than a face, e.g. "the left finger held an edge"; empty if both held faces."""
    kinds = [(name, contact.kind) for name, contact in (("left", left), ("right", right)) if contact]
    weak = [(name, kind) for name, kind in kinds if kind != "face"]
    if not weak:
        return ""
    if len(weak) == 2 and weak[0][1] == weak[1][1]:
        return f"each finger held {'an edge' if weak[0][1] == 'edge' else 'a point'} only"
    return ", ".join(f"the {name} finger held {'an edge' if kind == 'edge' else 'a point'}" for name, kind in weak)
