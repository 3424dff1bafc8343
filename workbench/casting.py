"""Values on their way to viser: cast to what it can encode, and made safe inside HTML.

viser disconnects every client when one property cannot be encoded (a numpy scalar, a stray object), on each reconnect
again, and shows HTML unfiltered.
"""

from __future__ import annotations

import html
import math
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray

from grasp_core.errors import GraspError

_MOST_TOLD = 240
"""Characters of a message."""


def plain(value: Any) -> Any:
    """`value` in types that viser can encode: builtins, tuples of them, or numeric arrays.

    Raises:
        GraspError: the value holds anything else, or a number that is not finite.
    """
    if isinstance(value, np.ndarray):
        if value.dtype.kind not in "fiub":
            raise GraspError(f"an array of type {value.dtype} cannot be shown")
        return value
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, bool | int | str | bytes):
        return value
    if isinstance(value, float):
        if not math.isfinite(value):
            raise GraspError("a number that is not finite cannot be shown")
        return value
    if isinstance(value, list | tuple):
        return tuple(plain(item) for item in value)
    raise GraspError(f"a {type(value).__name__} cannot be shown")


def put(handle: Any, **properties: Any) -> None:
    """Set properties of a viser handle, cast by `plain`; equal ones are left alone."""
    for name, value in properties.items():
        cast = plain(value)
        if not isinstance(cast, np.ndarray):
            current = getattr(handle, name)
            if not isinstance(current, np.ndarray) and type(current) is type(cast) and current == cast:
                continue
        setattr(handle, name, cast)


def text(value: object) -> str:
    """Any text made safe inside HTML: viser would run what a name smuggles in."""
    return html.escape(str(value), quote=True)


def sentence(words: str) -> str:
    """Words with a capital and a full stop; a name that they begin with keeps its first letter."""
    words = words.strip()
    if not words:
        return words
    named = any(sign in words.split()[0] for sign in "._:/")
    return (words[0] if named else words[0].upper()) + words[1:] + ("" if words[-1] in ".!?" else ".")


def brief(words: str) -> str:
    """The beginning of a long text, up to a whole word."""
    return words if len(words) <= _MOST_TOLD else words[:_MOST_TOLD].rpartition(" ")[0] + " …"


def pose(transform: NDArray[np.float64]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """4×4 → (w, x, y, z) and (x, y, z), as viser takes them."""
    rotation = viser.transforms.SO3.from_matrix(np.asarray(transform, float)[:3, :3])
    return plain(tuple(rotation.wxyz)), plain(tuple(np.asarray(transform, float)[:3, 3]))
