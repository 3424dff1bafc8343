"""The left column: who sits here, which samples are listed, the list itself, bulk decisions and saved lists."""

from __future__ import annotations

from typing import Any
from urllib.parse import unquote

from grasp_core.dataset.queries import RANGES, Query
from workbench import colours
from workbench.bridge import Bridge, Reader, read_value
from workbench.casting import put, text
from workbench.curate import actions as a
from workbench.curate.panels.words import decision_words
from workbench.curate.state import START, State
from workbench.curate.values import Thumb

_HIGH = (("0.3..1", "at least 0.3"), ("0.5..1", "at least 0.5"), ("0.8..1", "at least 0.8"))
_PARTS = (("0..0", "0"), ("0..0.2", "up to 0.2"), ("0.2..0.8", "0.2 to 0.8"), ("0.8..1", "from 0.8"), ("1..1", "1"))

FILTERS: dict[str, tuple[str, str, tuple[tuple[str, str], ...]]] = {
    "split": ("split", "of the object", (("train", ""), ("validation", ""), ("test", ""))),
    "outcome": (
        "outcome", "at least one attempt ended so",
        (("SUCCESS", ""), ("COLLISION", ""), ("MISSED", ""), ("SLIPPED", "")),
    ),
    "quality": ("quality", "successes / attempts", _PARTS),
    "label": ("label", "what training uses", _PARTS),
    "source": ("label by", "where the label comes from", (("human", "people"), ("dart", "DART"), ("none", "nobody"))),
    "state": ("state", "of the label", (("labelled", ""), ("unlabelled", ""), ("unsure", ""), ("excluded", ""))),
    "flagged": ("flagged", "somebody marked it", (("yes", "yes"), ("no", "no"))),
    "origin": ("made by", "who made the grasp", (("grid", ""), ("person", ""), ("planner", ""), ("import", ""))),
    "score": ("score", "of the Refined Network", _PARTS),
    "gap": ("|score − quality|", "network against physics", _HIGH),
    "mistake": ("|score − label|", "network against label", _HIGH),
    "networks": ("|heat − score|", "Regression against Refined Network", _HIGH),
    "dissent": ("|label − quality|", "people against DART", _HIGH),
    "spread": ("spread", "variance of the attempts", (("0.01..0.25", "any"), ("0.2..0.25", "most"))),
}  # fmt: skip
"""Field of the query → name, what it is, and its choices (value, words)."""

SORTS = {
    "id": "as stored",
    "gap": "|score − quality|",
    "mistake": "|score − label|",
    "networks": "|heat − score|",
    "dissent": "people against DART",
    "spread": "spread of attempts",
    "quality": "quality",
    "label": "label",
    "score": "score",
    "heat": "heat",
    "changed": "last changed",
}
BULK: dict[str, float | str] = {"good": 1.0, "bad": 0.0, "unsure": "unsure", "exclude": "exclude", "flag": "flag"}


def _bulk(argument: str) -> a.CountBulk:
    if argument not in BULK:
        raise ValueError(argument)
    return a.CountBulk(BULK[argument])


READERS: dict[str, Reader] = {
    "cfilter": lambda argument: a.Filter(*read_value(argument)),
    "creload": lambda argument: a.Reload(),
    "creset": lambda argument: a.UseQuery(START),
    "cturn": lambda argument: a.TurnPage(1 if int(argument) > 0 else -1),
    "cpick": lambda argument: a.Pick(int(argument)),
    "cbulk": _bulk,
    "cstop": lambda argument: a.StopBulk(),
    "cdo": lambda argument: a.AnswerBulk(argument == "yes"),
    "copenview": lambda argument: a.OpenView(unquote(argument)),
    "csaveview": lambda argument: a.KeepView(read_value(argument)[1]),
    "cdropview": lambda argument: a.KeepView(unquote(argument), forget=True),
}


def _select(bridge: Bridge, field: str, name: str, hint: str, choices: list[tuple[str, str]], value: str) -> str:
    options = "".join(
        f'<option value="{text(key)}"{" selected" if key == value else ""}>{text(words or key)}</option>'
        for key, words in [("", "any"), *choices]
    )
    look = "gw-field gw-set" if value else "gw-field"
    event = bridge.onvalue("cfilter", field)
    return (
        f'<label class="{look}" title="{text(hint)}"><small>{text(name)}</small>'
        f'<select data-filter="{field}" {event}>{options}</select></label>'
    )


def filters(state: State, bridge: Bridge) -> str:
    """All filters, the sorting and the search in notes; HTML."""
    query, facts = state.query, state.facts
    people = [(name, "") for name in (facts.people if facts else ())]
    categories = [(name, "") for name in (facts.categories if facts else ())]
    parts = [
        _select(bridge, "category", "category", "of the object", categories, query.category or ""),
        _text(bridge, "object", "object", "exact name of an object", query.object or ""),
        _text(bridge, "scene", "scene", "exact name of a scene, as below the sample's image", query.scene or ""),
    ]
    for field, (name, hint, choices) in FILTERS.items():
        shown = _shown(field, getattr(query, field))
        known = list(choices) if shown in {"", *(key for key, _ in choices)} else [*choices, (shown, shown)]
        parts.append(_select(bridge, field, name, hint, known, shown))
    parts.append(_select(bridge, "person", "person", "has an event of this person", people, query.person or ""))
    parts.append(_text(bridge, "text", "in notes", "words in notes; the last may be incomplete", query.text or ""))
    used = sum(getattr(query, field) is not None for field in query.__struct_fields__ if field not in _ORDER)
    told = f"{used} in use" if used else "none"
    return (
        f'<details class="gw-filters"{" open" if used else ""}><summary>Filters <span>{told}</span></summary>'
        f'<div class="gw-fields">{"".join(parts)}</div></details>'
    )


def _shown(field: str, value: Any) -> str:
    """The value of a filter as its choice; "" where the filter is off."""
    if value is None:
        return ""
    if field in RANGES:
        return "..".join(f"{bound:g}" for bound in value)
    return ("yes" if value else "no") if isinstance(value, bool) else str(value)


_ORDER = ("sort", "descending")


def _text(bridge: Bridge, field: str, name: str, hint: str, value: str) -> str:
    look = "gw-field gw-set" if value else "gw-field"
    return (
        f'<label class="{look}" title="{text(hint)}"><small>{text(name)}</small><input data-filter="{field}"'
        f' value="{text(value)}" {bridge.onvalue("cfilter", field)}></label>'
    )


def order(state: State, bridge: Bridge) -> str:
    """Sorting and direction; HTML."""
    options = "".join(
        f'<option value="{key}"{" selected" if key == state.query.sort else ""}>{text(words)}</option>'
        for key, words in SORTS.items()
    )
    event = bridge.onvalue("cfilter", "sort")
    down = state.query.descending
    return (
        '<div class="gw-bar gw-order"><label class="gw-field"><small>sort by</small>'
        f'<select data-filter="sort" {event}>{options}</select></label>'
        + _flip(down)
        + bridge.button("Reset", "creset:", hint="all samples, as stored")
        + "</div>"
    )


def _flip(down: bool) -> str:
    """The button that turns the order round."""
    other = "" if down else "yes"
    return (
        f'<button data-way="{"down" if down else "up"}" title="turn the order round"'
        f" onclick=\"gwSend('cfilter:descending={other}')\">{'▼ highest first' if down else '▲ lowest first'}</button>"
    )


def badge(thumb: Thumb) -> str:
    """The label of a sample in a corner of its thumbnail; HTML."""
    row = thumb.row
    if row.state in ("unsure", "excluded"):
        words, back = {"unsure": ("?", "#8b9bb4"), "excluded": ("⊘", "#8b9bb4")}[row.state]
    elif row.label is None:
        words, back = "–", "#8b9bb4"
    else:
        words, back = f"{row.label:g}"[:4], colours.css(colours.score(row.label))
    by = " ✎" if row.source == "human" else ""
    flag = '<i class="gw-flag">⚑</i>' if row.flagged else ""
    return f'<b style="background:{back}">{words}{by}</b>{flag}'


def listing(state: State, bridge: Bridge) -> str:
    """The page of samples; HTML."""
    if state.failure:
        again = bridge.button("Try again", "creload:")
        return f'<div class="gw-error" data-failure="1">{text(state.failure)}<div class="gw-below">{again}</div></div>'
    shelf = state.shelf
    if shelf is None:
        return '<div class="gw-words"><span class="gw-spin"></span>Reading the dataset …</div>'
    if not shelf.thumbs:
        return '<div class="gw-empty" data-shelf="0">No sample matches. Loosen the filters, or reset them.</div>'
    cards = []
    for thumb in shelf.thumbs:
        row = thumb.row
        score = "" if row.score is None else f'<i title="score of the network">{row.score:.2f}</i>'
        cards.append(
            f'<div class="gw-thumb gw-t{row.id}" data-sample="{row.id}" {bridge.onclick(f"cpick:{row.id}")}'
            f' title="{text(thumb.object)}: {row.successes}/{row.attempts} attempts"><img src="{thumb.picture}" alt="">'
            f"{badge(thumb)}<span><em>{text(thumb.object)}</em>{score}</span></div>"
        )
    return f'<div class="gw-shelf" data-shelf="{len(cards)}" data-ticket="{state.ticket}">{"".join(cards)}</div>'


def pager(state: State, bridge: Bridge) -> str:
    """Which page of how many samples, and the way to the next; HTML."""
    shelf = state.shelf
    whole = None if state.facts is None else state.facts.samples
    if shelf is None:
        return ""
    if shelf.total is not None:
        total = f"{shelf.total:,} samples"
    else:
        all_of_them = whole is not None and state.query == _plain(state.query)
        total = f"{whole:,} samples" if all_of_them else "10,000 samples or more"
    return (
        '<div class="gw-bar gw-pager">'
        + bridge.button("‹ Page", "cturn:-1", off=len(state.keys) < 2, hint="the page before")
        + f'<span data-page="{len(state.keys)}">page {len(state.keys)}<br><small>{total}</small></span>'
        + bridge.button("Page ›", "cturn:1", off=shelf.after is None, hint="the next page")
        + "</div>"
    )


def _plain(query: Query) -> Query:
    """The list of all samples in the same order."""
    return Query(sort=query.sort, descending=query.descending)


def bulk(state: State, bridge: Bridge) -> str:
    """Decisions on the whole list, counted before they are made; HTML."""
    if state.relabelling is not None:
        done, total = state.relabelling
        return (
            f'<div class="gw-stages" data-relabelling="{done}"><i style="width:{100 * done / max(total, 1):.1f}%;'
            f'background:#5aaaeb"></i></div><div class="gw-bar"><small>relabelled {done:,} of {total:,}</small>'
            f"{bridge.button('Stop', 'cstop:', hint='no label is changed then')}</div>"
        )
    if state.shelf is None:
        return ""
    if state.bulk is None:
        buttons = "".join(bridge.button(name, f"cbulk:{name}", hint="count first, then ask") for name in BULK)
        return f'<small>the whole list is</small><div class="gw-bar gw-small">{buttons}</div>'
    ask, plan = state.bulk, state.bulk.plan
    over = f" <b>{plan.human}</b> of them overrule a person's decision." if plan.human else ""
    return (
        f'<div class="gw-ask" data-bulk="{plan.samples}"><b>{plan.samples:,}</b> samples become'
        f" <b>{text(decision_words(ask.decision))}</b>; {plan.changing:,} of them change.{over}"
        f'<div class="gw-bar gw-below">{bridge.button("Relabel them", "cdo:yes", look="gw-main")}'
        f"{bridge.button('Leave them', 'cdo:no')}</div></div>"
    )


def views(state: State, bridge: Bridge) -> str:
    """Saved lists; HTML."""
    names = [] if state.facts is None else sorted(state.facts.views)
    chips = "".join(
        f'<span class="gw-chip"><button onclick="gwSend(\'copenview:\'+encodeURIComponent(this.innerText))"'
        f' title="show this list">{text(name)}</button><button title="forget this list" aria-label="forget"'
        " onclick=\"gwSend('cdropview:'+encodeURIComponent(this.previousSibling.innerText))\">×</button></span>"
        for name in names
    )
    return (
        f'<div class="gw-saved">{chips}<input data-saveview="1" placeholder="save this list as …"'
        f" {bridge.onvalue('csaveview', 'name')}></div>"
    )


class ListPanel:
    """The left column."""

    def __init__(self, bridge: Bridge, state: State) -> None:
        self._bridge = bridge
        self._who = bridge.field("Your name", state.person, a.SayName, "Goes with every decision; asked once a browser")
        self._filters = bridge.html()
        self._bar = bridge.html()
        self._selection = bridge.html("<style></style>")
        self._list = bridge.html()
        self._more = bridge.html()

    def update(self, old: State | None, new: State) -> None:
        """Show `new`; the pictures are sent when the page changed only."""
        bridge = self._bridge
        put(self._who, value=new.person)
        shown = new.sample.row.id if new.sample is not None else -1
        put(self._selection, content=f"<style>.gw-t{shown}{{outline:2px solid #5aaaeb}}</style>")
        if new.review is not None:  # a queue is gone through in its own order, and what the list shows is hidden
            for handle in (self._filters, self._bar, self._more):
                put(handle, content="")
            told = "The list comes back when you leave the review (tab Reviews, on the right)."
            put(self._list, content=f'<div class="gw"><div class="gw-empty">{told}</div></div>')
            return
        put(self._filters, content=f'<div class="gw">{filters(new, bridge)}{views(new, bridge)}</div>')
        put(self._bar, content=f'<div class="gw">{order(new, bridge)}{pager(new, bridge)}</div>')
        if old is None or old.review is not None or (old.shelf, old.failure) != (new.shelf, new.failure):
            put(self._list, content=f'<div class="gw">{listing(new, bridge)}</div>')
        put(self._more, content=f'<div class="gw">{bulk(new, bridge)}</div>')
