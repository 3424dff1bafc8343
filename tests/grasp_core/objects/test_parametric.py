"""The package of the catalogue: everything that registers families is imported, and no family hides another."""

import ast
from pathlib import Path

import grasp_core.objects.parametric as parametric
from grasp_core.objects.parametric import FAMILIES, Family, family, make

FOLDER = Path(parametric.__file__).parent


def registered(path: Path) -> list[str]:
    """Names of the families that a file's source registers."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return [
        node.name.rstrip("_")
        for node in tree.body
        if isinstance(node, ast.FunctionDef)
        for mark in node.decorator_list
        if isinstance(mark, ast.Call) and getattr(mark.func, "id", "") == "family"
    ]


def test_every_file_with_families_is_part_of_the_catalogue():
    files = {path.stem: registered(path) for path in FOLDER.glob("*.py")}
    groups = {stem for stem, names in files.items() if names}
    assert {"bathroom", "food", "furniture", "machine", "office", "tools", "toys", "vessels"} <= groups
    assert groups <= set(parametric.__all__)
    names = [name for own in files.values() for name in own]
    assert sorted(names) == sorted(FAMILIES), "a family is missing, or two share a name"


def test_a_familys_name_is_its_key():
    assert all(isinstance(kind, Family) and kind.name == name for name, kind in FAMILIES.items())
    assert "box" in FAMILIES and "box_" not in FAMILIES


def test_the_packages_names_are_those_of_its_files():
    assert all(hasattr(parametric, name) for name in parametric.__all__)
    assert parametric.make is family.make and parametric.FAMILIES is family.FAMILIES
    assert make("orange", 0).meta == {"group": "fruit"}
