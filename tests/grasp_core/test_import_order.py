"""The order of the design: a package imports only from packages before it and from the root modules."""

import ast
from pathlib import Path

import pytest

import grasp_core

ROOT = Path(grasp_core.__file__).parent
ORDER = ["objects", "sensing", "simulation", "networks", "planning", "dataset", "training", "evaluation", "cli"]
FILES = sorted(ROOT.rglob("*.py"))
ROOT_MODULES = {path.stem for path in ROOT.glob("*.py")} - {"__init__"}
BEYOND_ROOT = {"scene": {"objects.asset"}}
"""What a root module may import besides root modules."""


def imports(source: str, package: list[str]) -> set[str]:
    """Dotted names that a module imports, anywhere in it, with relative ones made absolute.

    `from a import b` counts as `a.b`, since b may be a module.
    """
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            stem = ".".join([*base, *([node.module] if node.module else [])])
            found |= {f"{stem}.{alias.name}" for alias in node.names}
    return found


def forbidden(name: str, imported: str) -> str | None:
    """Why the module `name` (dotted, below grasp_core) must not import `imported`; None when it may."""
    words = imported.split(".")
    if words[0] in ("workbench", "viser"):
        return "grasp_core never imports workbench or viser"
    if words[0] != "grasp_core" or len(words) == 1:
        return None
    here, there = name.split(".")[0], words[1]
    if there not in ORDER:
        return None
    if here in ORDER:
        return None if ORDER.index(there) <= ORDER.index(here) else f"{there} comes after {here}"
    allowed = BEYOND_ROOT.get(here, set())
    if any(".".join(words[1:]).startswith(module) for module in allowed):
        return None
    return "root modules import root modules only"


def test_every_package_has_its_place_in_the_order():
    packages = {path.name for path in ROOT.iterdir() if (path / "__init__.py").is_file()}
    assert packages <= set(ORDER), "a new package needs its place in the order"


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_module_imports_only_what_comes_before_it(path):
    module = path.relative_to(ROOT).with_suffix("").parts
    package = ["grasp_core", *module[:-1]]
    name = ".".join(part for part in module if part != "__init__") or "__init__"
    wrong = {i: why for i in imports(path.read_text(encoding="utf-8"), package) if (why := forbidden(name, i))}
    assert not wrong


@pytest.mark.parametrize(
    ("source", "module", "wrong"),
    [
        ("from grasp_core.sensing import noise", "objects.asset", True),
        ("from grasp_core import sensing", "objects.asset", True),
        ("import grasp_core.planning.planner as p", "networks.runtime", True),
        ("def f():\n    from grasp_core.evaluation.report import pool", "dataset.store", True),
        ("from ..training import metrics", "objects.asset", True),
        ("from .asset import Part", "objects.library", False),
        ("from grasp_core.objects.asset import Part", "sensing.renderer", False),
        ("from grasp_core.camera import Camera", "objects.asset", False),
        ("from grasp_core.objects.asset import ObjectAsset", "scene", False),
        ("from grasp_core.objects.asset import ObjectAsset", "camera", True),
        ("from grasp_core.objects.library import load_object", "scene", True),
        ("import viser", "evaluation.success", True),
        ("from workbench.app import App", "cli.plan", True),
        ("import numpy", "scene", False),
    ],
)
def test_the_rule_itself(source, module, wrong):
    package = ["grasp_core", *module.split(".")[:-1]]
    reasons = [forbidden(module, name) for name in imports(source, package)]
    assert any(reasons) is wrong
    assert "camera" in ROOT_MODULES
