"""Recipes: which objects, poses, grasps and attempts a dataset is made of; one YAML file says it all.

What is random in a scene is drawn from the recipe's seed and the scene's name, never from the order of work, so that
any executor, any machine and any interruption end in the same content.
"""

from __future__ import annotations

import hashlib
import itertools
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Literal

import msgspec

from grasp_core import config
from grasp_core.dataset.rows import SPLITS, Split
from grasp_core.errors import ConfigError, MeshError
from grasp_core.objects.asset import ObjectAsset
from grasp_core.objects.sets import set_files, set_of
from grasp_core.planning.crops import DepthRule
from grasp_core.simulation.trial import GraspNoise


class Folder(config.Settings):
    """Objects from a folder of meshes, searched downwards.

    Attributes:
        path: of the folder.
        scale: "keep" takes the numbers as metres, "paper" resizes the longest side to 10-20 cm, a number multiplies.
        most: at most so many files, in the order of their paths; None takes all.
        skip: so many files before those.
        modelnet: the folder is laid out as ModelNet's; take this split of it, its classes in turn.
    """

    path: str
    scale: Literal["keep", "paper"] | float = "keep"
    most: int | None = None
    skip: int = 0
    modelnet: Literal["train", "test"] | None = None


class Objects(config.Settings):
    """The objects of one split.

    Attributes:
        families: parametric family → how many of it.
        first: seed of the first object of each family; the next ones follow.
        names: single objects of the catalogue, such as "mug_003", or of an installed set, such as "random_urdfs_003".
        folders: of meshes.
    """

    families: dict[str, int] = msgspec.field(default_factory=dict)
    first: int = 0
    names: tuple[str, ...] = ()
    folders: tuple[Folder, ...] = ()


class Recipe(config.Settings):
    """What a dataset is made of.

    Attributes:
        name: of the dataset.
        train: objects to learn from.
        validation: objects to choose settings by.
        test: objects to report on.
        poses: at most so many stable poses an object, the most probable ones.
        grid: grasp positions along each side of the object's bounding rectangle in the table plane.
        angles: closing axes at each position, φ = k · π / angles.
        attempts: noisy executions of each grasp.
        depth_rule: how deep grasps reach.
        noise: of the executed pose (Eq. 4).
        camera: name or file; it looks at every scene.
        gripper: name or file.
        physics: name or file.
        seed: everything random hangs on it.
    """

    name: str
    train: Objects = Objects()
    validation: Objects = Objects()
    test: Objects = Objects()
    poses: int = 3
    grid: int = 11
    angles: int = 6
    attempts: int = 5
    depth_rule: DepthRule = DepthRule()
    noise: GraspNoise = GraspNoise()
    camera: str = "canonical"
    gripper: str = "paper"
    physics: str = "default"
    seed: int = 0

    def __post_init__(self) -> None:
        for field in ("poses", "grid", "angles", "attempts"):
            if getattr(self, field) < 1:
                raise ValueError(f"{field} must be at least 1, not {getattr(self, field)}")

    def objects(self, split: Split) -> Objects:
        """The objects of a split."""
        chosen: Objects = getattr(self, split)
        return chosen


def load_recipe(name: str | Path) -> Recipe:
    """Read a recipe file or a shipped recipe; relative folders in a file count from the file.

    Raises:
        ConfigError: missing file, unknown, missing or ill-typed key, or an impossible value.
    """
    recipe = config.load("recipes", name, Recipe)
    base = config.locate("recipes", name).parent
    changed = {}
    for split in SPLITS:
        objects = recipe.objects(split)
        folders = tuple(msgspec.structs.replace(f, path=str(base / Path(f.path).expanduser())) for f in objects.folders)
        changed[split] = msgspec.structs.replace(objects, folders=folders)
    return msgspec.structs.replace(recipe, **changed)


class ObjectPlan(msgspec.Struct, frozen=True):
    """One object that a recipe asks for, not made yet.

    Attributes:
        name: unique in the dataset.
        split: that it belongs to.
        family: parametric family or installed set, "" for files.
        seed: of the family member, or of the drawn size of a file.
        file: of a mesh or URDF, or "".
        scale: of a file.
    """

    name: str
    split: Split
    family: str = ""
    seed: int = 0
    file: str = ""
    scale: Literal["keep", "paper"] | float = "keep"

    def make(self) -> ObjectAsset:
        """Make or load the object.

        Raises:
            MeshError: its file cannot be used.
        """
        from grasp_core.objects.library import catalogue, load_object

        if self.file:
            return load_object(Path(self.file), scale=self.scale, seed=self.seed, name=self.name)
        return catalogue(self.name)


def name_seed(seed: int, *names: str) -> int:
    """A seed in [0, 2⁶³) for something named, the same on every machine."""
    text = "\0".join([str(seed), *names])
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:8], "little") >> 1


def plan_objects(recipe: Recipe) -> list[ObjectPlan]:
    """Every object of a recipe, split by split.

    Raises:
        ConfigError: an unknown family, a missing folder, no objects, or one object that is asked for twice.
    """
    plans: dict[str, ObjectPlan] = {}
    for split in SPLITS:
        for plan in _split_plans(recipe, split):
            if plan.name in plans:
                raise ConfigError(
                    f"recipe '{recipe.name}': the object '{plan.name}' stands in {plans[plan.name].split} and in"
                    f" {split}; an object belongs to one split, once"
                )
            plans[plan.name] = plan
    if not plans:
        raise ConfigError(f"recipe '{recipe.name}' names no objects; give families, names or folders")
    return list(plans.values())


def check_sets(recipe: Recipe, plans: Iterable[ObjectPlan]) -> None:
    """See that every set that planned objects come from is installed and has them, before hours of work without them.

    Raises:
        ConfigError: it is not installed, or has no object of that name.
    """
    wanted: dict[str, list[str]] = {}
    for plan in plans:
        if (owner := set_of(plan.name)) is not None and not plan.file:
            wanted.setdefault(owner, []).append(plan.name)
    for owner, names in wanted.items():
        try:
            files = set_files(owner)
        except MeshError as error:
            raise ConfigError(f"recipe '{recipe.name}': {error}") from error
        for name in names:
            if name not in files:
                raise ConfigError(f"recipe '{recipe.name}': the set '{owner}' has no object '{name}'")


def _split_plans(recipe: Recipe, split: Split) -> list[ObjectPlan]:
    objects = recipe.objects(split)
    known = _families()
    plans = []
    wanted = [
        (family, seed) for family, n in objects.families.items() for seed in range(objects.first, objects.first + n)
    ]
    for name in objects.names:
        if (owner := set_of(name)) is not None:
            plans.append(ObjectPlan(name, split, owner))
            continue
        family, _, number = name.rpartition("_")
        if not number.isdigit():
            raise ConfigError(
                f"recipe '{recipe.name}': '{name}' is no object of the catalogue (such as mug_003) or of a set"
            )
        wanted.append((family, int(number)))
    for family, seed in wanted:
        if family not in known:
            raise ConfigError(
                f"recipe '{recipe.name}': no family is called '{family}'; choose from: {', '.join(sorted(known))}"
            )
        plans.append(ObjectPlan(f"{family}_{seed:03d}", split, family, seed))
    for folder in objects.folders:
        plans.extend(_folder_plans(recipe, split, folder))
    return plans


def _families() -> set[str]:
    from grasp_core.objects.parametric import FAMILIES

    return set(FAMILIES)


def _folder_plans(recipe: Recipe, split: Split, folder: Folder) -> list[ObjectPlan]:
    root = Path(folder.path)
    try:
        named = _modelnet_files(root, folder.modelnet) if folder.modelnet else _mesh_files(root)
    except MeshError as error:
        raise ConfigError(f"recipe '{recipe.name}': {error}") from error
    plans = []
    for name, path in named[folder.skip :][: folder.most]:
        seed = name_seed(recipe.seed, "scale", name) % 2**32
        plans.append(ObjectPlan(name, split, "", seed, str(path), folder.scale))
    return plans


def _mesh_files(root: Path) -> list[tuple[str, Path]]:
    from grasp_core.objects.library import find_files

    return [(path.relative_to(root).with_suffix("").as_posix(), path) for path in find_files(root)]


def _modelnet_files(root: Path, part: str) -> list[tuple[str, Path]]:
    """Names and files of a split of ModelNet: the first of each class, the second of each, …"""
    from grasp_core.objects.modelnet import find_modelnet

    classes: dict[str, list[Path]] = {}
    for path, label, _ in find_modelnet(root, split=part):
        classes.setdefault(label, []).append(path)
    turns = itertools.zip_longest(*classes.values())
    return [(path.stem, path) for turn in turns for path in turn if path is not None]


def with_modelnet(recipe: Recipe, path: str | Path) -> Recipe:
    """The recipe with ModelNet's meshes in place of its objects, as many of each split, at the paper's scale.

    ModelNet's test meshes stay test objects; its train meshes are learnt from, the next ones of them validate.

    Raises:
        ConfigError: the recipe's own objects cannot be planned.
    """
    counts = Counter(plan.split for plan in plan_objects(recipe))
    root = str(Path(path).expanduser().resolve())

    def part(name: Literal["train", "test"], most: int, skip: int = 0) -> Objects:
        return Objects(folders=(Folder(root, "paper", most, skip, name),))

    return msgspec.structs.replace(
        recipe,
        name=f"{recipe.name}-modelnet",
        train=part("train", counts["train"]),
        validation=part("train", counts["validation"], skip=counts["train"]),
        test=part("test", counts["test"]),
    )
