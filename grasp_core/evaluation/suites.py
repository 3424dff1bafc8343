"""What a benchmark runs on: a suite by name (`static_configs/benchmarks`), a suite file, or any folder of meshes."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import msgspec
import numpy as np

from grasp_core import config
from grasp_core.dataset.recipe import Folder, ObjectPlan, Objects, Recipe, load_recipe, plan_objects
from grasp_core.dataset.rows import Split
from grasp_core.errors import ConfigError, GraspError
from grasp_core.evaluation.cache import code_digest, remembered
from grasp_core.objects.asset import ObjectAsset
from grasp_core.simulation.physics import Physics
from grasp_core.simulation.settling import StablePose, stable_poses

Scale = Literal["keep", "paper"] | float

_DROPS = 60


class Suite(config.Settings):
    """A committed list of objects: its own, or those of one split of a recipe.

    Attributes:
        about: what the suite is for.
        objects: by family, catalogue name or folder.
        recipe: name of a recipe whose split is taken instead.
        split: of that recipe.
    """

    about: str
    objects: Objects | None = None
    recipe: str | None = None
    split: Split = "test"

    def __post_init__(self) -> None:
        if (self.objects is None) == (self.recipe is None):
            raise ValueError("a suite has either objects or the name of a recipe")


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


def object_plans(name: str, scale: Scale, seed: int) -> list[ObjectPlan]:
    """The objects of a folder, a suite file or a shipped suite; none of them is made yet.

    Args:
        name: an existing folder, a path that ends in .yaml, or a shipped suite.
        scale: of the meshes of a folder.
        seed: of the sizes that "paper" draws.

    Raises:
        ConfigError: no such folder or suite, or one without objects.
    """
    folder = Path(name).expanduser()
    if folder.is_dir():
        objects = Objects(folders=(Folder(path=str(folder), scale=scale),))
        return plan_objects(Recipe(name=str(folder), test=objects, seed=seed))
    if not name.endswith((".yaml", ".yml")) and name not in config.shipped("benchmarks"):
        suites = ", ".join(config.shipped("benchmarks"))
        raise ConfigError(f"'{name}' is no folder and no suite; give a folder of meshes or one of: {suites}")
    suite = config.load("benchmarks", name, Suite)
    if suite.recipe is not None:
        return [plan for plan in plan_objects(load_recipe(suite.recipe)) if plan.split == suite.split]
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
