"""The panel of the candidates: the sorted list, trying all of them, and where the planner's time went."""

from __future__ import annotations

import math
from collections.abc import Mapping

from workbench import colours
from workbench.actions import Action
from workbench.bridge import Bridge, Reader
from workbench.casting import put, text
from workbench.inspector import actions as a
from workbench.inspector.images import tint
from workbench.inspector.orders import Choice
from workbench.inspector.state import State


def _choice(argument: str) -> Choice:
    side, _, index = argument.partition(".")
    if not (side.isdecimal() and index.isdecimal() and len(side) < 3 and len(index) < 6):
        raise ValueError(argument)
    return Choice(int(side), int(index))


def _tint(argument: str) -> Action:
    if argument == "score":
        return a.ColourBy("score")
    if argument == "physics":
        return a.ColourBy("physics")
    raise ValueError(argument)


def _least(argument: str) -> Action:
    value = float(argument)
    if not 0 <= value <= 1:
        raise ValueError(argument)
    return a.Filter(value)


READERS: dict[str, Reader] = {
    "select": lambda argument: a.Select(_choice(argument)),
    "look": lambda argument: a.LookAt(int(argument)),
    "tryall": lambda argument: a.TryAll(),
    "stop": lambda argument: a.StopTrying(),
    "tint": _tint,
    "least": _least,
}


def stages(times: Mapping[str, float]) -> str:
    """Milliseconds per stage as a bar with its key; HTML."""
    parts = [(name, float(value)) for name, value in times.items() if value > 0]
    whole = sum(value for _, value in parts) or 1.0
    bar = "".join(
        f'<i style="width:{100 * value / whole:.1f}%;background:{colours.STAGES[i % len(colours.STAGES)]}"'
        f' title="{text(name)} {value:.1f} ms"></i>'
        for i, (name, value) in enumerate(parts)
    )
    keys = "".join(
        f'<span><b style="background:{colours.STAGES[i % len(colours.STAGES)]}"></b>{text(name.replace("_", " "))}'
        f" {value:.{0 if value >= 9.95 else 1}f}</span>"
        for i, (name, value) in enumerate(parts)
    )
    return f'<div class="gw-stages">{bar}</div><div class="gw-keys">{keys}<span>ms</span></div>'


_HEAD = "".join(
    f'<th title="{hint}">{name}</th>'
    for name, hint in (
        ("#", "place, best first"),
        ("score", "the planner's own; of those with networks the probability that the grasp succeeds"),
        ("heat", "quality map at the grasp"), ("φ", "angle of the closing axis about the vertical"),
        ("w", "opening at approach, mm"), ("z", "height of the finger tips above the table, mm"),
        ("DART", "successes / attempts in physics"), ("you", "your verdict"),
    )
)  # fmt: skip


def rows(state: State, bridge: Bridge) -> str:
    """The rows of the list that the filter lets through; HTML."""
    plan = state.plan
    mapped = plan is not None and bool(plan.quality_map.any())
    made = []
    for index in state.visible:
        candidate, choice = state.candidates[index], Choice(state.side, index)
        trial = state.trials.get(choice)
        tried = "·"
        if trial is not None and trial.attempts:
            colour = colours.css(colours.score(trial.successes / len(trial.attempts)))
            tried = f'<span style="color:{colour}">{trial.successes}/{len(trial.attempts)}</span>'
        elif trial is not None and trial.running:
            tried = '<i class="gw-spin"></i>'
        verdict = {"good": "✓", "bad": "✗"}.get(state.verdicts.get(choice, ""), "")
        made.append(
            f'<tr class="gw-row{state.side}-{index}" data-candidate="{index}" '
            f"{bridge.onclick(f'select:{state.side}.{index}')}><td>{index + 1}</td>"
            f'<td><b style="background:{tint(state, choice, candidate.score)}"></b>{candidate.score:.3f}</td>'
            f"<td>{f'{candidate.heat:.2f}' if mapped else '–'}</td><td>{math.degrees(candidate.grasp.angle):.0f}°</td>"
            f"<td>{1000 * candidate.grasp.width:.0f}</td><td>{1000 * candidate.grasp.position[2]:.0f}</td>"
            f"<td>{tried}</td><td>{verdict}</td></tr>"
        )
    return "".join(made)


def tools(state: State, bridge: Bridge) -> str:
    """Filter, colours, and the job that tries all; HTML."""
    sweep = state.sweep
    if sweep is not None:
        done = sweep.total - len(sweep.left) - (1 if state.trying else 0)
        job = (
            f'<div class="gw-progress" data-done="{done}"><i style="width:{100 * done / sweep.total:.0f}%"></i>'
            f"<span>{done} of {sweep.total} tried</span></div>{bridge.button('Cancel', 'stop:', hint='stop trying')}"
        )
    else:
        off = state.scene is None or not state.candidates or not state.scene.scene.objects
        job = bridge.button(
            "Try all in DART", "tryall:", hint="every candidate's trial, one after the other (Y)", off=off
        )
    tints = "".join(
        bridge.button(
            label, f"tint:{what}", hint=hint, look="gw-on" if state.by_physics == on else "",
            more=f'aria-pressed="{str(state.by_physics == on).lower()}"',
        )
        for what, label, hint, on in (
            ("score", "score", "colour candidates by the planner's score", False),
            ("physics", "DART", "colour candidates by what physics said", True),
        )
    )  # fmt: skip
    return (
        f'<div class="gw-bar gw-small">{job}</div><div class="gw-bar gw-small"><label title="hide lower scores">'
        f'least score <input type="range" min="0" max="1" step="0.05" value="{state.least:g}" aria-label="least score" '
        f"{bridge.onslide('least')}>{state.least:.2f}</label>"
        f'<span class="gw-marks"><small>colour by</small>{tints}</span></div>'
    )


def listing(state: State, bridge: Bridge) -> str:
    """The candidates, best first, with what physics said of those that were tried; HTML."""
    opened, plan = state.scene, state.plan
    if opened is None:
        waiting = "The candidates come with the first plan." if state.failure is None else "There is no plan."
        return f'<h3>Candidates</h3><div class="gw-empty">{waiting}</div>'
    name = text(opened.setup.planners[state.side])
    if plan is None:
        failed = text(opened.sight.failures[state.side])
        return f'<h3>Candidates <span>{name}</span></h3><div class="gw-error">{failed}</div>'
    if not plan.candidates:
        reason = text(plan.reason or "the planner found no grasp")
        advice = "Move the object" if opened.scene.objects else "Try another image"
        if len(plan.sampled):
            advice += ", or lower t under Settings"
        told = f'<div class="gw-empty">No grasp: {reason}. {advice}.</div>'
        return f"<h3>Candidates <span>{name}: none in {plan.total_ms:.0f} ms</span></h3>{told}{stages(plan.stages_ms)}"
    hidden = len(plan.candidates) - len(state.visible)
    if state.visible:
        head = f"<thead><tr>{_HEAD}</tr></thead>"
        shown = f'<div class="gw-list"><table>{head}<tbody>{rows(state, bridge)}</tbody></table></div>'
    else:
        shown = f'<div class="gw-empty">All scores are below {state.least:.2f}; lower the least score.</div>'
    number = len(plan.candidates)
    count = f"{number} candidate{'' if number == 1 else 's'}" + (f", {hidden} hidden" if hidden else "")
    legend = (
        '<div class="gw-legend"><span>0</span>'
        f'<i style="background:{colours.score_gradient()}"></i><span>1</span></div>'
    )
    return (
        f'<h3 title="J and K try the next and the previous one">{count} <span>{name} in {plan.total_ms:.0f} ms</span>'
        f"</h3>{shown}{legend}{tools(state, bridge)}{stages(plan.stages_ms)}"
    )


class CandidatesPanel:
    """List and times."""

    def __init__(self, bridge: Bridge) -> None:
        self._bridge = bridge
        self._list = bridge.html()
        bridge.command("Try all candidates", "Y", a.TryAll, "Every candidate's trial in DART, one after the other")
        bridge.command("Stop trying", None, a.StopTrying, "Cancel that job")

    def update(self, old: State | None, new: State) -> None:
        """Show `new`."""
        if old is None or _listed(old) != _listed(new):
            put(self._list, content=f'<div class="gw" data-candidates="1">{listing(new, self._bridge)}</div>')


def _listed(state: State) -> tuple[object, ...]:
    return (
        id(state.scene), state.trials, state.verdicts, state.failure, state.side, state.least, state.sweep,
        state.by_physics,
    )  # fmt: skip
