"""What a benchmark runs on: a suite by name (`static_configs/benchmarks`), a suite file, or any folder of meshes.

A suite takes its objects from the catalogue, a recipe's split, a set that users can install, or hard geometry.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Literal, Protocol

import msgspec
import numpy as np

from grasp_core import config
from grasp_core.dataset.recipe import Folder, Objects, Recipe, load_recipe, plan_objects
from grasp_core.dataset.rows import Split
from grasp_core.errors import ConfigError, GraspError
from grasp_core.evaluation.cache import code_digest, remembered
from grasp_core.evaluation.hard import Range, hard_plans
from grasp_core.objects.asset import ObjectAsset
from grasp_core.objects.sets import set_files, set_object
from grasp_core.simulation.physics import Physics
from grasp_core.simulation.settling import StablePose, stable_poses

Scale = Literal["keep", "paper"] | float

_DROPS = 60


class PlannedObject(Protocol):
    """An object of a suite, not made yet.

    Attributes:
        name: unique in the suite.
    """

    @property
    def name(self) -> str: ...  # noqa: D102

    def make(self) -> ObjectAsset:
        """Make or load the object.

        Raises:
            MeshError: it cannot be used.
        """
        ...


class SetPlan(msgspec.Struct, frozen=True):
    """An object of an installed set, by the name that the set gives it."""

    name: str

    def make(self) -> ObjectAsset:
        """Load the object; see `set_object`."""
        return set_object(self.name)


class Suite(config.Settings):
    """A committed list of objects, from one of four sources, and how many scenes each of them is shown in.

    Attributes:
        about: what the suite is for.
        objects: by family, catalogue name or folder.
        recipe: name of a recipe whose split is taken.
        split: of that recipe.
        installed: name of an installable set.
        hard: kind → number → least and greatest value; see `hard.KINDS`.
        most: objects of the installed set, evenly spread over its names, or of each kind; None takes the whole set.
        poses: stable poses an object, at most.
        draws: scenes a stable pose, each at another place and yaw.
    """

    about: str
    objects: Objects | None = None
    recipe: str | None = None
    split: Split = "test"
    installed: str | None = None
    hard: dict[str, dict[str, Range]] | None = None
    most: int | None = None
    poses: int = 2
    draws: int = 1

    def __post_init__(self) -> None:
        if sum(source is not None for source in (self.objects, self.recipe, self.installed, self.hard)) != 1:
            raise ValueError("a suite has one source: objects, the name of a recipe, an installed set, or hard kinds")
        if self.hard is not None and self.most is None:
            raise ValueError("most: says how many objects of each hard kind there are")
        for name in ("most", "poses", "draws"):
            if getattr(self, name) is not None and getattr(self, name) < 1:
                raise ValueError(f"{name} must be at least 1, not {getattr(self, name)}")
        if self.hard is not None:
            hard_plans(self.hard, 1)


def parse_scale(text: str) -> Scale:
    """ "keep", "paper" or a factor.

    Raises:
        GraspError: anything else.
    """
    if text == "keep":
        return "keep"
    if text == "paper":
        return "paper"
    try:
        factor = float(text)
    except ValueError:
        factor = 0.0
    if not 0 < factor < float("inf"):
        raise GraspError(f"--scale is keep (metres), paper (longest side 10-20 cm) or a factor above 0, not '{text}'")
    return factor


def find_suite(name: str) -> Suite | None:
    """The suite of that name or file; None for an existing folder of meshes.

    Raises:
        ConfigError: no such folder or suite.
    """
    if Path(name).expanduser().is_dir():
        return None
    if not name.endswith((".yaml", ".yml")) and name not in config.shipped("benchmarks"):
        suites = ", ".join(config.shipped("benchmarks"))
        raise ConfigError(f"'{name}' is no folder and no suite; give a folder of meshes or one of: {suites}")
    return config.load("benchmarks", name, Suite)


def object_plans(name: str, scale: Scale, seed: int) -> Sequence[PlannedObject]:
    """The objects of a folder, a suite file or a shipped suite; none of them is made yet.

    Args:
        name: an existing folder, a path that ends in .yaml, or a shipped suite.
        scale: of the meshes of a folder.
        seed: of the sizes that "paper" draws.

    Raises:
        ConfigError: no such folder or suite, or one without objects.
        MeshError: the suite's set is not installed.
    """
    suite = find_suite(name)
    if suite is None:
        folder = Path(name).expanduser()
        return plan_objects(
            Recipe(name=str(folder), test=Objects(folders=(Folder(path=str(folder), scale=scale),)), seed=seed)
        )
    if suite.recipe is not None:
        return [plan for plan in plan_objects(load_recipe(suite.recipe)) if plan.split == suite.split]
    if suite.installed is not None:
        names = list(set_files(suite.installed))
        count = min(suite.most or len(names), len(names))
        return [SetPlan(names[index * len(names) // count]) for index in range(count)]
    if suite.hard is not None:
        return hard_plans(suite.hard, suite.most or 1)
    assert suite.objects is not None
    base = config.locate("benchmarks", name).parent
    folders = tuple(
        msgspec.structs.replace(f, path=str(base / Path(f.path).expanduser())) for f in suite.objects.folders
    )
    objects = msgspec.structs.replace(suite.objects, folders=folders)
    return plan_objects(Recipe(name=name, test=objects, seed=seed))


def poses_of(asset: ObjectAsset, physics: Physics) -> list[StablePose]:
    """The stable poses of an object, likeliest first; cached by content.

    Raises:
        GraspError: it comes to rest in none.
    """

    def make() -> list[tuple[list[list[float]], float]]:
        found = stable_poses(asset, physics, drops=_DROPS, seed=0)
        return [(item.pose.tolist(), float(item.probability)) for item in found]

    key = [code_digest("simulation"), asset.digest, physics.digest, _DROPS]
    known = remembered("poses", key, list[tuple[list[list[float]], float]], make)
    return [StablePose(np.array(pose), probability) for pose, probability in known]
