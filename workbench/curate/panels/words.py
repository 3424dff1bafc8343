"""Label events in words."""

from __future__ import annotations

import time

from grasp_core.dataset.labels import LabelEvent

_KINDS = {
    "unsure": "is unsure",
    "exclude": "excluded it",
    "flag": "flagged it",
    "unflag": "took the flag off",
    "note": "wrote a note",
    "revert": "took an event back",
}


def event_words(event: LabelEvent) -> str:
    """What an event did, one clause."""
    who = event.person or "DART"
    if event.kind == "value":
        return f"{who} set {event.value:g}"
    if event.kind == "opinion":
        given = "unsure" if event.value is None else f"{event.value:g}"
        return f"{who} gave the opinion {given}"
    if event.kind == "attempts":
        return f"{who} added {len(event.details.get('seeds', ()))} attempts in DART"
    return f"{who} {_KINDS[event.kind]}"


def decision_words(decision: float | str) -> str:
    """A decision in a word, or its value."""
    if isinstance(decision, str):
        return {"exclude": "excluded", "flag": "flagged"}.get(decision, decision)
    return {1.0: "good", 0.0: "bad"}.get(decision, f"{decision:g}")


def moment(event: LabelEvent) -> str:
    """When it happened, local time."""
    return time.strftime("%Y-%m-%d %H:%M", time.localtime(event.at / 1000))


def change(event: LabelEvent) -> str:
    """The label before and after; "" where it stayed."""
    before, after = ("left out" if value is None else f"{value:g}" for value in (event.old_value, event.new_value))
    return "" if before == after else f"{before} → {after}"
