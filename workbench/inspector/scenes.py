"""Scenes that were made already, and those that are being made: each is made once however many browsers want it."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping

from workbench.inspector.orders import OpenedScene, SceneRequest
from workbench.inspector.setup import Setup
from workbench.inspector.worker import sights
from workbench.jobs import Jobs

MOST = 12
"""Scenes that are remembered."""

Done = Callable[[OpenedScene], None]
Failed = Callable[[str], None]


class Scenes:
    """Opens scenes in the worker.

    Args:
        jobs: the worker.
        files: gives the paths of own files.
    """

    def __init__(self, jobs: Jobs, files: Callable[[], Mapping[str, str]]) -> None:
        self._jobs = jobs
        self._files = files
        self._lock = threading.Lock()
        self._known: OrderedDict[tuple[SceneRequest, Setup], OpenedScene] = OrderedDict()
        self._waiting: dict[tuple[SceneRequest, Setup], list[tuple[Done, Failed]]] = {}

    def open(self, request: SceneRequest, setup: Setup, done: Done, failed: Failed) -> None:
        """Make a scene, or take it from those remembered; `done` or `failed` may be called from another thread."""
        key = (request, setup)
        with self._lock:
            known = self._known.get(key)
            if known is None:
                waiting = self._waiting.setdefault(key, [])
                waiting.append((done, failed))
                first = len(waiting) == 1
        if known is not None:
            done(known)
        elif first:
            self._jobs.submit(
                lambda scene: self._made(key, scene),
                lambda reason: self._failed(key, reason),
                sights.open_scene,
                request,
                setup,
                self._files(),
            )

    def _made(self, key: tuple[SceneRequest, Setup], scene: OpenedScene) -> None:
        with self._lock:
            self._known[key] = scene
            while len(self._known) > MOST:
                self._known.popitem(last=False)
            waiting = self._waiting.pop(key, [])
        for done, _ in waiting:
            done(scene)

    def _failed(self, key: tuple[SceneRequest, Setup], reason: str) -> None:
        with self._lock:
            waiting = self._waiting.pop(key, [])
        for _, failed in waiting:
            failed(reason)
