"""Every shipped configuration decodes with the loader of its kind, and every kind has one."""

from collections.abc import Callable
from pathlib import Path

import pytest

import static_configs
from grasp_core import config
from grasp_core.camera import load_camera
from grasp_core.dataset.recipe import load_recipe
from grasp_core.evaluation.suites import Suite
from grasp_core.gripper import load_gripper
from grasp_core.planning.planner import PLANNERS
from grasp_core.sensing.noise import load_noise
from grasp_core.simulation.physics import load_physics

ROOT = Path(static_configs.__file__).parent


def load_planner(name: str) -> object:
    import importlib

    values = config.read_yaml(config.locate("planners", name))
    module, kind = PLANNERS[values.pop("planner")]
    return config.convert(values, getattr(importlib.import_module(module), kind).settings_type, name)


def load_training(name: str) -> object:
    from grasp_core.training.refined import RefinedSettings
    from grasp_core.training.regression import RegressionSettings

    # The network stands first in the name: refined.yaml, refined_wide.yaml.
    return config.load("training", name, RefinedSettings if name.startswith("refined") else RegressionSettings)


def load_ablation(name: str) -> object:
    from grasp_core.training.ablation import Ablation, variant_settings

    return variant_settings(config.load("ablations", name, Ablation))


LOADERS: dict[str, Callable[[str], object]] = {
    "ablations": load_ablation,
    "benchmarks": lambda name: config.load("benchmarks", name, Suite),
    "cameras": load_camera,
    "grippers": load_gripper,
    "noise": load_noise,
    "physics": load_physics,
    "planners": load_planner,
    "recipes": load_recipe,
    "training": load_training,
}


def test_every_kind_has_its_loader():
    kinds = {path.parent.name for path in ROOT.rglob("*.yaml")}
    assert kinds == set(LOADERS), "a new kind of configuration needs its loader here"


@pytest.mark.parametrize(("kind", "name"), [(kind, name) for kind in LOADERS for name in config.shipped(kind)])
def test_shipped_configurations_decode(kind, name):
    assert LOADERS[kind](name) is not None


@pytest.mark.parametrize("path", sorted(ROOT.rglob("*.yaml")), ids=lambda path: str(path.relative_to(ROOT)))
def test_shipped_configurations_explain_themselves(path):
    text = path.read_text(encoding="utf-8")
    assert text.startswith(("#", "about:")), f"{path}: says in its first line what it is for"
