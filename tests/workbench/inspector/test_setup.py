import msgspec
import pytest

from grasp_core import config
from grasp_core.sensing.noise import load_noise
from grasp_core.simulation.trial import GraspNoise
from workbench.inspector.setup import DEFAULT, FIELDS, PLANNING, Choice, Setup, changed, decoded, differences


def test_every_setting_has_a_label_a_hint_and_a_range():
    assert set(FIELDS) == set(Setup.__struct_fields__)
    for field in FIELDS.values():
        assert field.label and field.hint and field.group
        if not isinstance(field, Choice):
            assert field.low < field.high and field.step > 0


def test_the_defaults_are_the_shipped_ones():
    shipped = config.read_yaml(config.locate("planners", "cascade"))
    assert {name: getattr(DEFAULT, name) for name in PLANNING} == {name: shipped[name] for name in PLANNING}
    noise = load_noise("paper")
    assert (DEFAULT.sigma_u, DEFAULT.sigma_v, DEFAULT.sigma_d) == (noise.sigma_u, noise.sigma_v, noise.sigma_d)
    assert DEFAULT.sigma_p == GraspNoise().sigma_p
    assert DEFAULT.sigma_phi == pytest.approx(2.5)


@pytest.mark.parametrize(
    ("name", "value"),
    [("planner", "wishful"), ("planner", ""), ("pixels", 0), ("threshold", 1.5), ("tilt", float("nan")),
     ("sigma_p", -1), ("attempts", 10**9), ("gripper", "../../etc"), ("angles", "many"), ("nothing", 1)],
)  # fmt: skip
def test_impossible_values_are_refused(name, value):
    with pytest.raises(ValueError):
        changed(DEFAULT, name, value)


def test_texts_of_links_become_numbers():
    made = decoded({"threshold": "0.25", "pixels": "12", "beside": "random"})
    assert (made.threshold, made.pixels, made.planners) == (0.25, 12, ("cascade", "random"))
    assert differences(made) == {"beside": "random", "pixels": 12, "threshold": 0.25}
    assert differences(DEFAULT) == {} and decoded(differences(made)) == made


def test_settings_are_values():
    assert hash(Setup()) == hash(DEFAULT)
    assert msgspec.structs.replace(DEFAULT, seed=1).sees != DEFAULT.sees
    assert msgspec.structs.replace(DEFAULT, sigma_p=0.0).tries != DEFAULT.tries
