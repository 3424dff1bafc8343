"""ModelNet folders: `<class>/{train,test}/<class>_NNNN.off`, with class and split kept."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from grasp_core.errors import MeshError
from grasp_core.objects.asset import ObjectAsset
from grasp_core.objects.library import Scale, load_object

SPLITS = ("train", "test")


def find_modelnet(
    path: str | Path, *, split: str | None = None, classes: Sequence[str] | None = None
) -> list[tuple[Path, str, str]]:
    """(file, class, split) of a ModelNet folder, sorted by class, split and name.

    Raises:
        MeshError: no such folder, not laid out as ModelNet is, or without the class or split asked for.
    """
    path = Path(path).expanduser()
    if not path.is_dir():
        raise MeshError(f"{path}: no such folder")
    if split is not None and split not in SPLITS:
        raise MeshError(f"split must be one of {', '.join(SPLITS)}, not '{split}'")
    every = [
        (file, file.parent.parent.name, file.parent.name)
        for file in sorted(path.glob("*/*/*"))
        if file.suffix.lower() == ".off" and file.parent.name in SPLITS
    ]
    if not every:
        raise MeshError(f"{path}: is no ModelNet folder; it must hold <class>/train/*.off or <class>/test/*.off")
    known = sorted({label for _, label, _ in every})
    for label in classes or ():
        if label not in known:
            raise MeshError(f"{path}: has no class '{label}'; choose from: {', '.join(known)}")
    return [one for one in every if (split is None or one[2] == split) and (not classes or one[1] in classes)]


def load_modelnet(
    path: str | Path,
    *,
    scale: Scale = "paper",
    seed: int = 0,
    split: str | None = None,
    classes: Sequence[str] | None = None,
    per_class: int | None = None,
    timeout_s: float = 60.0,
    progress: Callable[[int, int], None] | None = None,
) -> tuple[list[ObjectAsset], dict[Path, str]]:
    """Read a ModelNet folder; `category` is the class, `meta["split"]` the split; bad files are left out with a reason.

    Args:
        path: the folder that holds the classes.
        scale: ModelNet's units are arbitrary, so "paper" (10-20 cm) by default.
        seed: of the drawn sizes.
        split: "train", "test" or both.
        classes: these only.
        per_class: at most so many of each class and split.
        timeout_s: for each decomposition.
        progress: called with files done and files in all.

    Returns:
        The assets and file → why it was refused.

    Raises:
        MeshError: see `find_modelnet`.
    """
    found = find_modelnet(path, split=split, classes=classes)
    if per_class is not None:
        counts: dict[tuple[str, str], int] = {}
        kept = []
        for one in found:
            counts[one[1:]] = counts.get(one[1:], 0) + 1
            if counts[one[1:]] <= per_class:
                kept.append(one)
        found = kept
    assets, refused = [], {}
    for done, (file, label, part) in enumerate(found):
        try:
            asset = load_object(file, scale=scale, seed=seed, category=label, timeout_s=timeout_s)
            assets.append(replace(asset, meta={**asset.meta, "split": part}))
        except MeshError as error:
            refused[file] = str(error)
        except Exception as error:  # a file that breaks a reader must not stop the others
            refused[file] = f"{file}: {type(error).__name__}: {error}"
        if progress:
            progress(done + 1, len(found))
    return assets, refused
