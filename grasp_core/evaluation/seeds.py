"""Random numbers of evaluation, apart from every seed that a label was made with.

Attempts that set labels have seeds below 2³² (`simulation.trial.child_seed`). Here every seed passes through a
`SeedSequence` that begins with a word of its own and is at least 2⁶², so that no evaluation repeats the noise of such
an attempt, whatever seed its user gives.
"""

from __future__ import annotations

import hashlib

import numpy as np

NAMESPACE = int.from_bytes(b"evaluate", "big")
"""First word of every seed sequence here; generation never begins one with it."""


def child_seed(seed: int, *words: str | int) -> int:
    """A seed in [2⁶², 2⁶³) for one purpose, named by words: equal words, equal seed, on every machine and in any order.

    Args:
        seed: the user's, 0 included.
        words: what for, for example "execute", a scene's name and a number.
    """
    text = "\x1f".join(f"{type(word).__name__}:{word}" for word in words)
    spread = int.from_bytes(hashlib.sha256(text.encode()).digest()[:16], "big")
    state = np.random.SeedSequence([NAMESPACE, seed, spread]).generate_state(1, np.uint64)
    return int(state[0]) >> 2 | 1 << 62


def generator(seed: int, *words: str | int) -> np.random.Generator:
    """A random generator for one purpose; see `child_seed`."""
    return np.random.default_rng(child_seed(seed, *words))
