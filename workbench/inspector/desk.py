"""Does the inspector's effects: hands them to the worker processes and posts what comes back."""

from __future__ import annotations

import logging
import time
from concurrent.futures import ThreadPoolExecutor

from grasp_core.errors import GraspError
from workbench.actions import Effect, Notice
from workbench.inspector import answers as r
from workbench.inspector import effects as e
from workbench.inspector.orders import Item, SceneRequest
from workbench.inspector.scenes import Scenes
from workbench.inspector.setup import DEFAULT
from workbench.inspector.shelf import Shelf
from workbench.inspector.worker import pages, photos, scenes, sights, trials
from workbench.jobs import Jobs
from workbench.ledger import Ledger
from workbench.view import Post

log = logging.getLogger("workbench")


class Desk:
    """Where the inspector's work is done.

    Args:
        planning: the worker that makes scenes and plans.
        physics: the worker that runs DART.
        ledger: takes verdicts.
        first: scene that new browsers open on.
    """

    def __init__(self, planning: Jobs, physics: Jobs, ledger: Ledger, first: SceneRequest) -> None:
        self.shelf = Shelf()
        self._planning = planning
        self._physics = physics
        self._ledger = ledger
        self._scenes = Scenes(planning, lambda: self.shelf.files)
        self._files = ThreadPoolExecutor(1, thread_name_prefix="files")
        # The first scene is under way before anything else is: it is what a new browser waits for.
        self._scenes.open(first, DEFAULT, lambda scene: None, lambda why: log.warning("no first scene: %s", why))

    def close(self) -> None:
        """Remove uploads."""
        self._files.shutdown(wait=True)
        self.shelf.close()

    def perform(self, post: Post, effect: Effect) -> bool:
        """Start doing an effect; False when it belongs to others."""
        match effect:
            case e.OpenScene(ticket, request, setup):
                self._scenes.open(
                    request,
                    setup,
                    lambda scene: post(r.Opened(ticket, scene)),
                    lambda why: post(r.OpenFailed(ticket, why)),
                )
            case e.SeeScene(ticket, request, setup, asked):
                self._planning.submit(
                    lambda sight: post(r.Seen(ticket, request, setup, sight, asked, time.monotonic())),
                    lambda why: post(r.OpenFailed(ticket, why)),
                    sights.see,
                    request,
                    setup,
                    self.shelf.files,
                )
            case e.ScorePlace(ticket, scene, canvas, u, v):
                self._planning.submit(
                    lambda scores: post(r.PlaceScored(ticket, u, v, scores)),
                    lambda why: post(r.PlaceFailed(ticket, why)),
                    sights.ask_place,
                    scene.sight.image,
                    canvas,
                    scene.setup,
                    u,
                    v,
                )
            case e.SettleScene(ticket, request, setup):
                self._physics.submit(
                    lambda rested: post(r.Settled(ticket, rested)),
                    lambda why: post(r.SettleFailed(ticket, why)),
                    scenes.settle_scene,
                    request,
                    setup,
                    self.shelf.files,
                )
            case e.CheckCamera(key):
                self._planning.submit(
                    lambda _: None,
                    lambda why: post(Notice("warning", "This camera file is of no use", why)),
                    photos.check_camera,
                    key,
                    self.shelf.files,
                )
            case e.StoreVerdict():
                self._ledger.thread.submit(self._store, post, effect)
            case e.KeepFile() | e.ReadFolder():
                self._files.submit(self._keep, post, effect)
            case _:
                return self._try(post, effect)
        return True

    def _try(self, post: Post, effect: Effect) -> bool:
        match effect:
            case e.ExpectTrial(ticket, scene, choice):
                self._physics.submit(
                    lambda _: post(r.Expected(ticket, choice)),
                    lambda why: log.info("a trial that was expected failed: %s", why),
                    trials.expect_attempt,
                    scene.scene,
                    scene.setup,
                    scene.grasp(choice),
                )
            case e.RecordAttempt(ticket, scene, choice, number):
                self._physics.submit(
                    lambda made: post(r.Replayed(ticket, choice, made)),
                    lambda why: post(r.TrialFailed(ticket, choice, why)),
                    trials.record_attempt,
                    scene.scene,
                    scene.setup,
                    scene.grasp(choice),
                    number,
                )
            case e.RunTrial(ticket, scene, choice):
                self._physics.submit(
                    lambda made: post(r.Tried(ticket, choice, made)),
                    lambda why: post(r.TrialFailed(ticket, choice, why)),
                    trials.run_trial,
                    scene.scene,
                    scene.setup,
                    scene.grasp(choice),
                )
            case e.WritePage(scene, choice, attempt):
                objects = ", ".join(placed.asset.name for placed in scene.scene.objects)
                title = f"{objects}, candidate {choice.index + 1}, attempt {attempt.number + 1}"
                name = f"{scene.scene.objects[0].asset.name}-{choice.index + 1}-{attempt.number + 1}.html"
                self._physics.submit(
                    lambda content: post(r.ReplaySaved(name, content)),
                    lambda why: post(r.SaveFailed(why)),
                    pages.replay_page,
                    scene.scene,
                    scene.setup,
                    attempt,
                    title,
                )
            case _:
                return False
        return True

    def _store(self, post: Post, effect: e.StoreVerdict) -> None:
        try:
            event = self._ledger.record(effect.scene, effect.choice, effect.judgement, effect.attempts)
        except GraspError as error:
            post(r.JudgeFailed(effect.ticket, str(error)))
        except Exception as error:
            log.exception("a verdict could not be stored")
            post(r.JudgeFailed(effect.ticket, f"{type(error).__name__}: {error}"))
        else:
            post(r.Judged(effect.ticket, effect.choice, effect.judgement, event.id))

    def _keep(self, post: Post, effect: e.KeepFile | e.ReadFolder) -> None:
        try:
            items: tuple[Item, ...]
            if isinstance(effect, e.KeepFile):
                items = (self.shelf.add(effect.kind, effect.name, effect.content, effect.unit),)
            else:
                items = self.shelf.open_folder(effect.kind, effect.folder, effect.unit)
        except (GraspError, OSError) as error:
            post(Notice("warning", "Nothing was opened", str(error)))
        except Exception as error:
            log.exception("a file could not be opened")
            post(Notice("error", "Nothing was opened", f"{type(error).__name__}: {error}"))
        else:
            post(r.FilesKept(items))
