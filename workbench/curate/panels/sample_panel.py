"""The sample: its image, what physics and network say, the decision, the note, and the rectangle's edit."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable

from grasp_core.gripper import Gripper
from workbench import colours
from workbench.actions import Action
from workbench.bridge import Bridge, Reader
from workbench.casting import put, sentence, text
from workbench.curate import actions as a
from workbench.curate.panels.words import decision_words, event_words
from workbench.curate.pictures import sample_svg
from workbench.curate.state import State

DECISIONS: dict[str, float | str] = {
    "good": 1.0, "bad": 0.0, "unsure": "unsure", "exclude": "exclude", "flag": "flag", "unflag": "unflag",
}  # fmt: skip
STEP = 0.1
_TURN = math.radians(5)
EDITS = {
    "4": a.Edit(right=-1), "6": a.Edit(right=1), "8": a.Edit(down=-1), "2": a.Edit(down=1),
    "7": a.Edit(turn=_TURN), "9": a.Edit(turn=-_TURN), "1": a.Edit(widen=0.95), "3": a.Edit(widen=1 / 0.95),
}  # fmt: skip
"""Key of the number pad → change of the rectangle."""
_EDIT_WORDS = {
    "4": "move left", "6": "move right", "8": "move up", "2": "move down",
    "7": "turn left", "9": "turn right", "1": "narrower", "3": "wider",
}  # fmt: skip
_EDIT_SIGNS = {"4": "←", "6": "→", "8": "↑", "2": "↓", "7": "↺", "9": "↻", "1": "→←", "3": "←→"}


def _decide(argument: str) -> a.Decide:
    if argument not in DECISIONS:
        raise ValueError(argument)
    return a.Decide(DECISIONS[argument])


def _drag(argument: str) -> a.Edit:
    right, down = (float(value) for value in argument.split(","))
    return a.Edit(right=right, down=down)


def _end(argument: str) -> a.DragEnd:
    u, v = (float(value) for value in argument.split(","))
    return a.DragEnd(u, v)


READERS: dict[str, Reader] = {
    "cdecide": _decide,
    "cmove": lambda argument: a.Move(1 if int(argument) > 0 else -1),
    "cnudge": lambda argument: a.Nudge(math.copysign(STEP, float(argument))),
    "cnote": lambda argument: a.AddNote(),
    "cverify": lambda argument: a.Verify(int(argument)),
    "creplay": lambda argument: a.ReplayAttempt(int(argument)),
    "cplay": lambda argument: a.TogglePlay(),
    "cundo": lambda argument: a.TakeBack(redo=False),
    "credo": lambda argument: a.TakeBack(redo=True),
    "cedit": lambda argument: EDITS[argument] if argument in EDITS else a.Edit(),
    "cdrag": _drag,
    "cend": _end,
    "cstore": lambda argument: a.EndEdit(store=argument != "no", verify=argument == "verify"),
    "cmine": lambda argument: a.Resolve(argument == "yes"),
    "cretry": lambda argument: a.Retry(),
}


def trouble(state: State, bridge: Bridge) -> str:
    """What needs an answer before anything else: a conflict, decisions that are not saved; HTML."""
    found = ""
    if state.conflicts:
        conflict = state.conflicts[0]
        theirs = "; ".join(event_words(event) for event in conflict.events)
        mine = decision_words(conflict.decision.decision)
        who = text(conflict.events[-1].person or "DART")
        more = f" <small>{len(state.conflicts) - 1} more after this one.</small>" if len(state.conflicts) > 1 else ""
        buttons = bridge.button(f"Leave it to {who}", "cmine:no") + bridge.button("Store mine", "cmine:yes")
        found += (
            f'<div class="gw-error" data-conflict="1"><b>Changed meanwhile.</b> {text(theirs)}. You decided'
            f' <b>{text(mine)}</b>, which is not stored.{more}<div class="gw-bar gw-below">{buttons}</div></div>'
        )
    if state.unsaved:
        found += (
            f'<div class="gw-error" data-unsaved="{len(state.unsaved)}"><b>{len(state.unsaved)} not saved.</b>'
            f" {text(state.trouble)}<div class='gw-bar gw-below'>"
            f"{bridge.button('Try again', 'cretry:', look='gw-main')}</div></div>"
        )
    return found


def saved_line(state: State) -> str:
    """Whether all that was decided is on disk; HTML."""
    if state.pending:
        return f'<span class="gw-spin"></span>{len(state.pending)} on their way'
    if state.unsaved:
        return f"{len(state.unsaved)} not saved"
    return f'<span data-saved="{state.saved}">{state.saved} saved</span>'


def decision(state: State, bridge: Bridge) -> str:
    """The buttons of a decision; HTML."""
    sample = state.sample
    assert sample is not None
    row = sample.row
    blind = state.blind
    given = None
    if not blind and row.source == "human":
        given = row.state if row.state != "labelled" else {1.0: "good", 0.0: "bad"}.get(row.label or 0.0)
        given = {"excluded": "exclude"}.get(given or "", given)
    buttons = "".join(
        bridge.button(label, f"cdecide:{name}", hint=f"key {key}", look=f"gw-{name} {'gw-on' if given == name else ''}")
        for name, label, key in (
            ("good", "✓ Good", "G"), ("bad", "✗ Bad", "B"), ("unsure", "? Unsure", "U"), ("exclude", "⊘ Exclude", "X"),
        )
    )  # fmt: skip
    mark = "unflag" if row.flagged else "flag"
    walk = (
        bridge.button("‹ Back", "cmove:-1", hint="the sample before (K)", off=state.review is not None)
        + bridge.button("Skip ›", "cmove:1", hint="the next sample (J or N)")
        + bridge.button("↶ Undo", "cundo:", hint="your newest step (Z)")
        + bridge.button("↷ Redo", "credo:", hint="what you undid (Y)")
    )
    if state.review is None:
        walk += bridge.button("⚑", f"cdecide:{mark}", hint=f"{mark} (M)", look="gw-on" if row.flagged else "")
    value = ""
    if state.item is None:
        shown = "–" if row.label is None else f"{row.label:g}"
        value = (
            f'<div class="gw-bar gw-small">{bridge.button("− 0.1", "cnudge:-1", hint="lower the value (O)")}'
            f'<span class="gw-value">label <b data-label="{shown}">{shown}</b></span>'
            f"{bridge.button('+ 0.1', 'cnudge:1', hint='raise the value (P)')}</div>"
        )
    return (
        f'<div class="gw-bar gw-decide">{buttons}</div>{value}<div class="gw-bar gw-below gw-small">{walk}</div>'
        f'<div class="gw-stored"><small>{saved_line(state)}</small></div>'
    )


def facts(state: State, bridge: Bridge) -> str:
    """What is known of the sample; HTML. In blind mode, that this is hidden."""
    sample = state.sample
    assert sample is not None
    row = sample.row
    if state.blind:
        return '<div class="gw-empty" data-blind="1">Blind: score, quality and labels are hidden.</div>'
    score = "–" if row.score is None else f"{row.score:.3f}"
    heat = "–" if row.heat is None else f"{row.heat:.2f}"
    pooled = sample.pooled
    quality = "no attempt yet" if pooled.quality is None else f"{pooled.successes}/{pooled.attempts}"
    between = "" if pooled.quality is None else f" <small>{pooled.low:.2f} to {pooled.high:.2f}</small>"
    label = "left out" if row.label is None else f"{row.label:g}"
    colour = "#8b9bb4" if row.label is None else colours.css(colours.score(row.label))
    return (
        f'<div class="gw-known"><div data-reason="1"><b class="gw-badge" style="background:{colour}">{label}</b>'
        f" {text(sentence(sample.label.reason))}</div>"
        f'<div><small>DART</small> <b data-quality="{quality}">{quality}</b>{between}'
        f" <small>score</small> <b>{score}</b> <small>heat</small> <b>{heat}</b></div></div>"
    )


def attempts(state: State, bridge: Bridge) -> str:
    """The attempts as buttons that replay them, and verify; HTML."""
    sample = state.sample
    assert sample is not None
    if state.blind:
        return ""
    shown = None if state.playing is None else state.playing.played.number
    chips = "".join(
        bridge.button(
            str(number + 1),
            f"creplay:{number}",
            hint=f"attempt {number + 1}: {attempt.outcome}; replay it",
            look="gw-on" if number == shown else "",
            style=f"background:{colours.css(colours.OUTCOMES[attempt.outcome])}",
            more=f'data-attempt="{number}"',
        )
        for number, attempt in enumerate(sample.attempts)
    )
    counts = Counter(attempt.outcome for attempt in sample.attempts)
    ends = ", ".join(f"{count} {outcome.lower()}" for outcome, count in counts.most_common())
    more = bridge.button("Verify: 5 more", "cverify:5", hint="run five more attempts in DART (V)", off=bool(state.busy))
    told = ""
    if state.busy:
        told = f'<div class="gw-words"><span class="gw-spin"></span>{text(sentence(state.busy))}</div>'
    elif state.playing is not None:
        played = state.playing.played
        warn = "" if played.same else ' class="gw-error"'
        back = colours.css(colours.OUTCOMES[played.outcome])
        badge = f'<b class="gw-badge" style="background:{back}">{played.outcome}</b>'
        told = f'<div{warn} data-played="{played.number}">{badge} {text(sentence(played.words))}</div>'
    comfort = next((att.comfort for att in sample.attempts if att.comfort is not None), None)
    moved = ""
    if comfort is not None and not told:
        moved = f"<small>moved in the grip by {1000 * comfort[0]:.0f} mm, {math.degrees(comfort[1]):.0f}°</small>"
    chips += f"<small>{ends}</small>"
    return f'<div class="gw-tries gw-wrap">{chips}</div><div class="gw-bar gw-small">{more}</div>{told}{moved}'


def editing(state: State, bridge: Bridge) -> str:
    """Keys and buttons of the rectangle's edit; HTML."""
    if state.review is not None or state.sample is None:
        return ""
    if state.edited is None:
        begin = bridge.button("Edit the rectangle", "cedit:0", hint="move, turn, widen: a new grasp (R)")
        return f'<div class="gw-bar gw-small">{begin}</div>'
    keys = "".join(
        bridge.button(_EDIT_SIGNS[key], f"cedit:{key}", hint=f"{_EDIT_WORDS[key]} (key {key})") for key in "46827913"
    )
    grasp = state.edited
    told = f"φ {math.degrees(grasp.angle):.0f}°, {1000 * grasp.width:.0f} mm, {1000 * grasp.position[2]:.0f} mm high"
    ends = (
        bridge.button("Store", "cstore:yes", hint="as a new grasp (5)", look="gw-main")
        + bridge.button("Store and verify", "cstore:verify", hint="and run five attempts", look="gw-main")
        + bridge.button("Forget", "cstore:no", hint="key 0")
    )
    return (
        f'<div data-editing="1"><div class="gw-bar gw-small">{keys}</div><small>{told}; drag it, or its knob</small>'
        f'<div class="gw-bar gw-below gw-small">{ends}</div></div>'
    )


def _always(action: Action) -> Callable[[], Action]:
    return lambda: action


class SamplePanel:
    """The tab of the sample."""

    def __init__(self, bridge: Bridge, gripper: Gripper) -> None:
        self._bridge = bridge
        self._gripper = gripper
        self._image = bridge.html()
        self._label = bridge.html()
        self._note = bridge.field("Note", "", a.WriteNote, "Goes with the next decision; or store it by itself")
        self._tries = bridge.html()
        self._time = bridge.slider("Replay s", 0.0, 1.0, 0.01, 0.0, a.Seek, "Where the replay stands, seconds")
        self._edit = bridge.html()
        for label, key, action in (
            ("Good", "G", a.Decide(1.0)),
            ("Bad", "B", a.Decide(0.0)),
            ("Unsure", "U", a.Decide("unsure")),
            ("Exclude", "X", a.Decide("exclude")),
            ("Next sample", "J", a.Move(1)),
            ("Skip this sample", "N", a.Move(1)),
            ("Sample before", "K", a.Move(-1)),
            ("Flag", "M", a.Decide("flag")),
            ("Verify in DART", "V", a.Verify(5)),
            ("Undo", "Z", a.TakeBack(redo=False)),
            ("Redo", "Y", a.TakeBack(redo=True)),
            ("Lower the value", "O", a.Nudge(-STEP)),
            ("Raise the value", "P", a.Nudge(STEP)),
            ("Replay or pause", "T", a.TogglePlay()),
            ("Edit the rectangle", "R", a.Edit()),
            ("Store the edited rectangle", "5", a.EndEdit(store=True)),
            ("Forget the edited rectangle", "0", a.EndEdit(store=False)),
        ):
            bridge.command(f"Curate: {label}", key, _always(action), f"On the sample that is shown: {label}")
        for key, edit in EDITS.items():
            words = f"Rectangle: {_EDIT_WORDS[key]}"
            bridge.command(f"Curate: {words}", key, _always(edit), words)

    def update(self, old: State | None, new: State) -> None:
        """Show `new`; the image is sent when sample or rectangle changed only."""
        bridge, sample = self._bridge, new.sample
        if sample is None:
            told = "Click a sample on the left." if new.facts is None or new.facts.samples else "No sample yet."
            put(self._image, content=f'<div class="gw">{trouble(new, bridge)}<div class="gw-empty">{told}</div></div>')
            for handle in (self._label, self._tries, self._edit):
                put(handle, content="")
            return
        if old is None or (old.sample, old.edited, old.review) != (sample, new.edited, new.review):
            picture = sample_svg(sample.image, sample.row.grasp, self._gripper, new.edited)
            name = f"{text(sample.object)} <span>{text(sample.split)} · sample {sample.row.id}</span>"
            maker = f" · by {text(sample.row.person)}" if sample.row.person else ""
            parent = f" · edited from sample {sample.row.parent}" if sample.row.parent else ""
            more = "" if new.blind else f"<small>{text(sample.scene_name)}{maker}{parent}</small>"
            crop = f'<img class="gw-crop" src="{sample.crop}" alt="" title="what the Refined Network sees">'
            put(
                self._image,
                content=f'<div class="gw" data-shown="{sample.row.id}"><h3>{name}</h3>'
                f'<div class="gw-pictures">{picture}{crop}</div>{more}</div>',
            )
        inner = f"{trouble(new, bridge)}{facts(new, bridge)}{decision(new, bridge)}"
        put(self._label, content=f'<div class="gw" data-decide="{sample.row.id}">{inner}</div>')
        put(self._note, value=new.note)
        note = bridge.button("Store the note", "cnote:", off=not new.note)
        tries = f'<div class="gw-bar gw-small">{note}</div>{attempts(new, bridge)}'
        put(self._tries, content="" if new.edited is not None else f'<div class="gw">{tries}</div>')
        playing = new.playing
        put(
            self._time,
            visible=playing is not None,
            max=1.0 if playing is None else max(0.01, round(playing.duration, 2)),
        )
        if playing is None or not playing.playing or abs(playing.position - self._time.value) >= 0.1:
            put(self._time, value=0.0 if playing is None else round(min(playing.position, self._time.max), 2))
        put(self._edit, content=f'<div class="gw">{editing(new, bridge)}</div>')
