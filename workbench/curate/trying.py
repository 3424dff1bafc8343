"""Rules of physics: verifying, replaying, and rectangles that become new grasps."""

from __future__ import annotations

import math
from dataclasses import replace

from grasp_core.dataset.rectangle import edited
from grasp_core.errors import GraspError
from grasp_core.grasp import to_image
from grasp_core.gripper import Gripper
from grasp_core.planning.crops import DepthRule
from workbench.actions import Action, Notice, Tick
from workbench.curate import actions as a
from workbench.curate import effects as e
from workbench.curate.registry import Result, apply, nameless, rule
from workbench.curate.state import Playing, State


@rule(a.Verify)
def _verify(action: a.Verify, state: State) -> Result:
    if (told := nameless(state)) is not None:
        return told
    shown = None if state.sample is None else state.sample.row.id
    grasp = shown if action.grasp is None else action.grasp
    if grasp is None or state.busy:
        return state, ()
    wanted = e.TryMore(grasp, max(1, min(action.attempts, 50)), state.person)
    return replace(state, busy="verifying in DART"), (wanted,)


@rule(a.ReplayAttempt)
def _replay(action: a.ReplayAttempt, state: State) -> Result:
    if state.sample is None or state.busy or not 0 <= action.number < len(state.sample.attempts):
        return state, ()
    playing = state.playing
    if playing is not None and playing.played.number == action.number:
        return replace(state, playing=Playing(playing.grasp, playing.played)), ()
    return replace(state, busy="replaying", edited=None), (e.PlayAttempt(state.sample.row.id, action.number),)


@rule(a.ReplayShown)
def _replay_shown(action: a.ReplayShown, state: State) -> Result:
    state = replace(state, busy="")
    if state.sample is None or state.sample.row.id != action.grasp:
        return state, ()
    return replace(state, playing=Playing(action.grasp, action.played)), ()


@rule(a.TogglePlay)
def _toggle_play(action: a.TogglePlay, state: State) -> Result:
    return (state if state.playing is None else replace(state, playing=state.playing.toggled())), ()


@rule(a.Seek)
def _seek(action: a.Seek, state: State) -> Result:
    return (state if state.playing is None else replace(state, playing=state.playing.sought(action.time))), ()


@rule(Tick)
def _tick(action: Tick, state: State) -> Result:
    if state.playing is None or not state.playing.playing:
        return state, ()
    return replace(state, playing=state.playing.ticked(action.now)), ()


@rule(a.EndEdit)
def _end_edit(action: a.EndEdit, state: State) -> Result:
    if state.edited is None or state.sample is None or not action.store:
        return replace(state, edited=None), ()
    if (told := nameless(state)) is not None:
        return told
    attempts = 5 if action.verify else 0
    stored = e.StoreGrasp(state.sample.row.id, state.edited, state.person, attempts)
    return replace(state, edited=None, busy="verifying in DART" if attempts else state.busy), (stored,)


class Rules:
    """How actions change states, with the gripper and depth rule that edited rectangles follow."""

    def __init__(self, gripper: Gripper, depth: DepthRule) -> None:
        self.gripper = gripper
        self.depth = depth

    def reduce(self, state: State, action: Action) -> Result:
        """The next state and what has to be done; answers that no longer fit change nothing."""
        if isinstance(action, a.Edit | a.DragEnd):
            return self._edit(state, action)
        return apply(action, state)

    def _edit(self, state: State, action: a.Edit | a.DragEnd) -> Result:
        sample = state.sample
        if sample is None or state.review is not None:
            return state, ()
        before = state.edited or sample.row.grasp
        if isinstance(action, a.DragEnd):
            shown = to_image(before, sample.image.camera)
            along, down = action.u - shown.u, action.v - shown.v
            if math.hypot(along, down) < 2:
                return state, ()
            widen = 2 * math.hypot(along, down) / shown.width
            action = a.Edit(turn=math.atan2(-down, along) - shown.angle, widen=widen)
        try:
            changed = edited(
                sample.image,
                before,
                right=action.right,
                down=action.down,
                turn=action.turn,
                widen=action.widen,
                opening=self.gripper.opening,
                rule=self.depth,
            )
        except GraspError as error:
            return state, (Notice("info", "Not that far", str(error)),)
        return replace(state, edited=changed, playing=None), ()
