"""The panel of the trial: what physics said of the selected candidate, its replay, and the person's verdict."""

from __future__ import annotations

from workbench import colours
from workbench.bridge import Bridge, Reader
from workbench.casting import put, sentence, text
from workbench.inspector.actions import Judge, ReplayAttempt, Seek, Select, SelectNext, Speed, Step, TogglePlay
from workbench.inspector.orders import Judgement
from workbench.inspector.reducers import SPEEDS
from workbench.inspector.state import State

_TO_START = (
    '<svg width="11" height="11" viewBox="0 0 11 11" fill="currentColor"><path d="M1 1h2v9H1zM10 1v9L4 5.5z"/></svg>'
)
_JUDGEMENTS: dict[str, Judgement] = {"good": "good", "bad": "bad"}


def _judge(argument: str) -> Judge:
    if argument not in _JUDGEMENTS:
        raise ValueError(argument)
    return Judge(_JUDGEMENTS[argument])


READERS: dict[str, Reader] = {
    "attempt": lambda argument: ReplayAttempt(int(argument)),
    "toggle": lambda argument: TogglePlay(),
    "restart": lambda argument: Seek(0.0),
    "step": lambda argument: Step(max(-30, min(30, int(argument)))),
    "speed": lambda argument: Speed(float(argument)),
    "judge": _judge,
}


def verdict_of_physics(state: State, attempts: int, bridge: Bridge) -> str:
    """What happened in the attempt that is shown and in the others; HTML."""
    if state.selected is None:
        return '<div class="gw-empty">No candidate to try.</div>'
    trial, playback = state.trial, state.playback
    if trial.failed is not None:
        return f'<div class="gw-error">{text(sentence(trial.failed))}</div>'
    busy = trial.running or state.waiting is not None
    if playback is None and not busy:
        chosen = state.selected
        go = bridge.button(f"Try candidate {chosen + 1}", f"select:{chosen}", look="gw-main")
        return (
            f'<div class="gw-empty">Click a candidate (list, image or scene) to try it in physics: {attempts} attempts'
            f' with placement noise, the first one replayed here.<div class="gw-bar gw-below">{go}</div></div>'
        )
    if playback is None:
        return (
            f'<div class="gw-words"><span class="gw-spin"></span>Candidate {state.selected + 1} is being tried …</div>'
        )
    shown = playback.attempt
    colour = colours.css(colours.OUTCOMES.get(shown.outcome, (150, 150, 150)))
    chips = []
    for number in range(attempts):
        known = trial.attempts.get(number)
        back = "#39414c" if known is None else colours.css(colours.OUTCOMES.get(known.outcome, (150, 150, 150)))
        hint = f"attempt {number + 1}: " + ("not known yet" if known is None else f"{known.outcome}, replay it")
        chips.append(
            bridge.button(
                str(number + 1),
                f"attempt:{number}",
                hint=hint,
                look="gw-try gw-on" if number == shown.number else "gw-try",
                style=f"background:{back}",
                more=f'data-attempt="{number}"',
            )
        )
    said = f"{trial.successes} / {len(trial.attempts)} succeeded" if trial.complete else '<i class="gw-spin"></i>'
    return (
        f'<span class="gw-badge" data-outcome="{text(shown.outcome)}" style="background:{colour}">{text(shown.outcome)}'
        f"</span> <small>attempt {shown.number + 1} of candidate {state.selected + 1}</small>"
        f'<div class="gw-words" data-words="1">{text(sentence(shown.words))}</div>'
        f'<div class="gw-tries"><small>attempts</small>{"".join(chips)}<span>{said}</span></div>'
    )


def player(state: State, bridge: Bridge) -> str:
    """Play, pause, steps and speed; HTML."""
    playback = state.playback
    off = playback is None
    playing = playback is not None and playback.playing
    moves = (
        bridge.button(_TO_START, "restart:", hint="to the start", off=off),
        bridge.button("‹", "step:-1", hint="one frame back", off=off),
        bridge.button(
            "❚❚ Pause" if playing else "▶ Play",
            "toggle:",
            hint="the replay (T)",
            look="gw-main",
            style="flex-grow:3",
            off=off,
            more=f'data-playing="{str(playing).lower()}"',
        ),
        bridge.button("›", "step:1", hint="one frame on", off=off),
    )
    speeds = (
        bridge.button(
            f"{factor:g}×",
            f"speed:{factor:g}",
            hint=f"{factor:g} times real time",
            look="gw-on" if state.speed == factor else "",
        )
        for factor in SPEEDS
    )
    return f'<div class="gw-bar">{"".join(moves)}</div><div class="gw-bar gw-below">{"".join(speeds)}</div>'


def verdict(state: State, dataset: str, bridge: Bridge) -> str:
    """The person's verdict on the selected candidate; HTML."""
    given = None if state.selected is None else state.verdicts.get(state.selected)
    off = state.selected is None or state.judging or state.trial.running

    def button(kind: Judgement, label: str) -> str:
        look = f"gw-{kind} gw-on" if given == kind else f"gw-{kind}"
        return bridge.button(label, f"judge:{kind}", hint=f"store your verdict ({kind[0].upper()})", look=look, off=off)

    told = f"goes to {text(dataset)}"
    if state.judging:
        told = '<span class="gw-spin"></span>storing …'
    elif given is not None:
        told = f'<span data-stored="{given}">Stored as {given}</span> in {text(dataset)}'
    which = "" if state.selected is None else f"<span>candidate {state.selected + 1}</span>"
    buttons = button("good", "✓ Good grasp") + button("bad", "✗ Bad grasp")
    return (
        f'<h3>Your verdict {which}</h3><div class="gw-bar">{buttons}</div>'
        f'<div class="gw-stored"><small>{told}</small></div>'
    )


class TrialPanel:
    """Outcome, player and verdict."""

    def __init__(self, bridge: Bridge, attempts: int, dataset: str) -> None:
        self._bridge = bridge
        self._attempts = attempts
        self._dataset = dataset
        self._said = bridge.html()
        self._player = bridge.html()
        self._time = bridge.slider("Time s", 0.0, 1.0, 0.01, 0.0, Seek, "Where the replay stands, seconds")
        self._verdict = bridge.html()
        bridge.command("Play or pause", "T", TogglePlay, "The replay of the trial")
        bridge.command("Good grasp", "G", lambda: Judge("good"), "Store a verdict on the selected candidate")
        bridge.command("Bad grasp", "B", lambda: Judge("bad"), "Store a verdict on the selected candidate")
        bridge.command("Try the best candidate", "F", lambda: Select(0), "Run its DART trial")
        bridge.command("Try the next candidate", "J", lambda: SelectNext(1), "Down the list")
        bridge.command("Try the previous candidate", "K", lambda: SelectNext(-1), "Up the list")
        self._sent = -1.0

    def update(self, old: State | None, new: State) -> None:
        """Show `new`; while a replay runs, only the time moves."""
        said = verdict_of_physics(new, self._attempts, self._bridge)
        put(self._said, content=f'<div class="gw" data-trial="1"><h3>Trial in DART</h3>{said}</div>')
        put(self._player, content=f'<div class="gw">{player(new, self._bridge)}</div>')
        self._show_time(new)
        put(self._verdict, content=f'<div class="gw">{verdict(new, self._dataset, self._bridge)}</div>')

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
