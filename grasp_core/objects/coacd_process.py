"""CoACD in a process of its own, with a fixed seed on one thread, ended at a limit of processor time."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

SETTINGS: dict[str, dict[str, float | int]] = {
    "coacd": {"resolution": 400, "mcts_nodes": 8, "mcts_iterations": 20, "mcts_max_depth": 2, "preprocess": 60},
    "coacd, coarse": {"resolution": 300, "mcts_nodes": 5, "mcts_iterations": 10, "mcts_max_depth": 1, "preprocess": 30},
}
"""CoACD's search, tried in this order: less effort when the first takes too long."""

CONCAVITY = 0.03
"""Concavity that CoACD lets be, in units of the mesh's longest side."""

PATIENCE = 6.0
"""A busy machine may take so many times longer, by the clock, than the processor time that is allowed."""


def run_coacd(
    vertices: NDArray, faces: NDArray, preprocess: str, settings: str, max_parts: int, timeout_s: float
) -> tuple[list[NDArray[np.float64]], str]:
    """Hull points (N, 3) of CoACD's parts, or an empty list and the reason.

    Args:
        vertices: (V, 3), the longest side about 1.
        faces: (F, 3).
        preprocess: "on" rebuilds the surface first (open meshes), "off" takes it as it is (closed ones).
        settings: a key of `SETTINGS`.
        max_parts: at most so many parts.
        timeout_s: processor time after which the process is ended, seconds.
    """
    with tempfile.TemporaryDirectory(prefix="grasp-parts-") as folder:
        given, made = Path(folder) / "mesh.npz", Path(folder) / "parts.npz"
        np.savez(given, vertices=vertices, faces=faces)
        command = [sys.executable, "-m", "grasp_core.objects.coacd_process", str(given), str(made)]
        command += [preprocess, settings, str(max_parts), str(timeout_s)]
        paths = os.pathsep.join(path for path in sys.path if path)
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONPATH": paths}
        try:
            done = subprocess.run(
                command, env=environment, capture_output=True, timeout=PATIENCE * timeout_s, check=False
            )
        except subprocess.TimeoutExpired:
            return [], f"CoACD took longer than {timeout_s:g} s"
        if -done.returncode in (getattr(signal, "SIGXCPU", None), signal.SIGKILL if os.name == "posix" else None):
            return [], f"CoACD took longer than {timeout_s:g} s"
        if done.returncode or not made.is_file():
            return [], f"CoACD failed (status {done.returncode})"
        with np.load(made) as found:
            return [found[name] for name in sorted(found.files)], ""


def _child(given: str, made: str, preprocess: str, settings: str, max_parts: str, timeout_s: str) -> None:
    """What runs in CoACD's own process; it ends itself at its limit, also when its parent is gone."""
    try:
        import resource

        limit = math.ceil(float(timeout_s))
        resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5))
    except ImportError:  # not on Windows, where the parent's clock must do
        pass
    import coacd

    coacd.set_log_level("error")
    search = dict(SETTINGS[settings])
    with np.load(given) as mesh:
        found = coacd.run_coacd(
            coacd.Mesh(mesh["vertices"], mesh["faces"]),
            threshold=CONCAVITY,
            max_convex_hull=int(max_parts),
            preprocess_mode=preprocess,
            preprocess_resolution=search.pop("preprocess"),
            seed=0,
            **search,
        )
    np.savez(made, **{f"{i:03d}": np.asarray(vertices) for i, (vertices, _) in enumerate(found)})  # type: ignore[arg-type]


if __name__ == "__main__":
    _child(*sys.argv[1:])
