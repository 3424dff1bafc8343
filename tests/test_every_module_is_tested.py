"""Every module has its test file: grasp_core/a/b.py → tests/grasp_core/a/test_b.py, and workbench likewise."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
MODULES = [
    path.relative_to(ROOT)
    for package in ("grasp_core", "workbench")
    for path in sorted((ROOT / package).rglob("*.py"))
    if not (path.name == "__init__.py" and len(ast.parse(path.read_text(encoding="utf-8")).body) <= 1)
]


def place_of_tests(module: Path) -> Path:
    """Where the tests of a module stand; a package with code in its `__init__.py` is tested beside its folder."""
    own = module.parent if module.name == "__init__.py" else module.with_suffix("")
    return Path("tests") / own.parent / f"test_{own.name}.py"


@pytest.mark.parametrize("module", MODULES, ids=str)
def test_every_module_has_its_tests(module):
    tests = ROOT / place_of_tests(module)
    assert tests.is_file(), f"{module} has no tests: write {place_of_tests(module)}"
    functions = [
        node.name
        for node in ast.walk(ast.parse(tests.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and node.name.startswith("test")
    ]
    assert functions, f"{place_of_tests(module)} tests nothing"


def test_tests_are_no_packages():
    assert not list((ROOT / "tests").rglob("__init__.py"))


def test_the_mapping():
    assert place_of_tests(Path("grasp_core/sensing/noise.py")) == Path("tests/grasp_core/sensing/test_noise.py")
    assert place_of_tests(Path("grasp_core/cli/__init__.py")) == Path("tests/grasp_core/test_cli.py")
    assert place_of_tests(Path("workbench/app.py")) == Path("tests/workbench/test_app.py")
    assert place_of_tests(Path("workbench/panels/plan.py")) == Path("tests/workbench/panels/test_plan.py")
