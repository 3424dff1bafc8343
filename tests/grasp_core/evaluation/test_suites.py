import numpy as np
import pytest
import trimesh

from grasp_core import config
from grasp_core.dataset.recipe import ObjectPlan
from grasp_core.errors import ConfigError, GraspError, MeshError
from grasp_core.evaluation import cache, suites
from grasp_core.evaluation.suites import Suite, object_plans, parse_scale, poses_of
from grasp_core.objects.parametric import FAMILIES, make
from grasp_core.simulation.physics import load_physics


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setattr(cache, "folder", lambda: tmp_path / "cache")


@pytest.mark.parametrize(("text", "scale"), [("keep", "keep"), ("paper", "paper"), ("0.001", 0.001), ("2", 2.0)])
def test_scales(text, scale):
    assert parse_scale(text) == scale


@pytest.mark.parametrize("text", ["big", "0", "-1", "nan", "inf", ""])
def test_what_is_no_scale_is_refused(text):
    with pytest.raises(GraspError, match=r"keep.*paper.*factor"):
        parse_scale(text)


def test_a_folder_is_searched_downwards(tmp_path):
    for name in ("a/one.stl", "a/deep/two.obj", "three.ply"):
        path = tmp_path / "meshes" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        trimesh.creation.box((0.1, 0.05, 0.04)).export(path)
    (tmp_path / "meshes" / "notes.txt").write_text("no mesh")
    plans = object_plans(str(tmp_path / "meshes"), "paper", 0)
    assert sorted(plan.name for plan in plans) == ["a/deep/two", "a/one", "three"]
    assert {plan.scale for plan in plans} == {"paper"}
    asset = next(plan for plan in plans if plan.name == "three").make()
    assert 0.10 <= asset.extents.max() <= 0.20


def test_no_folder_and_no_suite_lists_the_suites():
    with pytest.raises(ConfigError, match=r"'nothing' is no folder and no suite.*catalogue"):
        object_plans("nothing", "keep", 0)


def test_an_empty_folder_is_refused(tmp_path):
    with pytest.raises(ConfigError, match="holds no object"):
        object_plans(str(tmp_path), "keep", 0)


def test_a_suite_file_of_ones_own(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text("about: mine\nobjects: {first: 7, families: {mug: 2}, names: [pen_003]}\n")
    assert sorted(plan.name for plan in object_plans(str(path), "keep", 0)) == ["mug_007", "mug_008", "pen_003"]


def test_folders_in_a_suite_count_from_its_file(tmp_path):
    (tmp_path / "meshes").mkdir()
    trimesh.creation.box((0.1, 0.05, 0.04)).export(tmp_path / "meshes" / "one.stl")
    path = tmp_path / "mine.yaml"
    path.write_text("about: mine\nobjects: {folders: [{path: meshes, scale: keep}]}\n")
    assert [plan.name for plan in object_plans(str(path), "keep", 0)] == ["one"]


def test_a_suite_may_be_a_split_of_a_recipe():
    assert {plan.split for plan in object_plans("smoke", "keep", 0)} == {"test"}


@pytest.mark.parametrize("text", ["about: none\n", "about: both\nrecipe: smoke\nobjects: {names: [mug_001]}\n"])
def test_a_suite_says_its_objects_once(tmp_path, text):
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    with pytest.raises(ConfigError, match="one source"):
        object_plans(str(path), "keep", 0)


@pytest.mark.parametrize("name", list(config.shipped("benchmarks")))
def test_shipped_suites_name_objects_that_exist(name):
    suite = config.load("benchmarks", name, Suite)
    assert suite.about
    try:
        plans = object_plans(name, "keep", 0)
    except MeshError as error:
        pytest.skip(str(error))
    assert len({plan.name for plan in plans}) == len(plans) > 0
    assert all(plan.family in FAMILIES for plan in plans if isinstance(plan, ObjectPlan) and not plan.file)


def test_the_test_suite_has_three_hundred_scenes_and_no_object_that_a_recipe_trains_or_validates_on():
    from grasp_core.dataset.recipe import load_recipe, plan_objects

    suite = config.load("benchmarks", "test", Suite)
    plans = object_plans("test", "keep", 0)
    assert len(plans) * suite.draws >= 240  # most objects have two poses
    for recipe in ("default", "smoke"):
        seen = {plan.name for plan in plan_objects(load_recipe(recipe)) if plan.split != "test"}
        assert not seen & {plan.name for plan in plans}


def test_an_installed_set_is_spread_evenly(monkeypatch):
    from pathlib import Path

    monkeypatch.setattr(suites, "set_files", lambda name: {f"{name}_{k}": Path(f"{k}.stl") for k in range(10)})
    assert [plan.name for plan in object_plans("random", "keep", 0)] == [f"random_urdfs_{k}" for k in range(10)]
    path = config.locate("benchmarks", "random")
    assert config.load("benchmarks", path, Suite).most == 150


def test_a_hard_suite_needs_a_count(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text("about: mine\nhard: {flat: {length: [0.1, 0.2], width: [0.03, 0.09], height: [0.01, 0.02]}}\n")
    with pytest.raises(ConfigError, match="most: says how many"):
        object_plans(str(path), "keep", 0)
    path.write_text("about: mine\nmost: 2\nhard: {flat: {length: [0.1, 0.2]}}\n")
    with pytest.raises(ConfigError, match="flat: needs the ranges of length, width, height"):
        object_plans(str(path), "keep", 0)


def test_the_catalogue_suite_holds_every_family_and_no_object_of_a_recipe():
    from grasp_core.dataset.recipe import load_recipe, plan_objects

    plans = object_plans("catalogue", "keep", 0)
    assert {plan.family for plan in plans} == set(FAMILIES)
    used = {plan.name for recipe in config.shipped("recipes") for plan in plan_objects(load_recipe(recipe))}
    assert not used & {plan.name for plan in plans}


def test_poses_are_found_once_and_come_back_the_same(monkeypatch):
    asset, physics = make("box", 900), load_physics()
    monkeypatch.setattr(suites, "_DROPS", 6)
    first = poses_of(asset, physics)
    assert first and all(pose.pose.shape == (4, 4) and 0 < pose.probability <= 1 for pose in first)
    monkeypatch.setattr(suites, "stable_poses", None)  # a second search would fail
    again = poses_of(asset, physics)
    assert [np.array_equal(a.pose, b.pose) for a, b in zip(first, again, strict=True)] == [True] * len(first)
