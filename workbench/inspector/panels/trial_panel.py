"""The panel of the trial: what physics said of the selected candidate, its replay, and the person's verdict."""

from __future__ import annotations

import math

import msgspec

from grasp_core.planning.planner import needs_networks
from grasp_core.simulation.evidence import Evidence, millimetres
from workbench import colours
from workbench.bridge import Bridge, Reader
from workbench.casting import brief, put, sentence, text
from workbench.inspector import actions as a
from workbench.inspector.orders import Choice, Judgement, Try
from workbench.inspector.rules.replay import SPEEDS
from workbench.inspector.rules.trials import storable
from workbench.inspector.state import State

_TO_START = (
    '<svg width="11" height="11" viewBox="0 0 11 11" fill="currentColor"><path d="M1 1h2v9H1zM10 1v9L4 5.5z"/></svg>'
)
_JUDGEMENTS: dict[str, Judgement] = {"good": "good", "bad": "bad"}


def _judge(argument: str) -> a.Judge:
    if argument not in _JUDGEMENTS:
        raise ValueError(argument)
    return a.Judge(_JUDGEMENTS[argument])


READERS: dict[str, Reader] = {
    "attempt": lambda argument: a.ReplayAttempt(int(argument)),
    "toggle": lambda argument: a.TogglePlay(),
    "restart": lambda argument: a.Seek(0.0),
    "step": lambda argument: a.Step(max(-30, min(30, int(argument)))),
    "speed": lambda argument: a.Speed(float(argument)),
    "loop": lambda argument: a.ToggleLoop(),
    "pin": lambda argument: a.Pin(),
    "save": lambda argument: a.SaveReplay(),
    "judge": _judge,
}


def _colour(outcome: str) -> str:
    return colours.css(colours.OUTCOMES.get(outcome, colours.UNKNOWN))


def evidence(attempt: Try) -> str:
    """What stands behind an outcome, in short lines; HTML."""
    if attempt.evidence is None:
        return "<small>settled by the height map: the physics engine was not needed</small>"
    found = msgspec.json.decode(attempt.evidence, type=Evidence)
    parts = [f"lift {millimetres(found.lift)}"]
    if attempt.moved is not None:
        parts.append(f"moved in the grip {millimetres(attempt.moved[0])}, {math.degrees(attempt.moved[1]):.0f}°")
    for name, contact in (("left", found.left), ("right", found.right)):
        if contact is not None:
            parts.append(f"{name} finger: {contact.kind}, {contact.force:.0f} N")
    if found.clearance is not None:
        height = f"{millimetres(found.clearance)} above" if found.clearance >= 0.001 else "on"
        parts.append(f"{height} the table at the end")
    return f"<small>{text(' · '.join(parts))}</small>"


def chips(state: State, bridge: Bridge) -> str:
    """One button an attempt; HTML."""
    shown = None if state.playback is None else state.playback.attempt.number
    made = []
    for number in range(state.setup.attempts):
        known = state.trial.attempts.get(number)
        back = "var(--gw-unknown)" if known is None else _colour(known.outcome)
        hint = f"attempt {number + 1}: " + ("not known yet" if known is None else f"{known.outcome}, replay it")
        made.append(
            bridge.button(
                str(number + 1),
                f"attempt:{number}",
                hint=hint,
                look="gw-try gw-on" if number == shown else "gw-try",
                style=f"background:{back}",
                more=f'data-attempt="{number}"',
            )
        )
    return "".join(made)


def against(state: State) -> str:
    """Successes / attempts beside the predicted score; HTML."""
    trial, candidate = state.trial, state.candidate
    if not trial.complete or candidate is None:
        return '<i class="gw-spin"></i>'
    said = "predicted" if needs_networks(state.setup.planners[state.side]) else "score"
    return (
        f'<b data-successes="{trial.successes}">{trial.successes} / {len(trial.attempts)}</b> succeeded'
        f"<small>, {said} {candidate.score:.2f}</small>"
    )


def verdict_of_physics(state: State, bridge: Bridge) -> str:
    """What happened in the attempt that is shown and in the others; HTML."""
    if state.choice is None:
        return '<div class="gw-empty">No candidate to try.</div>'
    if state.scene is not None and not state.scene.scene.objects:
        return '<div class="gw-empty">An own image shows no objects that physics could try.</div>'
    trial, playback, setup = state.trial, state.playback, state.setup
    chosen = state.choice
    go = bridge.button(f"Try candidate {chosen.index + 1}", f"select:{chosen.side}.{chosen.index}", look="gw-main")
    go = f'<div class="gw-bar gw-below">{go}</div>'
    if trial.failed is not None:
        return f'<div class="gw-error">{text(brief(sentence(trial.failed)))}</div>{go}'
    busy = trial.running or state.waiting is not None
    noise = f"σ_p {1000 * setup.sigma_p:g} mm, σ_φ {setup.sigma_phi:g}°"
    if playback is None and not busy:
        known = f'<div class="gw-tries"><span>{against(state)}</span></div>' if trial.complete else ""
        return (
            f'<div class="gw-empty">Click a candidate (list, image or scene) to try it in physics: × {setup.attempts}'
            f" with noise ({noise}), the first one replayed here.{known}{go}</div>"
        )
    if playback is None:
        return (
            f'<div class="gw-words"><span class="gw-spin"></span>Candidate {state.choice.index + 1} is being tried …'
            "</div>"
        )
    shown = playback.attempt
    words = ""
    if state.pinned is None or state.pinned.attempt is shown:  # else they stand in the comparison below
        words = f'<div class="gw-words" data-words="1">{text(sentence(shown.words))}<br>{evidence(shown)}</div>'
    return (
        f'<span class="gw-badge" data-outcome="{text(shown.outcome)}" style="background:{_colour(shown.outcome)}">'
        f"{text(shown.outcome)}</span> <small>attempt {shown.number + 1} of candidate {state.choice.index + 1}</small>"
        f"{words}"
        f'<div class="gw-tries" title="{setup.attempts} attempts with noise: {noise}">{chips(state, bridge)}'
        f"<span>{against(state)}</span></div>"
    )


def compared(state: State) -> str:
    """The pinned attempt beside the one that is shown; HTML."""
    pinned, playback = state.pinned, state.playback
    if pinned is None:
        return ""

    def column(name: str, choice: Choice, score: float | None, attempt: Try) -> str:
        predicted = "" if score is None else f", score {score:.2f}"
        return (
            f"<div><h4>{name}: candidate {choice.index + 1}, attempt {attempt.number + 1}{predicted}</h4><span "
            f'class="gw-badge" style="background:{_colour(attempt.outcome)}">{text(attempt.outcome)}</span> '
            f"{text(sentence(attempt.words))}<br>{evidence(attempt)}</div>"
        )

    second = '<div><div class="gw-empty">Click another candidate or attempt to compare.</div></div>'
    if playback is not None and playback.attempt is not pinned.attempt:
        score = None if state.candidate is None else state.candidate.score
        second = column("B", playback.choice, score, playback.attempt)
    first = column("A (pale)", pinned.choice, pinned.score, pinned.attempt)
    return f'<div class="gw-compare" data-compare="1">{first}{second}</div>'


def player(state: State, bridge: Bridge) -> str:
    """Play, pause, steps, speed, loop, compare and save; HTML."""
    playback = state.playback
    off = playback is None
    playing = playback is not None and playback.playing
    moves = (
        bridge.button(_TO_START, "restart:", hint="to the start", off=off),
        bridge.button("‹", "step:-1", hint="one frame back (N)", off=off),
        bridge.button(
            "❚❚ Pause" if playing else "▶ Play",
            "toggle:",
            hint="the replay (T)",
            look="gw-main",
            style="flex-grow:3",
            off=off,
            more=f'data-playing="{str(playing).lower()}"',
        ),
        bridge.button("›", "step:1", hint="one frame on (M)", off=off),
        bridge.button(
            "loop", "loop:", hint="start over at the end", look="gw-on" if state.loop else "",
            more=f'aria-pressed="{str(state.loop).lower()}"',
        ),
    )  # fmt: skip
    speeds = "".join(
        f'<option value="{factor:g}"{" selected" if factor == state.speed else ""}>{factor:g}×</option>'
        for factor in SPEEDS
    )
    speed = f'<select aria-label="speed" title="times real time" {bridge.onchoice("speed")}>{speeds}</select>'
    pinned = state.pinned is not None and playback is not None and state.pinned.attempt is playback.attempt
    label = "Unpin A" if pinned else "Pin as A" if state.pinned is None else "Pin as A instead"
    pin = bridge.button(label, "pin:", hint="keep this attempt to compare another one with it (C)", off=off)
    saving = '<span class="gw-spin"></span>' if state.saving else ""
    save = bridge.button(
        f"{saving}Save as HTML", "save:", hint="the replay as one file that opens anywhere", off=off or state.saving
    )
    return (
        f'<div class="gw-bar gw-small">{"".join(moves)}{speed}</div>'
        f'<div class="gw-bar gw-small gw-below">{pin}{save}</div>'
    )


def verdict(state: State, bridge: Bridge) -> str:
    """The person's verdict on the selected candidate; HTML."""
    dataset = state.catalogue.dataset
    given = None if state.choice is None else state.verdicts.get(state.choice)
    fits = storable(state)
    off = state.choice is None or state.judging or state.trial.running or not fits

    def button(kind: Judgement, label: str) -> str:
        look = f"gw-{kind} gw-on" if given == kind else f"gw-{kind}"
        return bridge.button(label, f"judge:{kind}", hint=f"store your verdict ({kind[0].upper()})", look=look, off=off)

    told = f"goes to {text(dataset)}"
    if state.judging:
        told = '<span class="gw-spin"></span>storing …'
    elif given is not None:
        told = f'<span data-stored="{given}">Stored as {given}</span> in {text(dataset)}'
    elif state.scene is not None and not fits:
        told = "Verdicts are stored for scenes of one object at rest."
    which = "" if state.choice is None else f"<span>candidate {state.choice.index + 1}</span>"
    buttons = button("good", "✓ Good grasp") + button("bad", "✗ Bad grasp")
    return (
        f'<h3>Your verdict {which}</h3><div class="gw-bar">{buttons}</div>'
        f'<div class="gw-stored"><small>{told}</small></div>'
    )


class TrialPanel:
    """Outcome, player and verdict."""

    def __init__(self, bridge: Bridge) -> None:
        self._bridge = bridge
        self._said = bridge.html()
        self._time = bridge.slider("Time s", 0.0, 1.0, 0.01, 0.0, a.Seek, "Where the replay stands, seconds")
        self._player = bridge.html()
        self._compared = bridge.html()
        self._verdict = bridge.html()
        bridge.command("Play or pause", "T", a.TogglePlay, "The replay of the trial")
        bridge.command("One frame on", "M", lambda: a.Step(1), "Step the replay forwards")
        bridge.command("One frame back", "N", lambda: a.Step(-1), "Step the replay backwards")
        bridge.command("Loop the replay", None, a.ToggleLoop, "Start over at the end, or not")
        bridge.command("Pin to compare", "C", a.Pin, "Keep this attempt and compare another one with it")
        bridge.command("Save the replay as HTML", None, a.SaveReplay, "One file that opens anywhere")
        bridge.command("Good grasp", "G", lambda: a.Judge("good"), "Store a verdict on the selected candidate")
        bridge.command("Bad grasp", "B", lambda: a.Judge("bad"), "Store a verdict on the selected candidate")
        bridge.command("Try the best candidate", "F", lambda: a.Select(Choice(0, 0)), "Run its DART trial")
        bridge.command("Try the next candidate", "J", lambda: a.SelectNext(1), "Down the list")
        bridge.command("Try the previous candidate", "K", lambda: a.SelectNext(-1), "Up the list")
        self._sent = -1.0

    def update(self, old: State | None, new: State) -> None:
        """Show `new`; while a replay runs, only the time moves."""
        said = verdict_of_physics(new, self._bridge)
        put(self._said, content=f'<div class="gw" data-trial="1"><h3>Trial in DART</h3>{said}</div>')
        put(self._player, content=f'<div class="gw">{player(new, self._bridge)}</div>')
        put(self._compared, content=f'<div class="gw">{compared(new)}</div>' if new.pinned else "")
        self._show_time(new)
        put(self._verdict, content=f'<div class="gw">{verdict(new, self._bridge)}</div>')

    def _show_time(self, state: State) -> None:
        playback = state.playback
        put(self._time, disabled=playback is None)
        if playback is None:
            put(self._time, value=0.0)
            return
        put(self._time, max=max(0.01, round(playback.duration, 2)))
        # The page is sent the time less often than the frames: the slider costs more than the scene.
        if not playback.playing or abs(playback.position - self._sent) >= 0.1:
            self._sent = playback.position
            put(self._time, value=round(min(playback.position, self._time.max), 2))
