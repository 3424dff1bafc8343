"""The panel of the candidates: the sorted list, and where the planner's time went."""

from __future__ import annotations

import math
from collections.abc import Mapping

from workbench import colours
from workbench.bridge import Bridge, Reader
from workbench.casting import put, text
from workbench.inspector.actions import Select
from workbench.inspector.state import State

READERS: dict[str, Reader] = {"select": lambda argument: Select(int(argument))}


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
        f" {value:.1f}</span>"
        for i, (name, value) in enumerate(parts)
    )
    return f'<div class="gw-stages">{bar}</div><div class="gw-keys">{keys}<span>ms</span></div>'


def listing(state: State, bridge: Bridge) -> str:
    """The candidates, best first, with what physics said of those that were tried; HTML."""
    opened = state.scene
    if opened is None:
        waiting = "The candidates come with the first plan." if state.failure is None else "There is no plan."
        return f'<h3>Candidates</h3><div class="gw-empty">{waiting}</div>'
    plan = opened.plan
    if not plan.candidates:
        reason = text(plan.reason or "the planner found no grasp")
        told = f'<div class="gw-empty">No grasp: {reason}. Try another pose or object.</div>'
        return f"<h3>Candidates <span>none in {plan.total_ms:.0f} ms</span></h3>{told}{stages(plan.stages_ms)}"
    mapped = bool(plan.quality_map.any())
    rows = []
    for index, candidate in enumerate(plan.candidates):
        trial = state.trials.get(index)
        tried = "·"
        if trial is not None and trial.attempts:
            good = trial.successes == len(trial.attempts)
            colour = colours.css(
                colours.OUTCOMES["SUCCESS" if good else "COLLISION" if not trial.successes else "SLIPPED"]
            )
            tried = f'<span style="color:{colour}">{trial.successes}/{len(trial.attempts)}</span>'
        verdict = {"good": "✓", "bad": "✗"}.get(state.verdicts.get(index, ""), "")
        click = bridge.onclick(f"select:{index}")
        rows.append(
            f'<tr class="gw-row{index}" data-candidate="{index}" {click}><td>{index + 1}</td>'
            f'<td><b style="background:{colours.css(colours.score(candidate.score))}"></b>{candidate.score:.3f}</td>'
            f"<td>{f'{candidate.heat:.2f}' if mapped else '–'}</td><td>{math.degrees(candidate.grasp.angle):.0f}°</td>"
            f"<td>{1000 * candidate.grasp.width:.0f}</td><td>{1000 * candidate.grasp.position[2]:.0f}</td>"
            f"<td>{tried}</td><td>{verdict}</td></tr>"
        )
    head = "".join(
        f'<th title="{hint}">{name}</th>'
        for name, hint in (
            ("#", "place, best first"), ("score", "Refined Network: probability that the grasp succeeds"),
            ("heat", "quality map at the grasp"), ("φ", "angle of the closing axis about the vertical"),
            ("w mm", "opening at approach"), ("z mm", "height of the finger tips above the table"),
            ("DART", "successes / attempts in physics"), ("you", "your verdict"),
        )
    )  # fmt: skip
    legend = (
        '<div class="gw-legend"><span>score 0</span>'
        f'<i style="background:{colours.score_gradient()}"></i><span>1</span></div>'
    )
    planned = f"{text(opened.request.planner)} in {plan.total_ms:.0f} ms"
    return (
        f'<h3 title="J and K try the next and the previous one">{len(plan.candidates)} candidates <span>'
        f"{planned}</span></h3>"
        f'<div class="gw-list"><table><thead><tr>{head}</tr></thead><tbody>{"".join(rows)}</tbody></table></div>'
        f"{legend}{stages(plan.stages_ms)}"
    )


def selection(selected: int | None) -> str:
    """A style sheet that marks the selected candidate in list and image, so that neither is sent anew."""
    if selected is None:
        return "<style></style>"
    return (
        f"<style>.gw-c{selected} polygon{{stroke:#fff;stroke-width:1.4;stroke-opacity:1;fill:rgba(255,255,255,.12)}}"
        f".gw-c{selected} path{{stroke:#fff;stroke-width:3}}.gw-list .gw-row{selected} td{{background:#2c4a66}}</style>"
    )


class CandidatesPanel:
    """List and times."""

    def __init__(self, bridge: Bridge) -> None:
        self._bridge = bridge
        self._selection = bridge.html("<style></style>")
        self._list = bridge.html()

    def update(self, old: State | None, new: State) -> None:
        """Show `new`."""
        put(self._selection, content=selection(new.selected))
        if old is None or (old.scene, old.trials, old.verdicts, old.failure) != (
            new.scene,
            new.trials,
            new.verdicts,
            new.failure,
        ):
            put(self._list, content=f'<div class="gw" data-candidates="1">{listing(new, self._bridge)}</div>')
