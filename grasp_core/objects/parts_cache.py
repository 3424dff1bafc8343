"""Decompositions kept in the user's cache folder: a file for each key, written whole or not at all."""

from __future__ import annotations

import contextlib
import uuid
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import platformdirs
from numpy.typing import NDArray

from grasp_core.objects.asset import Part
from grasp_core.objects.fidelity import Fidelity


@dataclass(frozen=True)
class Decomposition:
    """Convex parts in the frame of the mesh, and how well they stand for it.

    Attributes:
        parts: closed and convex.
        method: how they came about: "exact…", "merged…", "cut…", "coacd…" or "hull…".
        fidelity: how far they stand off the mesh, in its units.
    """

    parts: tuple[Part, ...]
    method: str
    fidelity: Fidelity


def read(key: str) -> Decomposition | None:
    """What was kept under a key; None where nothing was, or the file is damaged."""
    try:
        with np.load(_file(key)) as found:
            parts = tuple(Part(found[f"v{i}"], found[f"f{i}"]) for i in range(int(found["count"])))
            error, missing, filled = (float(value) for value in found["fidelity"])
            return Decomposition(parts, str(found["method"]), Fidelity(error, missing, filled))
    except (OSError, KeyError, ValueError, EOFError):
        return None


def write(key: str, found: Decomposition) -> None:
    """Keep a result; a cache that cannot be written is no error."""
    got = found.fidelity
    content: dict[str, NDArray] = {
        "count": np.array(len(found.parts)),
        "method": np.array(found.method),
        "fidelity": np.array([got.error, got.missing, got.filled]),
    }
    for i, part in enumerate(found.parts):
        content |= {f"v{i}": part.vertices, f"f{i}": part.faces}
    file = _file(key)
    partial = file.with_name(f".{file.stem}-{uuid.uuid4().hex}.npz")
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        np.savez_compressed(partial, **content)  # type: ignore[arg-type]
        partial.replace(file)
    except OSError:
        with contextlib.suppress(OSError):
            partial.unlink()


def _file(key: str) -> Path:
    return Path(platformdirs.user_cache_dir("grasp-workbench")) / "parts" / f"{key}.npz"
