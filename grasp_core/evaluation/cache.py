"""Results that are dear to compute and follow from content alone, kept in the user's cache folder."""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import TypeVar

import msgspec
import platformdirs

import grasp_core

T = TypeVar("T")


def folder() -> Path:
    """Where results are kept; deleting it only costs time."""
    return Path(platformdirs.user_cache_dir("grasp-workbench")) / "evaluation"


@cache
def code_digest(*places: str) -> str:
    """A hash of source files of grasp_core (files, or packages with all below): results follow from their code too."""
    root = Path(grasp_core.__file__).parent
    h = hashlib.sha256()
    for place in places:
        path = root / place
        for file in [path] if path.is_file() else sorted(path.rglob("*.py")):
            h.update(file.read_bytes())
    return h.hexdigest()[:12]


def remembered(kind: str, key: object, type_: type[T], make: Callable[[], T]) -> T:
    """The value of `make`, from the cache where it was made before.

    Args:
        kind: of value, a word.
        key: everything that the value follows from, JSON-able, with the version of the method.
        type_: of the value, JSON-able by msgspec.
        make: computes it.
    """
    name = hashlib.sha256(msgspec.json.encode(key, order="sorted")).hexdigest()[:24]
    path = folder() / kind / f"{name}.json"
    try:
        return msgspec.json.decode(path.read_bytes(), type=type_)
    except (OSError, msgspec.DecodeError):
        pass
    value = make()
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent)
        with os.fdopen(handle, "wb") as stream:
            stream.write(msgspec.json.encode(value))
        os.replace(temporary, path)
    except OSError:
        pass  # a full or read-only disk costs the cache, not the result
    return value
