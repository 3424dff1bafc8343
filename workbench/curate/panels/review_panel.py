"""Reviews and what they say of people; the networks' scores; exchange of label events."""

from __future__ import annotations

from grasp_core.dataset.review import CHOICES, Choice, Rule
from workbench.bridge import Bridge, Reader
from workbench.casting import put, text
from workbench.curate import actions as a
from workbench.curate.state import State

_SIZES = (20, 50, 100, 200)
_MOST_UPLOADED = 64_000_000
LABELS: dict[Choice, str] = {
    "disagreement": "Disagreement",
    "mistakes": "Worst mistakes",
    "audit": "Random audit",
    "opinions": "Second opinions",
}


def _start(argument: str) -> a.StartReview:
    """`choice,size,blind,seed`."""
    choice, size, blind, seed = argument.split(",")
    for known in CHOICES:
        if choice == known and int(size) in _SIZES:
            return a.StartReview(Rule(choice=known, size=int(size), blind=blind == "1", seed=int(seed)))
    raise ValueError(argument)


READERS: dict[str, Reader] = {
    "creview": _start,
    "cresume": lambda argument: a.ResumeReview(int(argument) if argument else None),
    "cscore": lambda argument: a.ScoreAll(),
    "cexport": lambda argument: a.ExportEvents(),
}


def under_way(state: State, bridge: Bridge) -> str:
    """The review that is gone through, or the way into one; HTML."""
    if state.review is not None:
        found = state.review
        share = 100 * found.done / found.items
        return (
            f'<h3>Review <span>{"blind" if found.rule.blind else "open"}</span></h3><div data-review="{found.id}">'
            f"{text(LABELS[found.rule.choice])}: {text(CHOICES[found.rule.choice])}."
            f'<div class="gw-stages"><i style="width:{share:.1f}%;background:#5aaaeb"></i></div>'
            f"<small>{found.done} of {found.items} looked at</small>"
            f'<div class="gw-bar gw-below">{bridge.button("Leave the review", "cresume:")}</div></div>'
        )
    sizes = "".join(f"<option{' selected' if size == 50 else ''}>{size}</option>" for size in _SIZES)
    begin = "".join(
        f'<button title="{text(words)}" data-choice="{choice}" onclick="const b=this.closest(\'.gw-start\');'
        f"gwSend('creview:{choice},'+b.querySelector('select').value+','+(b.querySelector('input').checked?1:0)+','"
        f'+Math.floor(Math.random()*1e9))">{text(LABELS[choice])}</button>'
        for choice, words in CHOICES.items()
    )
    rest = "".join(
        f"<li><div>{text(LABELS[found.rule.choice])}{' · blind' if found.rule.blind else ''}"
        f" <small>{found.done} of {found.items}</small></div>{bridge.button('go on', f'cresume:{found.id}')}</li>"
        for found in (() if state.facts is None else state.facts.reviews)
        if found.done < found.items
    )
    return (
        '<h3>Start a review</h3><div class="gw-start"><div class="gw-bar gw-wrap">'
        f"{begin}</div><label><small>samples</small> <select>{sizes}</select></label>"
        '<label title="hides score, quality and labels"><input type="checkbox" data-blind-choice="1"> <small>blind'
        "</small></label></div>"
        "<small>Every tenth sample more is one of known outcome: it measures you, its label stays.</small>"
        f'<ul class="gw-events">{rest}</ul>'
    )


def measured(state: State) -> str:
    """Accuracy and agreement of people; HTML."""
    facts = state.facts
    if facts is None or not (facts.accuracies or facts.agreements):
        return ""
    known = "".join(
        f'<tr data-accuracy="{text(found.person)}"><td>{text(found.person)}</td>'
        f"<td>{found.right}/{found.samples} right</td><td>{100 * found.low:.0f}-{100 * found.high:.0f} %</td></tr>"
        for found in facts.accuracies
    )
    pairs = "".join(
        f'<tr data-kappa="{text("+".join(pair.people))}"><td>{text(" & ".join(pair.people))}</td>'
        f"<td>κ {'–' if pair.kappa is None else f'{pair.kappa:.2f}'}</td><td>{pair.samples} common</td></tr>"
        for pair in facts.agreements
    )
    parts = ""
    if known:
        parts += f'<h3 title="on hidden samples of known outcome">Accuracy</h3><table class="gw-table">{known}</table>'
    if pairs:
        parts += (
            f'<h3 title="Cohen\'s kappa: 1 full, 0 as by chance">Agreement</h3><table class="gw-table">{pairs}</table>'
        )
    return parts


def scores(state: State, bridge: Bridge) -> str:
    """The networks' scores, and exchange; HTML."""
    if state.scoring is not None:
        done, total = state.scoring
        share = 100 * done / max(total, 1)
        told = (
            f'<div class="gw-stages"><i style="width:{share:.1f}%;background:#5aaaeb"></i></div><div class="gw-bar">'
            f"<small>{done} of {total} scenes</small>{bridge.button('Stop', 'cscore:')}</div>"
        )
    else:
        weights = "none yet" if state.facts is None or not state.facts.weights else f"of '{text(state.facts.weights)}'"
        score = bridge.button("Score all grasps", "cscore:", hint="with the shipped weights, in the background")
        told = f'<div class="gw-bar"><small data-weights="1">scores: {weights}</small>{score}</div>'
    export = bridge.button("Export", "cexport:", hint="all label events as JSON Lines")
    return f'<h3>Networks</h3>{told}<h3>Exchange</h3><div class="gw-bar"><small>label events</small>{export}</div>'


class ReviewPanel:
    """The tab of reviews and people."""

    def __init__(self, bridge: Bridge) -> None:
        self._bridge = bridge
        self._html = bridge.html()
        bridge.upload(
            "Import label events",
            (".jsonl",),
            _MOST_UPLOADED,
            lambda name, content: a.ImportEvents(content),
            "JSON Lines that another copy of the dataset exported",
        )

    def update(self, old: State | None, new: State) -> None:
        """Show `new`."""
        told = under_way(new, self._bridge)
        if not new.blind:
            told += measured(new) + scores(new, self._bridge)
        put(self._html, content=f'<div class="gw">{told}</div>')
