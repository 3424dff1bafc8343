"""Messages about own files in the words of the page: as people named the files, without where they are kept."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

_HERE = (
    (r"say what a unit is, --depth-scale 0\.001 for millimetres", "set the unit to mm"),
    (r"check --depth-scale", "set another unit"),
    (r"--depth-scale", "the unit"),
    (r"if the file is not in metres give a factor .*10-20 cm", "set another mesh unit"),
    (r" \(This file contains pickled .*\)", ""),  # NumPy's advice, to people who program
)
"""What the command line and libraries say → what this page says."""


def named(path: str | Path) -> str:
    """The name of an own file, which the shelf may have put a key before."""
    name = Path(path).name
    return name.partition("--")[2] or name


def reworded(message: str, paths: Iterable[str | Path]) -> str:
    """A message about own files, without these paths."""
    for path in paths:
        message = message.replace(str(path), named(path))
    for pattern, here in _HERE:
        message = re.sub(pattern, here, message)
    return message
