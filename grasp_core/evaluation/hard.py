"""Objects that are hard to grasp, each kind drawn from ranges of geometry that stand in a suite file.

The ranges were fixed before any planner ran on such an object. Every kind has a reason of its own: rims of which
one wall alone can be grasped, bodies barely higher than where fingers end, little that fits between the fingers, widths
about the opening, and weight far from where there is room to grip.
"""

from __future__ import annotations

from collections.abc import Callable

import msgspec
import numpy as np
import trimesh

from grasp_core.objects.asset import ObjectAsset
from grasp_core.objects.decomposition import build_asset
from grasp_core.objects.hulls import arrays
from grasp_core.objects.parametric.shells import shell
from grasp_core.objects.parametric.solids import Section, Solid, box, cylinder

Range = tuple[float, float]
"""Least and greatest value; lengths in metres."""


def _thin_rim(diameter: float, wall: float, height: float, taper: float) -> Solid:
    """An open vessel too wide to be held across."""
    radius = diameter / 2
    skin = [Section(0.0, radius * taper), Section(height, radius)]
    return shell(skin, wall, max(wall, 0.3))


def _flat(length: float, width: float, height: float) -> Solid:
    """A slab that the fingers reach by a few millimetres."""
    return box(length, width, height)


def _little_grip(base: float, base_height: float, knob: float, knob_height: float, off: float) -> Solid:
    """A knob on a base that is too wide to be held."""
    foot = box(base, base, base_height, 0.2).at(z=base_height / 2)
    reach = (base - knob) / 2 * off
    return foot + cylinder(knob / 2, knob_height + 0.2).at(x=reach, z=base_height - 0.2)


def _near_opening(width: float, length: float, height: float, rounding: float) -> Solid:
    """A block whose width is about the gripper's opening."""
    return box(width, length, height, rounding)


def _heavy_end(length: float, thickness: float, head: float, head_length: float, density: float) -> Solid:
    """A rod whose head is heavy and too wide to be held."""
    rod = cylinder(thickness / 2, length).turned("y", 90).at(z=head / 2)
    weight = box(head_length, head, head, 0.2).at(x=length, z=head / 2).dense(density)
    return rod + weight


KINDS: dict[str, tuple[Callable[..., Solid], tuple[str, ...]]] = {
    "thin_rim": (_thin_rim, ("diameter", "wall", "height", "taper")),
    "flat": (_flat, ("length", "width", "height")),
    "little_grip": (_little_grip, ("base", "base_height", "knob", "knob_height", "off")),
    "near_opening": (_near_opening, ("width", "length", "height", "rounding")),
    "heavy_end": (_heavy_end, ("length", "thickness", "head", "head_length", "density")),
}
"""Kind → what builds it, and the names of its numbers; all are lengths but `taper`, `off` and `density`."""

_RATIOS = {"taper", "off", "density"}


class HardPlan(msgspec.Struct, frozen=True):
    """One object of a kind, not made yet.

    Attributes:
        name: unique in its suite, such as "thin_rim_03".
        kind: see `KINDS`.
        ranges: of each number of the kind.
        seed: of what is drawn.
    """

    name: str
    kind: str
    ranges: dict[str, Range]
    seed: int

    def make(self) -> ObjectAsset:
        """Draw the numbers and build the object."""
        build, names = KINDS[self.kind]
        rng = np.random.default_rng([self.seed, list(KINDS).index(self.kind)])
        numbers = {name: float(rng.uniform(*self.ranges[name])) for name in names}
        shape = build(**{name: value if name in _RATIOS else 100 * value for name, value in numbers.items()})
        vertices, faces = arrays(shape.body)
        words = ", ".join(f"{name} {value:.4g}" for name, value in numbers.items())
        return build_asset(
            self.name,
            self.kind,
            trimesh.Trimesh(vertices * 0.01, faces, process=False),
            parts=[part * 0.01 for part in shape.parts],
            densities=shape.densities,
            source=f"{self.kind}: {words}",
        )


def hard_plans(kinds: dict[str, dict[str, Range]], count: int) -> list[HardPlan]:
    """`count` objects of each kind.

    Raises:
        ValueError: an unknown kind, a number that it lacks or does not have, or a range that is none.
    """
    for kind, ranges in kinds.items():
        if kind not in KINDS:
            raise ValueError(f"no kind is called '{kind}'; choose from: {', '.join(KINDS)}")
        if set(ranges) != set(KINDS[kind][1]):
            raise ValueError(f"{kind}: needs the ranges of {', '.join(KINDS[kind][1])}, not of {', '.join(ranges)}")
        for name, (low, high) in ranges.items():
            if not 0 < low <= high:
                raise ValueError(f"{kind}: {name}: a range is a least and a greatest value above 0, not {low}, {high}")
    return [
        HardPlan(f"{kind}_{seed:02d}", kind, ranges, seed) for kind, ranges in kinds.items() for seed in range(count)
    ]
