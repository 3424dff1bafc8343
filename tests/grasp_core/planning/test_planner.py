import pytest

from grasp_core.config import shipped
from grasp_core.errors import ConfigError, MismatchError
from grasp_core.planning.planner import PLANNERS, make_planner, needs_networks


def test_every_planner_is_shipped_and_made_by_name(make_runtime):
    assert set(PLANNERS) == set(shipped("planners")) >= {"cascade", "random", "centroid", "antipodal"}
    for name, (module, class_) in PLANNERS.items():
        planner = make_planner(name, runtime=make_runtime())
        assert (type(planner).__module__, type(planner).__name__) == (module, class_)
        assert planner.gripper.name == "paper"


@pytest.mark.parametrize("name", PLANNERS)
def test_shipped_settings_are_the_defaults_of_the_code(name, make_runtime):
    settings = make_planner(name, runtime=make_runtime()).settings
    defaults = type(settings)()
    for field in settings.__struct_fields__:
        value = getattr(settings, field)
        expected = getattr(defaults, field)
        assert value == (pytest.approx(expected, abs=1e-4) if isinstance(value, float) else expected), field


def test_a_file_of_settings_makes_a_planner(tmp_path, make_runtime):
    path = tmp_path / "mine.yaml"
    path.write_text("planner: cascade\nthreshold: 0.8\nview: {least_height: 2e-2}\n")
    planner = make_planner(path, runtime=make_runtime())
    assert planner.settings.threshold == 0.8 and planner.settings.view.least_height == 0.02


@pytest.mark.parametrize(
    "text, words",
    [
        ("planner: magic\n", "antipodal"),
        ("threshold: 0.5\n", "planner"),
        ("planner: cascade\nthresold: 0.5\n", "thresold"),
        ("- cascade\n", "planner"),
    ],
)
def test_wrong_files_are_refused_with_the_valid_choices(text, words, tmp_path, make_runtime):
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=r"mine\.yaml") as refused:
        make_planner(path, runtime=make_runtime())
    assert words in str(refused.value)


def test_unknown_names_and_other_grippers_are_refused(make_runtime):
    import msgspec

    from grasp_core.gripper import load_gripper

    with pytest.raises(ConfigError, match="antipodal"):
        make_planner("magic")
    other = msgspec.structs.replace(load_gripper(), opening=0.09)
    with pytest.raises(MismatchError):
        make_planner("cascade", gripper=other, runtime=make_runtime())
    assert make_planner("random", gripper=other).gripper.opening == 0.09


def test_settings_are_changed_and_others_stay(make_runtime):
    runtime = make_runtime()
    planner = make_planner("cascade", changes={"threshold": 0.2, "pixels": 7}, runtime=runtime)
    assert (planner.settings.threshold, planner.settings.pixels, planner.settings.angles) == (0.2, 7, 12)
    assert planner.runtime is runtime


def test_changes_that_a_planner_does_not_know_are_left_out():
    planner = make_planner("antipodal", changes={"pixels": 7, "candidates": 3})
    assert planner.settings.candidates == 3


@pytest.mark.parametrize("changes", [{"threshold": 2.0}, {"candidates": 0}, {"angles": "many"}])
def test_impossible_changes_are_refused(make_runtime, changes):
    with pytest.raises(ConfigError, match=next(iter(changes))):
        make_planner("cascade", changes=changes, runtime=make_runtime())


@pytest.mark.parametrize("name", sorted(shipped("planners")))
def test_every_shipped_planner_can_be_varied(make_runtime, name):
    assert make_planner(name, changes={"candidates": 2}, runtime=make_runtime()).settings.candidates == 2
    assert needs_networks(name) == (name in {"cascade", "exhaustive"})
