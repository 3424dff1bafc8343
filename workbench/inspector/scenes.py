"""Scenes that were made already, and those that are being made: each is made once however many browsers want it."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable

from workbench.inspector import workshop
from workbench.inspector.orders import OpenedScene, SceneRequest
from workbench.jobs import Jobs

MOST = 12
"""Scenes that are remembered."""

Done = Callable[[OpenedScene], None]
Failed = Callable[[str], None]


class Scenes:
    """Opens scenes in the worker.

    Args:
        jobs: the worker.
    """

    def __init__(self, jobs: Jobs) -> None:
        self._jobs = jobs
        self._lock = threading.Lock()
        self._known: OrderedDict[SceneRequest, OpenedScene] = OrderedDict()
        self._waiting: dict[SceneRequest, list[tuple[Done, Failed]]] = {}

    def open(self, request: SceneRequest, done: Done, failed: Failed) -> None:
        """Make a scene, or take it from those remembered; `done` or `failed` may be called from another thread."""
        with self._lock:
            known = self._known.get(request)
            if known is None:
                waiting = self._waiting.setdefault(request, [])
                waiting.append((done, failed))
                first = len(waiting) == 1
        if known is not None:
            done(known)
        elif first:
            self._jobs.submit(
                lambda scene: self._made(request, scene),
                lambda reason: self._failed(request, reason),
                workshop.open_scene,
                request,
            )

    def _made(self, request: SceneRequest, scene: OpenedScene) -> None:
        with self._lock:
            self._known[request] = scene
            while len(self._known) > MOST:
                self._known.popitem(last=False)
            waiting = self._waiting.pop(request, [])
        for done, _ in waiting:
            done(scene)

    def _failed(self, request: SceneRequest, reason: str) -> None:
        with self._lock:
            waiting = self._waiting.pop(request, [])
        for _, failed in waiting:
            failed(reason)
