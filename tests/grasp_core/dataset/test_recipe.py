import msgspec
import pytest
import trimesh

from grasp_core import config
from grasp_core.dataset.recipe import Folder, Objects, Recipe, load_recipe, name_seed, plan_objects
from grasp_core.dataset.rows import SPLITS
from grasp_core.errors import ConfigError


@pytest.mark.parametrize("name", sorted(config.shipped("recipes")))
def test_shipped_recipes_can_be_followed(name):
    recipe = load_recipe(name)
    assert recipe.name == name
    plans = plan_objects(recipe)
    assert {plan.split for plan in plans} == set(SPLITS)
    assert len({plan.name for plan in plans}) == len(plans)


def test_paper_has_the_papers_numbers():
    recipe = load_recipe("paper")
    assert (recipe.grid, recipe.angles, recipe.attempts) == (11, 6, 5)
    splits = [plan.split for plan in plan_objects(recipe)]
    assert (splits.count("train"), splits.count("test")) == (100, 20)


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
        (Objects(names=("box",)), "'box' is no object of the catalogue"),
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
