"""Sets of meshes that users can install (extra `objects`), read from the installed packages.

"rgb" are the RGB objects of dm_robotics (Apache-2.0), "random_urdfs" those of PyBullet's data (zlib). Archives of
labels hold the cleaned meshes and parts of the objects that their recipe names: restoring them needs no set.
"""

from __future__ import annotations

import importlib.util
from pathlib import Path

from grasp_core.errors import MeshError
from grasp_core.objects.asset import ObjectAsset
from grasp_core.objects.library import load_object

SETS = {
    "rgb": ("dm_robotics", "manipulation/props/rgb_objects/assets/rgb_v1.3/meshes", "*/*.stl"),
    "random_urdfs": ("pybullet_data", "random_urdfs", "*/*.urdf"),
}
"""Set → (package that holds it, folder in it, pattern)."""


def set_of(name: str) -> str | None:
    """The set that an object's name belongs to, whether it is installed or not."""
    return next((owner for owner in SETS if name.startswith(f"{owner}_")), None)


def set_files(name: str) -> dict[str, Path]:
    """Object name ("rgb_<shape>", "random_urdfs_<number>") → file, sorted; one file for each name.

    Raises:
        MeshError: no such set, or its package is not installed.
    """
    if name not in SETS:
        raise MeshError(f"no set is called '{name}'; choose one of: {', '.join(SETS)}")
    package, folder, pattern = SETS[name]
    found = importlib.util.find_spec(package)
    roots = [Path(place) / folder for place in (found.submodule_search_locations or ())] if found else []
    files = [file for root in roots if root.is_dir() for file in sorted(root.glob(pattern))]
    if not files:
        raise MeshError(f"the set '{name}' is not installed; run: pip install 'grasp-workbench[objects]'")
    names: dict[str, Path] = {}
    for file in files:
        names.setdefault(f"{name}_{file.stem}", file)
    return dict(sorted(names.items()))


def set_object(full_name: str, *, timeout_s: float = 60.0) -> ObjectAsset:
    """One object of an installed set in its own size, by the name that `set_files` gives it.

    Raises:
        MeshError: no such object or set, the set is not installed, or its file cannot be used.
    """
    name = set_of(full_name)
    if name is None:
        raise MeshError(f"'{full_name}' belongs to no installable set; their names begin with: {', '.join(SETS)}")
    files = set_files(name)
    if full_name not in files:
        raise MeshError(f"the set '{name}' has no object '{full_name}'; `set_files` lists its {len(files)} names")
    asset = load_object(files[full_name], name=full_name, category=name, timeout_s=timeout_s)
    asset.meta["split"] = files[full_name].parent.name if name == "rgb" else "train"
    return asset
