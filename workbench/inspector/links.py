"""What the inspector shows as the query of a link, and what a browser keeps for its next visit.

A link holds readable words: `object=mug_003,box_001&pose=0,1&place=7&planner=antipodal&select=0.3`. Settings that are
as shipped are left out. Own files cannot travel in a link: it names their key, which only the workbench that has them
knows.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from workbench.inspector.orders import MOST_THINGS, Choice, Photo, SceneRequest, Thing
from workbench.inspector.rules.replay import SPEEDS
from workbench.inspector.setup import DEFAULT, FIELDS, Setup, decoded, differences
from workbench.inspector.state import LAYERS, MARKS, Picture, State

_MOST_NAME = 80


def to_query(state: State) -> dict[str, str]:
    """The query that restores scene, settings and selection."""
    request = state.request
    query = {"object": ",".join(thing.name for thing in request.things), "place": str(request.place)}
    if any(thing.pose for thing in request.things):
        query["pose"] = ",".join(str(thing.pose) for thing in request.things)
    if any(thing.at is not None for thing in request.things):
        query["at"] = ",".join("" if t.at is None else ":".join(f"{value:g}" for value in t.at) for t in request.things)
    if state.loose:
        query["loose"] = ",".join(str(int(thing.loose)) for thing in request.things)
    if request.photo is not None:
        query = {"image": request.photo.key, "camera_of_image": request.photo.camera}
        if request.photo.typed is not None:
            query["typed"] = ":".join(f"{value:g}" for value in request.photo.typed)
        if request.photo.scale:
            query["scale"] = f"{request.photo.scale:g}"
    query |= {name: f"{value:g}" if isinstance(value, float) else str(value) for name, value in _other(state.setup)}
    if state.choice is not None and state.choice != Choice(0, 0):
        query["select"] = f"{state.choice.side}.{state.choice.index}"
    return query


def _other(setup: Setup) -> list[tuple[str, Any]]:
    return list(differences(setup).items())


def is_link(query: Mapping[str, str]) -> bool:
    """Whether a query says anything about the inspector."""
    return bool({"object", "image", "place", "pose", "at", "select", *FIELDS} & set(query))


def follow(state: State, query: Mapping[str, str]) -> tuple[State, list[str]]:
    """The state that a link asks for, its scene still to be made, and what is wrong with words that were left out."""
    refused: list[str] = []
    while True:
        try:
            return (_followed(state, query) if is_link(query) else state), refused
        except ValueError as error:
            name = str(error).partition(":")[0]
            refused.append(str(error))
            query = {word: value for word, value in query.items() if word != name}


def _followed(state: State, query: Mapping[str, str]) -> State:
    """The state that a link asks for.

    Raises:
        ValueError: a word of the link has a value that it cannot have; the message begins with it.
    """
    setup = decoded({name: _setting(name, query[name]) for name in FIELDS if name in query})
    request = _photo(query) if "image" in query else _things(query)
    wanted = None
    if "select" in query:
        side, _, index = query["select"].partition(".")
        wanted = Choice(_number("select", side, 1), _number("select", index, 999))
    return replace(state, setup=setup, request=request, wanted=wanted)


def _setting(name: str, value: str) -> Any:
    try:
        return getattr(decoded({name: value}), name)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from error


def _things(query: Mapping[str, str]) -> SceneRequest:
    names = query.get("object", SceneRequest().things[0].name).split(",")
    if not 1 <= len(names) <= MOST_THINGS or not all(0 < len(name) <= _MOST_NAME for name in names):
        raise ValueError(f"object: a scene has 1 to {MOST_THINGS} objects, separated by commas")
    poses = _column(query, "pose", len(names), "0")
    places = _column(query, "at", len(names), "")
    loose = _column(query, "loose", len(names), "0")
    things = tuple(
        Thing(name, _number("pose", pose, 9999), _pose(at), bool(_number("loose", free, 1)))
        for name, pose, at, free in zip(names, poses, places, loose, strict=True)
    )
    return SceneRequest(things, _number("place", query.get("place", "1"), 2**31))


def _photo(query: Mapping[str, str]) -> SceneRequest:
    typed = _numbers("typed", query["typed"], 4) if query.get("typed") else None
    (scale,) = _numbers("scale", query.get("scale", "0"), 1)
    key, camera = query["image"][:_MOST_NAME], query.get("camera_of_image", "")[:_MOST_NAME]
    return SceneRequest((), 1, Photo(key, camera, typed, scale))  # type: ignore[arg-type]


def _column(query: Mapping[str, str], name: str, count: int, default: str) -> list[str]:
    values = query[name].split(",") if name in query else [default] * count
    if len(values) != count:
        raise ValueError(f"{name}: needs one value for each object")
    return values


def _number(name: str, text: str, most: int) -> int:
    if not text.isdecimal() or int(text) > most:
        raise ValueError(f"{name}: '{text[:40]}' is no whole number from 0 to {most}")
    return int(text)


def _numbers(name: str, text: str, count: int) -> tuple[float, ...]:
    try:
        values = tuple(float(part) for part in text.split(":"))
    except ValueError as error:
        raise ValueError(f"{name}: '{text[:40]}' holds something that is no number") from error
    if len(values) != count or not all(abs(value) < 1e5 for value in values):
        raise ValueError(f"{name}: needs {count} numbers, separated by colons")
    return values


def _pose(text: str) -> Any:
    if not text:
        return None
    values = _numbers("at", text, 7)
    length = sum(value**2 for value in values[3:])
    if max(abs(value) for value in values[:3]) > 10 or not 0.25 < length < 4:
        raise ValueError("at: is no pose: x:y:z in metres and a quaternion w:x:y:z")
    return values


def kept(state: State) -> dict[str, Any]:
    """What the browser keeps: settings and how things are shown, but no scene."""
    picture = state.picture
    return {
        "setup": differences(state.setup),
        "shown": sorted(state.shown),
        "opacity": picture.opacity,
        "colours": picture.colours,
        "marks": sorted(picture.marks),
        "speed": state.speed,
        "loop": state.loop,
    }


def take_up(state: State, found: Mapping[str, Any]) -> State:
    """The state with what a browser says that it kept; each part that makes no sense is left as shipped."""
    try:
        setup = decoded(found.get("setup") or {})
    except (ValueError, TypeError):
        setup = DEFAULT
    picture = Picture()
    opacity, colours, speed = found.get("opacity"), found.get("colours"), found.get("speed")
    if isinstance(opacity, int | float) and 0 <= opacity <= 1:
        picture = replace(picture, opacity=float(opacity))
    if isinstance(colours, str) and len(colours) < 20:
        picture = replace(picture, colours=colours)
    marks = found.get("marks")
    if isinstance(marks, list):
        picture = replace(picture, marks=frozenset(mark for mark in MARKS if mark in marks))
    shown = found.get("shown")
    layers = frozenset(layer for layer in LAYERS if layer in shown) if isinstance(shown, list) else state.shown
    return replace(
        state,
        setup=setup,
        picture=picture,
        shown=layers,
        speed=speed if speed in SPEEDS else state.speed,
        loop=found.get("loop") is True,
    )
