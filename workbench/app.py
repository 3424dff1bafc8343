"""The app: server, worker, ledger and sessions, and the one thread on which all states move."""

from __future__ import annotations

import logging
import threading
import time
from pathlib import Path

import viser

from grasp_core import config
from grasp_core.errors import GraspError
from grasp_core.gripper import load_gripper
from grasp_core.objects.parametric import FAMILIES
from grasp_core.simulation.physics import load_physics
from workbench import actions as a
from workbench import workshop
from workbench.jobs import Jobs
from workbench.ledger import Ledger, default_dataset
from workbench.orders import Catalogue, SceneRequest
from workbench.scenes import Scenes
from workbench.screen import Screen
from workbench.serving import serve
from workbench.session import Session, Sessions
from workbench.state import State

log = logging.getLogger("workbench")

ATTEMPTS = 5
"""In a trial (the paper's number)."""
FIRST = SceneRequest(family="toy_plane", shape=0, pose=0, place=1, planner="cascade")
"""What a new browser opens on."""


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
        self._jobs = Jobs(workshop.prepare, self._worker_lost)
        try:
            self._scenes = Scenes(self._jobs)
            # The first scene is under way before anything else is: it is what a new browser waits for.
            self._scenes.open(first, lambda scene: None, lambda why: log.warning("the first scene failed: %s", why))
            gripper = load_gripper()
            planners = tuple(sorted(config.shipped("planners"), key=lambda name: (name != first.planner, name)))
            self._catalogue = Catalogue(tuple(sorted(FAMILIES)), planners, gripper, ATTEMPTS)
            self._sessions = Sessions(lambda: State(self._catalogue, first), self._woken.set)
            physics = load_physics()
            self.dataset = (dataset or default_dataset(gripper, physics)).expanduser().resolve()
            self._ledger = Ledger(self.dataset, gripper, physics)
            self._ledger.check()
            self._server, self.url = serve(host, port)
        except BaseException:
            self._jobs.close()
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
        self._jobs.close()

    def _connect(self, client: viser.ClientHandle) -> None:
        try:
            try:
                token = client.local_storage.get_item("session", timeout=3.0)
            except (RuntimeError, TimeoutError):
                token = None  # its storage is blocked: this browser starts anew with each load
            session, new = self._sessions.claim(token)
            if new:
                client.local_storage.set_item("session", session.token)
            self._attached[client.client_id] = session
            dataset = str(self.dataset).replace(str(Path.home()), "~", 1)
            session.attach(Screen(client, session.post, self._catalogue, session.state, dataset))
            if new:
                self._perform(session, a.OpenScene(session.state.ticket, session.state.request))
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
                except Exception as error:
                    log.exception("a step failed")
                    session.post(a.Notice("error", "Something went wrong here", f"{type(error).__name__}: {error}"))
                    continue
                if again is not None:
                    due = again if due is None else min(due, again)

    def _perform(self, session: Session, effect: a.Effect) -> None:
        post = session.post
        match effect:
            case a.OpenScene(ticket, request):
                self._scenes.open(
                    request, lambda scene: post(a.Opened(ticket, scene)), lambda why: post(a.OpenFailed(ticket, why))
                )
            case a.RecordAttempt(ticket, opened, index, number):
                self._jobs.submit(
                    lambda made: post(a.Replayed(ticket, index, made)),
                    lambda why: post(a.TrialFailed(ticket, index, why)),
                    workshop.record_attempt,
                    opened.scene,
                    opened.plan.candidates[index].grasp,
                    number,
                )
            case a.RunTrial(ticket, opened, index):
                self._jobs.submit(
                    lambda made: post(a.Tried(ticket, index, made)),
                    lambda why: post(a.TrialFailed(ticket, index, why)),
                    workshop.run_trial,
                    opened.scene,
                    opened.plan.candidates[index].grasp,
                    ATTEMPTS,
                )
            case a.StoreVerdict():
                self._ledger.thread.submit(self._store, session, effect)
            case a.Notice(_, title, body):
                log.info("%s: %s", title, body)  # nobody is there to read it
            case _:
                raise TypeError(f"nobody does {type(effect).__name__}")

    def _store(self, session: Session, effect: a.StoreVerdict) -> None:
        ticket, index = effect.ticket, effect.index
        try:
            event = self._ledger.record(effect.scene, index, effect.judgement, effect.attempts)
        except GraspError as error:
            session.post(a.JudgeFailed(ticket, index, str(error)))
        except Exception as error:
            log.exception("a verdict could not be stored")
            session.post(a.JudgeFailed(ticket, index, f"{type(error).__name__}: {error}"))
        else:
            session.post(a.Judged(ticket, index, effect.judgement, event.id))
