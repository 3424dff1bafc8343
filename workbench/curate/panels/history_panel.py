"""Histories: of the sample that is shown, and of a person; every event can be taken back."""

from __future__ import annotations

from collections.abc import Iterable, Set
from urllib.parse import unquote

from grasp_core.dataset.labels import LabelEvent, standing
from workbench.bridge import Bridge, Reader
from workbench.casting import put, text
from workbench.curate import actions as a
from workbench.curate.panels.words import change, event_words, moment
from workbench.curate.state import State

READERS: dict[str, Reader] = {
    "crevert": lambda argument: a.RevertEvent(int(argument)),
    "cperson": lambda argument: a.ShowPerson(unquote(argument)),
    "colder": lambda argument: a.OlderEvents(),
}


def entries(events: Iterable[LabelEvent], gone: Set[int], bridge: Bridge, *, samples: bool) -> str:
    """Events as rows, the newest first; HTML.

    Args:
        events: in any order.
        gone: ids of those that were taken back.
        bridge: makes the buttons.
        samples: name the sample of each event, to be clicked.
    """
    rows = []
    for event in sorted(events, key=lambda event: (event.at, event.id), reverse=True):
        look = "gw-gone" if event.id in gone else ""
        undo = "" if look else bridge.button("revert", f"crevert:{event.id}", hint="take this event back")
        place = bridge.button(f"sample {event.grasp}", f"cpick:{event.grasp}") if samples else ""
        why = "".join(f"<br><small>{text(words)}</small>" for words in (event.reason, event.note) if words)
        rows.append(
            f'<li class="{look}" data-event="{event.id}"><div><b>{text(event_words(event))}</b>'
            f" {text(change(event))}{why}<br><small>{moment(event)}</small></div><div>{place}{undo}</div></li>"
        )
    return f'<ol class="gw-events">{"".join(rows)}</ol>' if rows else '<div class="gw-empty">No event yet.</div>'


def people(state: State, bridge: Bridge) -> str:
    """Buttons that open each person's history; HTML."""
    names = () if state.facts is None else state.facts.people
    if not names:
        return "" if state.facts is None else "<small>Nobody has decided anything yet.</small>"
    return "".join(
        f'<button class="{"gw-on" if name == state.about else ""}" data-person="{text(name)}"'
        f" onclick=\"gwSend('cperson:'+encodeURIComponent(this.dataset.person))\">{text(name)}</button>"
        for name in names
    )


class HistoryPanel:
    """The tab of the histories."""

    def __init__(self, bridge: Bridge) -> None:
        self._bridge = bridge
        self._sample = bridge.html()
        self._person = bridge.html()

    def update(self, old: State | None, new: State) -> None:
        """Show `new`; in a blind review nothing is told."""
        bridge, sample = self._bridge, new.sample
        if new.blind:
            inner = '<div class="gw-empty">Blind: histories are hidden until the review is left.</div>'
            put(self._sample, content=f'<div class="gw">{inner}</div>')
            put(self._person, content="")
            return
        if sample is None:
            inner = '<div class="gw-empty">Choose a sample.</div>'
        else:
            gone = {event.id for event in sample.history} - {event.id for event in standing(sample.history)}
            inner = entries(sample.history, gone, bridge, samples=False)
        shown = "" if sample is None else f"sample {sample.row.id}"
        put(self._sample, content=f'<div class="gw"><h3>History <span>{shown}</span></h3>{inner}</div>')
        known = entries(new.events, new.gone, bridge, samples=True) if new.about else ""
        if new.older:
            known += f'<div class="gw-bar gw-small">{bridge.button("Older events", "colder:")}</div>'
        put(
            self._person,
            content=f'<div class="gw"><h3>Of a person</h3><div class="gw-bar gw-wrap">{people(new, bridge)}</div>'
            f'<div class="gw-scroll" data-about="{text(new.about)}">{known}</div></div>',
        )
