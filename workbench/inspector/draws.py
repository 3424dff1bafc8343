"""Seeds for actions that ask for something new."""

from __future__ import annotations

import secrets


def draw() -> int:
    """A fresh random seed."""
    return secrets.randbelow(2**31 - 1)
