"""`grasp-core objects`: list the catalogue, look at it, export from it."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import tyro

from grasp_core.errors import GraspError, MeshError

if TYPE_CHECKING:
    from grasp_core.objects.asset import ObjectAsset


@dataclass(frozen=True)
class List:
    """List the families of the catalogue and the sets that are installed."""

    json: bool = False
    """Print one JSON object."""

    def run(self) -> int | None:
        """Print families by group, then sets."""
        from grasp_core.objects.parametric import FAMILIES
        from grasp_core.objects.sets import SETS, set_files

        groups: dict[str, list[str]] = {}
        for name, family in sorted(FAMILIES.items()):
            groups.setdefault(family.group, []).append(name)
        sets = {}
        for name in SETS:
            try:
                sets[name] = len(set_files(name))
            except MeshError:
                sets[name] = 0
        if self.json:
            print(json.dumps({"families": groups, "sets": sets}))
            return None
        print(f"{len(FAMILIES)} families; an object's name is a family and a seed, such as mug_003")
        for group, names in groups.items():
            print(f"  {group}: {', '.join(names)}")
        for name, count in sets.items():
            print(f"  set {name}: " + (f"{count} objects" if count else "not installed (extra `objects`)"))
        return None


@dataclass(frozen=True)
class Sheet:
    """Draw a contact sheet of objects into one picture."""

    names: Annotated[tuple[str, ...], tyro.conf.Positional] = field(default=())
    """Families, installed sets, object names or files; every family when none is given."""
    out: Path = Path("objects.png")
    """The picture, .png or .jpg."""
    seeds: int = 3
    """Objects of each family or set."""
    modelnet: Path | None = None
    """A ModelNet folder to draw instead."""
    folder: Path | None = None
    """A folder of meshes and URDF objects to draw instead."""
    scale: Literal["keep", "paper"] | float = "paper"
    """Of files: "keep" metres, "paper" 10-20 cm, or a factor."""
    columns: int = 12
    size: int = 150
    """Pixels of one object."""
    parts: bool = False
    """Draw the convex parts."""

    def run(self) -> int | None:
        """Draw and write the picture; files that were refused are named on stderr."""
        import cv2

        from grasp_core.objects.library import load_folder
        from grasp_core.objects.modelnet import load_modelnet
        from grasp_core.objects.parametric import FAMILIES
        from grasp_core.objects.sheet import sheet

        refused: dict[Path, str] = {}
        if self.modelnet is not None:
            assets, refused = load_modelnet(self.modelnet, scale=self.scale)
        elif self.folder is not None:
            assets, refused = load_folder(self.folder, self.scale)
        else:
            assets = [one for name in self.names or tuple(FAMILIES) for one in _named(name, self.seeds, self.scale)]
        for reason in refused.values():
            print(f"left out: {reason}", file=sys.stderr)
        if not assets:
            raise MeshError("there is nothing to draw; every file was refused")
        image = sheet(assets, min(self.columns, len(assets)), self.size, parts=self.parts)
        try:
            written = cv2.imwrite(str(self.out), image)
        except cv2.error:
            written = False
        if not written:
            raise GraspError(f"{self.out}: cannot be written; give a .png or .jpg file in a folder that exists")
        print(f"{self.out}: {len(assets)} objects")
        return None


@dataclass(frozen=True)
class Export:
    """Write objects as URDF (with parts, mass and inertia) or as asset files."""

    names: Annotated[tuple[str, ...], tyro.conf.Positional]
    """Object names (mug_003), or files."""
    out: Path = Path("objects")
    """A folder; each object gets one of its own in it."""
    format: Literal["urdf", "npz"] = "urdf"
    """Either "urdf", which opens in yourdfpy and viser, or "npz", the asset itself."""
    scale: Literal["keep", "paper"] | float = "keep"
    """Of files: "keep" metres, "paper" 10-20 cm, or a factor."""

    def run(self) -> int | None:
        """Write each object and print its file."""
        from grasp_core.objects.urdf import write_urdf

        for name in self.names:
            for asset in _named(name, 1, self.scale):
                if self.format == "urdf":
                    print(write_urdf(asset, self.out / asset.name))
                else:
                    try:
                        self.out.mkdir(parents=True, exist_ok=True)
                        asset.save(self.out / f"{asset.name}.npz")
                    except OSError as error:
                        raise GraspError(f"{self.out}: cannot be written ({error.strerror})") from error
                    print(self.out / f"{asset.name}.npz")
        return None


def _named(name: str, seeds: int, scale: Literal["keep", "paper"] | float) -> list[ObjectAsset]:
    """The objects of a family, of an installed set, of a name of the catalogue or of a file."""
    from grasp_core.objects.library import catalogue, load_object
    from grasp_core.objects.parametric import FAMILIES, make
    from grasp_core.objects.sets import SETS, set_files

    if name in SETS:
        return [catalogue(one) for one in list(set_files(name))[:seeds]]
    if name in FAMILIES:
        return [make(name, seed) for seed in range(seeds)]
    if Path(name).suffix:
        return [load_object(name, scale=scale)]
    return [catalogue(name)]
