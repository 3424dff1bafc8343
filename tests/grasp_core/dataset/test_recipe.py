import itertools

import msgspec
import pytest
import trimesh

from grasp_core import config
from grasp_core.dataset.generate import generate
from grasp_core.dataset.recipe import (
    Folder,
    Objects,
    Recipe,
    check_sets,
    load_recipe,
    name_seed,
    plan_objects,
    with_modelnet,
)
from grasp_core.dataset.rows import SPLITS
from grasp_core.errors import ConfigError
from grasp_core.objects import sets
from grasp_core.objects.sets import set_of
from grasp_core.objects.similarity import near_duplicates


@pytest.mark.parametrize("name", sorted(config.shipped("recipes")))
def test_shipped_recipes_can_be_followed(name):
    recipe = load_recipe(name)
    plans = plan_objects(recipe)
    assert recipe.name == name
    assert {plan.split for plan in plans} == set(SPLITS)
    assert len({plan.name for plan in plans}) == len(plans)


def test_paper_has_the_papers_numbers():
    recipe = load_recipe("paper")
    assert (recipe.grid, recipe.angles, recipe.attempts) == (11, 6, 5)
    splits = [plan.split for plan in plan_objects(recipe)]
    assert (splits.count("train"), splits.count("test")) == (100, 20)


def test_default_has_objects_enough_from_catalogue_and_sets():
    plans = plan_objects(load_recipe("default"))
    for split, least in (("train", 200), ("validation", 20), ("test", 20)):
        own = [plan for plan in plans if plan.split == split]
        assert len(own) >= least
        assert {"rgb", "random_urdfs"} < {plan.family for plan in own}


def close_pairs(plans):
    """Pairs of objects of different splits that are near-duplicates."""
    assets = {split: [plan.make() for plan in plans if plan.split == split] for split in SPLITS}
    return [pair for a, b in itertools.combinations(SPLITS, 2) for pair in near_duplicates(assets[a], assets[b])]


def test_default_has_no_near_duplicates_among_the_families_that_splits_share():
    plans = plan_objects(catalogue_of("default"))
    held = {plan.family for plan in plans if plan.split != "train"}
    shared = [plan for plan in plans if plan.family in held]
    assert len({plan.family for plan in shared if plan.split == "train"}) >= 15
    assert close_pairs(shared) == []


@pytest.mark.slow
def test_default_has_no_near_duplicates_across_splits():
    recipe = load_recipe("default")
    plans = plan_objects(recipe)
    try:
        check_sets(recipe, plans)
    except ConfigError as error:
        pytest.skip(str(error))
    assert close_pairs(plans) == []


def catalogue_of(name):
    """A shipped recipe without the objects of installable sets."""
    recipe = load_recipe(name)
    splits = {}
    for split in SPLITS:
        own = recipe.objects(split)
        splits[split] = msgspec.structs.replace(own, names=tuple(one for one in own.names if set_of(one) is None))
    return msgspec.structs.replace(recipe, **splits)


def test_objects_of_sets_are_named_and_made(monkeypatch, tmp_path):
    plans = plan_objects(recipe_of_a_set(monkeypatch, tmp_path, "rgb_block"))
    assert [(plan.name, plan.split, plan.family) for plan in plans] == [("rgb_block", "train", "rgb")]
    assert plans[0].make().extents.max() == pytest.approx(0.06)


def test_sets_without_the_object_or_not_installed_are_named_before_any_work(monkeypatch, tmp_path):
    recipe = recipe_of_a_set(monkeypatch, tmp_path, "rgb_none")
    with pytest.raises(ConfigError, match="recipe 't': the set 'rgb' has no object 'rgb_none'"):
        generate(recipe, tmp_path / "out")
    monkeypatch.setitem(sets.SETS, "rgb", ("no_such_package", "", "*.stl"))
    with pytest.raises(ConfigError, match=r"recipe 't': the set 'rgb' is not installed; run: pip install"):
        generate(recipe, tmp_path / "out")


def recipe_of_a_set(monkeypatch, tmp_path, name):
    """A recipe of one object of a set that is installed with one mesh, a block."""
    (tmp_path / "made_set" / "train").mkdir(parents=True)
    (tmp_path / "made_set" / "__init__.py").touch()
    trimesh.creation.box((0.05, 0.04, 0.06)).export(tmp_path / "made_set" / "train" / "block.stl")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setitem(sets.SETS, "rgb", ("made_set", "", "*/*.stl"))
    return Recipe(name="t", train=Objects(names=(name,)))


def test_families_and_names(tmp_path):
    recipe = Recipe(
        name="t",
        train=Objects(families={"box": 2, "can": 1}, first=3),
        test=Objects(names=("mug_007",)),
    )
    plans = plan_objects(recipe)
    assert [(plan.name, plan.split, plan.seed) for plan in plans] == [
        ("box_003", "train", 3),
        ("box_004", "train", 4),
        ("can_003", "train", 3),
        ("mug_007", "test", 7),
    ]


def test_an_object_stands_in_one_split():
    recipe = Recipe(name="t", train=Objects(families={"box": 2}), test=Objects(names=("box_001",)))
    with pytest.raises(ConfigError, match="box_001' stands in train and in test"):
        plan_objects(recipe)


@pytest.mark.parametrize(
    ("objects", "message"),
    [
        (Objects(families={"boxx": 1}), "no family is called 'boxx'; choose from: .*box"),
        (Objects(names=("box",)), "'box' is no object of the catalogue .* or of a set"),
        (Objects(folders=(Folder(path="/not/there"),)), "/not/there: no such folder"),
        (Objects(), "names no objects"),
    ],
)
def test_mistakes_are_named(objects, message):
    with pytest.raises(ConfigError, match=message):
        plan_objects(Recipe(name="t", train=objects))


def test_folders_count_from_the_recipe_file(tmp_path):
    (tmp_path / "meshes" / "deep").mkdir(parents=True)
    for path in ("a.stl", "deep/b.STL"):
        trimesh.creation.box((0.05, 0.04, 0.06)).export(tmp_path / "meshes" / path, file_type="stl")
    (tmp_path / "meshes" / "read.txt").write_text("no mesh")
    file = tmp_path / "own.yaml"
    file.write_text("name: own\ntrain:\n  folders:\n    - {path: meshes, scale: paper}\n")
    plans = plan_objects(load_recipe(file))
    assert [plan.name for plan in plans] == ["a", "deep/b"]
    assert plans[0].seed != plans[1].seed
    asset = plans[1].make()
    assert asset.name == "deep/b"
    assert 0.10 <= asset.extents.max() <= 0.20
    file.write_text("name: own\ntrain:\n  folders:\n    - {path: meshes, most: 1}\n")
    assert [plan.name for plan in plan_objects(load_recipe(file))] == ["a"]


def test_modelnet_takes_the_place_of_the_objects_and_keeps_its_split(tmp_path):
    for label in ("chair", "flower_pot"):
        for split in ("train", "test"):
            (tmp_path / label / split).mkdir(parents=True)
            for number in range(3):
                trimesh.creation.box((30, 20, 10)).export(
                    tmp_path / label / split / f"{label}_{split}_{number:04d}.off"
                )
    own = Objects(families={"box": 3})
    recipe = Recipe(name="t", train=own, validation=Objects(names=("box_008",)), test=Objects(names=("box_009",)))
    plans = plan_objects(with_modelnet(recipe, tmp_path))
    assert [(plan.name, plan.split) for plan in plans] == [
        ("chair_train_0000", "train"),
        ("flower_pot_train_0000", "train"),
        ("chair_train_0001", "train"),
        ("flower_pot_train_0001", "validation"),
        ("chair_test_0000", "test"),
    ]
    asset = plans[3].make()
    assert asset.category == "flower_pot_train" and 0.1 <= asset.extents.max() <= 0.2
    with pytest.raises(ConfigError, match="is no ModelNet folder"):
        plan_objects(with_modelnet(recipe, tmp_path / "chair" / "train"))


def test_meshes_that_a_urdf_names_are_no_objects_of_their_own(tmp_path):
    for name in ("piece.stl", "other.stl"):
        trimesh.creation.box((0.05, 0.04, 0.06)).export(tmp_path / name)
    shape = '<geometry><mesh filename="piece.stl"/></geometry>'
    (tmp_path / "cup.urdf").write_text(
        f'<robot name="cup"><link name="l"><collision>{shape}</collision></link></robot>'
    )
    plans = plan_objects(Recipe(name="t", train=Objects(folders=(Folder(path=str(tmp_path)),))))
    assert [plan.name for plan in plans] == ["cup", "other"]


def test_empty_folder_is_named(tmp_path):
    with pytest.raises(ConfigError, match="holds no object"):
        plan_objects(Recipe(name="t", train=Objects(folders=(Folder(path=str(tmp_path)),))))


def test_impossible_numbers_are_refused(tmp_path):
    file = tmp_path / "bad.yaml"
    file.write_text("name: bad\nattempts: 0\n")
    with pytest.raises(ConfigError, match="attempts must be at least 1"):
        load_recipe(file)


def test_seeds_hang_on_names():
    assert name_seed(0, "a") == name_seed(0, "a")
    assert len({name_seed(0, "a"), name_seed(1, "a"), name_seed(0, "b"), name_seed(0, "a", "")}) == 4
    assert all(0 <= name_seed(0, str(index)) < 2**63 for index in range(100))


def test_recipes_survive_the_store():
    recipe = load_recipe("smoke")
    assert msgspec.convert(msgspec.json.decode(msgspec.json.encode(recipe)), Recipe) == recipe
