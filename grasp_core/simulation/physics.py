"""The settings of the simulated physics; `static_configs/physics/default.yaml` gives the reason behind each value."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from grasp_core import config
from grasp_core.objects.asset import ObjectAsset


class Physics(config.Settings):
    """What the world is made of, and the protocol of a trial.

    Attributes:
        time_step: s.
        gravity: m/s².
        friction: Coulomb coefficient of every contact.
        density: of objects whose source states no mass, kg/m³.
        mass_min: lightest such object, kg.
        mass_max: heaviest such object, kg.
        pad_stiffness: of the spring that ties the two pads of a finger, N/m.
        contact_radius: of the spheres that touch the table, m.
        contact_points: at most so many of them an object.
        detector: which of DART's collision detectors.
        table_height: of the table above DART's origin, m.
        start_gap: distance to the first contact at which the simulation of the closing starts, m.
        closing_time: longest closing, s.
        lift_height: m.
        lift_speed: m/s.
        lift_ramp: time to reach that speed, s.
        early_height: height at which a certain verdict may end the lift, m.
        cell: of the height map, m.
    """

    time_step: float
    gravity: float
    friction: float
    density: float
    mass_min: float
    mass_max: float
    pad_stiffness: float
    contact_radius: float
    contact_points: int
    detector: Literal["native", "fcl"]
    table_height: float
    start_gap: float
    closing_time: float
    lift_height: float
    lift_speed: float
    lift_ramp: float
    early_height: float
    cell: float

    def __post_init__(self) -> None:
        for field in self.__struct_fields__:
            value = getattr(self, field)
            if isinstance(value, int | float) and value <= 0:
                raise ValueError(f"{field} must be above 0, not {value}")
        if self.mass_min > self.mass_max:
            raise ValueError(f"mass_min {self.mass_min} is above mass_max {self.mass_max}")
        if self.contact_points < 4:
            raise ValueError(f"contact_points must be at least 4 for an object to stand, not {self.contact_points}")

    def mass(self, asset: ObjectAsset) -> float:
        """The object's mass, kg: what its source states, else density times volume between the bounds."""
        if asset.mass is not None:
            return asset.mass
        return min(max(self.density * asset.volume, self.mass_min), self.mass_max)

    @property
    def digest(self) -> str:
        """A hash of all values: data and weights made with another physics are told apart by it."""
        return config.digest(self)


def load_physics(name: str | Path = "default") -> Physics:
    """Read a physics file or a shipped physics.

    Raises:
        ConfigError: missing file, unknown, missing or ill-typed key, or an impossible value.
    """
    return config.load("physics", name, Physics)
