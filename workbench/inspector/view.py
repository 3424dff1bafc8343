"""The inspector as a view of the workbench."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from typing import Any

import viser

from grasp_core.errors import GraspError
from workbench.actions import Action, Effect
from workbench.bridge import Bridge, Reader
from workbench.inspector import actions as a
from workbench.inspector import workshop
from workbench.inspector.orders import Catalogue, SceneRequest
from workbench.inspector.panels import candidates_panel, scene_panel, trial_panel
from workbench.inspector.panels.candidates_panel import CandidatesPanel
from workbench.inspector.panels.images_panel import ImagesPanel
from workbench.inspector.panels.scene_panel import ScenePanel
from workbench.inspector.panels.trial_panel import TrialPanel
from workbench.inspector.reducers import reduce
from workbench.inspector.scene3d import Scene3d
from workbench.inspector.scenes import Scenes
from workbench.inspector.state import State
from workbench.jobs import Jobs
from workbench.ledger import Ledger
from workbench.view import Part, Post

log = logging.getLogger("workbench")

READERS: dict[str, Reader] = {**scene_panel.READERS, **candidates_panel.READERS, **trial_panel.READERS}
RIGHT = 348
"""Width of the right column, pixels."""


class Inspector:
    """See `View`."""

    name = "inspect"
    label = "Inspect"
    actions: type[Action] = a.InspectorAction
    readers: Mapping[str, Reader] = READERS

    def __init__(self, jobs: Jobs, ledger: Ledger, catalogue: Catalogue, first: SceneRequest) -> None:
        self._jobs = jobs
        self._ledger = ledger
        self._catalogue = catalogue
        self._first = first
        self._scenes = Scenes(jobs)
        # The first scene is under way before anything else is: it is what a new browser waits for.
        self._scenes.open(first, lambda scene: None, lambda why: log.warning("the first scene failed: %s", why))

    def first(self, kept: Mapping[str, Any]) -> State:
        """See `View`."""
        return State(self._catalogue, self._first)

    def arrive(self, state: State, query: Mapping[str, str], shown: bool) -> tuple[State, tuple[Effect, ...]]:
        """See `View`."""
        if state.scene is not None:
            return state, ()
        return state, (a.OpenScene(state.ticket, state.request),)

    def reduce(self, state: State, action: Action) -> tuple[State, tuple[Effect, ...]]:
        """See `View`."""
        return reduce(state, action)

    def ticking(self, state: State) -> bool:
        """See `View`."""
        return state.playback is not None and state.playback.playing

    def link(self, state: State) -> Mapping[str, str]:
        """See `View`."""
        return {}

    def keep(self, state: State) -> Mapping[str, Any]:
        """See `View`."""
        return {}

    def show(self, bridge: Bridge, state: State) -> Part:
        """See `View`."""
        return _Inspection(bridge, self._catalogue, state, str(self._ledger.path))

    def perform(self, post: Post, effect: Effect) -> bool:
        """See `View`."""
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
                    self._catalogue.attempts,
                )
            case a.StoreVerdict():
                self._ledger.thread.submit(self._store, post, effect)
            case _:
                return False
        return True

    def _store(self, post: Post, effect: a.StoreVerdict) -> None:
        ticket, index = effect.ticket, effect.index
        try:
            event = self._ledger.record(effect.scene, index, effect.judgement, effect.attempts)
        except GraspError as error:
            post(a.JudgeFailed(ticket, index, str(error)))
        except Exception as error:
            log.exception("a verdict could not be stored")
            post(a.JudgeFailed(ticket, index, f"{type(error).__name__}: {error}"))
        else:
            post(a.Judged(ticket, index, effect.judgement, event.id))


class _Inspection:
    def __init__(self, bridge: Bridge, catalogue: Catalogue, state: State, dataset: str) -> None:
        self._parts: list[Part] = [ScenePanel(bridge, catalogue, state), ImagesPanel(bridge, catalogue.gripper)]
        with bridge.panel([("Grasps", viser.Icon.HAND_GRAB)], RIGHT) as (grasps,), grasps:
            self._parts += [CandidatesPanel(bridge), TrialPanel(bridge, catalogue.attempts, dataset)]
        self._parts.append(Scene3d(bridge, catalogue.gripper))

    def update(self, old: State | None, new: State) -> None:
        for part in self._parts:
            part.update(old, new)
