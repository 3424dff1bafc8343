"""Words on pictures: OpenCV's letters are ASCII alone."""

from __future__ import annotations

_SPELLED = str.maketrans(
    {"°": " deg", "×": "x", "±": "+-", "→": "->", "·": "*", "–": "-", "≥": ">=", "≤": "<=", "φ": "phi", "σ": "sigma"}
)


def plain(text: str) -> str:
    """The text in ASCII: known signs are spelled out, others become question marks."""
    return text.translate(_SPELLED).encode("ascii", "replace").decode()
