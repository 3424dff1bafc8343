"""The app: server, worker, views and sessions, and the one thread on which all states move."""

from __future__ import annotations

import json
import logging
import threading
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import viser

from grasp_core.gripper import load_gripper
from grasp_core.objects.parametric import FAMILIES
from grasp_core.simulation.physics import load_physics
from workbench import actions as a
from workbench.curate.view import Curation
from workbench.inspector.desk import Desk
from workbench.inspector.orders import Catalogue, SceneRequest
from workbench.inspector.view import Inspector
from workbench.inspector.worker import scenes
from workbench.jobs import Jobs
from workbench.ledger import Ledger, default_dataset
from workbench.screen import Screen
from workbench.serving import is_loopback, serve
from workbench.session import Session, Sessions
from workbench.state import Shell

log = logging.getLogger("workbench")

FIRST = SceneRequest()
"""What a new browser opens on."""
_MOST_KEPT = 20_000
"""Characters that a browser may have kept for its return."""


class Workbench:
    """A running workbench; `close` ends it.

    Args:
        host: address to bind.
        port: wanted port; it moves up when it is busy, 0 lets the system choose.
        dataset: folder that verdicts go to; None: the user's own.
        first: what a new browser opens on.

    Attributes:
        url: the address to open, with the port that it really got.
        dataset: folder that verdicts go to.
    """

    def __init__(
        self, host: str = "127.0.0.1", port: int = 8080, dataset: Path | None = None, first: SceneRequest = FIRST
    ) -> None:
        self._woken = threading.Event()
        self._closing = False
        self._attached: dict[int, Session] = {}
        self._planning = Jobs("planning", scenes.prepare, self._worker_lost)
        self._physics = Jobs("physics", scenes.prepare, self._worker_lost)
        try:
            gripper, physics = load_gripper(), load_physics()
            self.dataset = (dataset or default_dataset(gripper, physics)).expanduser().resolve()
            self._ledger = Ledger(self.dataset, gripper, physics)
            self._ledger.check()
            self._desk = Desk(self._planning, self._physics, self._ledger, first)
            self._curation = Curation(self._physics, self.dataset, gripper, sample=dataset is None)
            told = str(self.dataset).replace(str(Path.home()), "~", 1)
            catalogue = Catalogue(tuple(sorted(FAMILIES)), told, is_loopback(host))
            self._shell = Shell([Inspector(self._desk, catalogue, first), self._curation])
            self._sessions = Sessions(self._shell, self._woken.set)
            self._server, self.url = serve(host, port)
        except BaseException:
            self._planning.close()
            self._physics.close()
            raise
        self._server.initial_camera.position = (0.5, -0.98, 0.76)
        self._server.initial_camera.look_at = (0.0, 0.0, 0.34)
        self._server.initial_camera.fov = 0.72
        self._server.on_client_connect(self._connect)
        self._server.on_client_disconnect(self._disconnect)
        self._thread = threading.Thread(target=self._run, daemon=True, name="workbench-tick")
        self._thread.start()

    def close(self) -> None:
        """End server, worker and threads; verdicts under way are stored first."""
        self._closing = True
        self._woken.set()
        self._thread.join(5.0)
        self._server.stop()
        self._ledger.thread.shutdown(wait=True)
        self._curation.close()
        self._planning.close()
        self._physics.close()
        self._desk.close()

    def _connect(self, client: viser.ClientHandle) -> None:
        try:
            session, new = self._sessions.claim(_stored(client, "session"), _kept(_stored(client, "kept")))
            if new:
                client.local_storage.set_item("session", session.token)
            self._attached[client.client_id] = session
            session.attach(Screen(client, session.post, self._shell, session.state))
            if client.client_id not in self._server.get_clients():
                self._disconnect(client)  # it left while its screen was made
        except Exception:
            log.exception("a browser could not be served")
            self._disconnect(client)

    def _disconnect(self, client: viser.ClientHandle) -> None:
        session = self._attached.pop(client.client_id, None)
        if session is not None:
            session.attach(None)

    def _worker_lost(self, text: str) -> None:
        for session in self._sessions.all():
            session.post(a.Notice("warning", "Worker replaced", text))

    def _run(self) -> None:
        due: float | None = None
        while not self._closing:
            self._woken.wait(None if due is None else max(0.0, due - time.monotonic()))
            self._woken.clear()
            due = None
            for session in self._sessions.all():
                try:
                    effects, again = session.step(time.monotonic())
                    for effect in effects:
                        self._perform(session, effect)
                    session.show()
                except Exception as error:
                    log.exception("a step failed")
                    session.post(a.Notice("error", "Something went wrong here", f"{type(error).__name__}: {error}"))
                    continue
                if again is not None:
                    due = again if due is None else min(due, again)

    def _perform(self, session: Session, effect: a.Effect) -> None:
        if isinstance(effect, a.Notice | a.Download | a.ShowKeys):
            log.info("nobody is there to take %s", type(effect).__name__)
        elif not any(view.perform(session.post, effect) for view in self._shell.views.values()):
            raise TypeError(f"nobody does {type(effect).__name__}")


def _stored(client: viser.ClientHandle, key: str) -> str | None:
    """What the browser keeps under a key; None where its storage is blocked: it then starts anew with each load."""
    try:
        return client.local_storage.get_item(key, timeout=3.0)
    except (RuntimeError, TimeoutError):
        return None


def _kept(value: str | None) -> Mapping[str, Any]:
    """What a browser kept, if it is JSON of a sane size."""
    if not isinstance(value, str) or len(value) > _MOST_KEPT:
        return {}
    try:
        kept = json.loads(value)
    except ValueError:
        return {}
    return kept if isinstance(kept, dict) else {}
