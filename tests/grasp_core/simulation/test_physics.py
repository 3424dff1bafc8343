from dataclasses import replace as with_fields

import msgspec
import pytest

from grasp_core.config import convert, shipped
from grasp_core.errors import ConfigError
from grasp_core.simulation.physics import Physics, load_physics


def test_every_shipped_physics_loads():
    for name in shipped("physics"):
        assert load_physics(name).time_step > 0


def test_mass_is_stated_or_clipped(physics, shapes):
    assert physics.mass(shapes.box(0.1, 0.1, 0.01, mass=0.123)) == 0.123
    assert physics.mass(shapes.box(0.05, 0.1, 0.05)) == pytest.approx(0.125)
    assert physics.mass(shapes.box(0.01, 0.01, 0.01)) == physics.mass_min
    assert physics.mass(shapes.box(0.2, 0.2, 0.2)) == physics.mass_max
    light = with_fields(shapes.box(0.2, 0.2, 0.2), mass=0.001)
    assert physics.mass(light) == 0.001


def test_digest_follows_every_value(physics):
    assert load_physics().digest == physics.digest
    assert msgspec.structs.replace(physics, friction=0.61).digest != physics.digest


@pytest.mark.parametrize(
    ("key", "value"), [("friction", 0.0), ("time_step", -0.001), ("mass_min", 2.0), ("contact_points", 3)]
)
def test_impossible_values_are_refused(physics, key, value):
    plain = msgspec.to_builtins(physics) | {key: value}
    with pytest.raises(ConfigError, match=key):
        convert(plain, Physics, "mine.yaml")


def test_unknown_key_is_refused(physics):
    with pytest.raises(ConfigError, match="bounce"):
        convert(msgspec.to_builtins(physics) | {"bounce": 1.0}, Physics, "mine.yaml")
