"""The panel of the scene: which objects, how they lie, moving them, what is switched on."""

from __future__ import annotations

from collections.abc import Callable

from workbench.actions import Action
from workbench.bridge import Bridge, Reader
from workbench.casting import brief, put, sentence, text
from workbench.inspector import actions as a
from workbench.inspector.draws import draw
from workbench.inspector.orders import Catalogue
from workbench.inspector.state import LAYERS, Layer, State

OWN = "(own or several)"
"""Stands in the dropdown of families where the scene is not one object of the catalogue."""
_FACTS = "size; which stable pose, and the share of drops that end so; click: hold it with the gizmo"
_LAYER_NAMES = {
    "candidates": ("grasps", "all candidates as small grippers"),
    "camera": ("camera", "the camera and what it sees"),
    "contacts": ("forces", "contact forces during a replay"),
    "frames": ("frames", "axes of world, camera and selected grasp: x red, y green, z blue"),
    "grid": ("grid", "cells of 5 cm"),
    "points": ("points", "what the camera measured, as points"),
}


def _layer(argument: str) -> Action:
    for layer in LAYERS:
        if layer == argument:
            return a.Toggle(layer)
    raise ValueError(argument)


def _mode(argument: str) -> Action:
    if argument == "slide":
        return a.DragMode("slide")
    if argument == "free":
        return a.DragMode("free")
    raise ValueError(argument)


READERS: dict[str, Reader] = {
    "object": lambda argument: a.AnotherObject(draw()),
    "pose": lambda argument: a.AnotherPose(),
    "random": lambda argument: a.RandomScene(draw()),
    "several": lambda argument: a.RandomScene(draw(), 3),
    "add": lambda argument: a.AddObject(draw()),
    "settle": lambda argument: a.Settle(),
    "mode": _mode,
    "grab": lambda argument: a.Grab(int(argument)),
    "show": _layer,
}


def family_label(family: str) -> str:
    """A family's name for people."""
    return family.replace("_", " ").strip()


def family_of(state: State) -> str:
    """The family that the scene is of, "" where it is not one object of the catalogue."""
    things = state.request.things
    family = things[0].name.rpartition("_")[0] if len(things) == 1 else ""
    return family if family in state.catalogue.families else ""


def layers(state: State, bridge: Bridge) -> str:
    """What is switched on in the scene, as buttons; HTML."""
    buttons = (
        bridge.button(
            _LAYER_NAMES[layer][0],
            f"show:{layer}",
            hint=_LAYER_NAMES[layer][1],
            look="gw-on" if layer in state.shown else "",
            more=f'data-layer="{layer}" aria-pressed="{str(layer in state.shown).lower()}"',
        )
        for layer in LAYERS
    )
    return f'<div class="gw-bar gw-small">{"".join(buttons)}</div>'


def moving(state: State, bridge: Bridge) -> str:
    """How the gizmo moves objects, and letting them go; HTML."""
    off = not state.request.things

    def mode(name: str, label: str, hint: str) -> str:
        on = state.mode == name
        more = f'aria-pressed="{str(on).lower()}"'
        return bridge.button(label, f"mode:{name}", hint=hint, look="gw-on" if on else "", off=off, more=more)

    busy = '<span class="gw-spin"></span>' if state.settling else ""
    settle = bridge.button(
        f"{busy}Settle in DART",
        "settle:",
        hint="let all objects go until they rest (X)",
        look="gw-main" if state.loose else "",
        off=off or state.settling,
    )
    slide = mode("slide", "Slide", "drag the gizmo: along the table and about the vertical (V)")
    free = mode("free", "Move freely", "drag the gizmo: anywhere, any turn; then let it settle (V)")
    return f'<div class="gw-bar gw-small">{slide}{free}{settle}</div>'


def facts(state: State, bridge: Bridge) -> str:
    """What is shown, in one or two short lines; HTML."""
    if state.opening and not state.dragging and (state.scene is None or state.live is None):
        doing = "Making and planning the first scene" if state.scene is None else "Making and planning"
        return f'<span class="gw-spin"></span>{doing} …'
    if state.failure is not None:
        left = "" if state.scene is None else "<br><small>What is shown is the scene before.</small>"
        return f'<div class="gw-error">{text(brief(sentence(state.failure)))}{left}</div>'
    if state.scene is None:
        return ""
    if state.request.photo is not None:
        name = next((item.name for item in state.items if item.key == state.request.photo.key), "own image")
        k = state.scene.sight.image.camera.intrinsics
        return f"<b>{text(name)}</b> · {k.width} × {k.height} px<br><small>own depth image, no physics</small>"
    lines = []
    for index, (placed, rest) in enumerate(zip(state.scene.scene.objects, state.scene.rests, strict=True)):
        size = " × ".join(f"{1000 * side:.0f}" for side in placed.asset.extents)
        if index < len(state.request.things) and state.request.things[index].loose:
            how = "not at rest"
        elif rest.pose is None:
            how = "at rest in a pose that it seldom ends in"
        else:
            how = f"pose {rest.pose + 1}/{len(rest.poses)}, {100 * rest.poses[rest.pose][1]:.0f} %"
        held = len(state.scene.scene.objects) > 1 and index == state.grabbed
        look = ' class="gw-held"' if held else ""
        lines.append(
            f'<div{look} {bridge.onclick(f"grab:{index}")} title="{_FACTS}"><b>{text(placed.asset.name)}</b>'
            f"<small>· {size} mm · {how}</small></div>"
        )
    return "".join(lines)


class ScenePanel:
    """Widgets that choose and move the scene."""

    def __init__(self, bridge: Bridge, catalogue: Catalogue, state: State) -> None:
        self._bridge = bridge
        self._names = {family_label(family): family for family in catalogue.families}
        shown = family_label(family_of(state)) or OWN
        self._object = bridge.dropdown(
            "Object",
            (OWN, *self._names),
            shown,
            lambda label: a.ShowObject(f"{self._names[label]}_000") if label in self._names else a.RandomScene(draw()),
            "Families of household shapes made from parameters",
        )
        buttons = (
            bridge.button("Another object", "object:", hint="the next family, a new shape (O)"),
            bridge.button("Another pose", "pose:", hint="the same object, resting in another way (P)"),
            bridge.button("Random", "random:", hint="any object, pose and place (R)"),
            bridge.button("Three", "several:", hint="three random objects"),
            bridge.button("+", "add:", hint="one more object"),
        )
        bridge.html(f'<div class="gw"><div class="gw-bar gw-small">{"".join(buttons)}</div></div>')
        self._facts = bridge.html()
        self._switches = bridge.html()
        bridge.command("Another object", "O", lambda: a.AnotherObject(draw()), "The next family, a new shape")
        bridge.command("Another pose", "P", a.AnotherPose, "The same object, resting in another way")
        bridge.command("Random scene", "R", lambda: a.RandomScene(draw()), "Any object, pose and place")
        bridge.command("Three random objects", None, lambda: a.RandomScene(draw(), 3), "Several objects on the table")
        bridge.command("Add an object", None, lambda: a.AddObject(draw()), "One more on the table")
        bridge.command("Slide or move freely", "V", a.DragMode, "How the gizmo moves objects")
        bridge.command("Settle in DART", "X", a.Settle, "Let all objects go until they rest")
        for layer in LAYERS:
            name, hint = _LAYER_NAMES[layer]
            bridge.command(f"Show or hide: {name}", None, _toggle(layer), hint[0].upper() + hint[1:])

    def update(self, old: State | None, new: State) -> None:
        """Show `new`."""
        put(self._object, value=family_label(family_of(new)) or OWN)
        put(self._facts, content=f'<div class="gw"><div class="gw-facts">{facts(new, self._bridge)}</div></div>')
        put(self._switches, content=f'<div class="gw">{moving(new, self._bridge)}{layers(new, self._bridge)}</div>')


def _toggle(layer: Layer) -> Callable[[], Action]:
    return lambda: a.Toggle(layer)
