"""The panel of the scene: which object, how it lies, which planner."""

from __future__ import annotations

from workbench.actions import Action
from workbench.bridge import Bridge, Reader
from workbench.casting import put, sentence, text
from workbench.inspector.actions import AnotherObject, AnotherPose, RandomScene, ShowObject, Toggle, UsePlanner
from workbench.inspector.draws import draw
from workbench.inspector.orders import LAYERS, Catalogue
from workbench.inspector.state import State


def _layer(argument: str) -> Action:
    for layer in LAYERS:
        if layer == argument:
            return Toggle(layer)
    raise ValueError(argument)


READERS: dict[str, Reader] = {
    "object": lambda argument: AnotherObject(draw()),
    "pose": lambda argument: AnotherPose(),
    "show": _layer,
    "random": lambda argument: RandomScene(draw()),
}


def family_label(family: str) -> str:
    """A family's name for people."""
    return family.replace("_", " ").strip()


def layers(state: State, bridge: Bridge) -> str:
    """What is switched on in the scene, as buttons; HTML."""
    names = {"candidates": "candidates", "camera": "camera", "contacts": "contact forces"}
    buttons = (
        bridge.button(
            names[layer],
            f"show:{layer}",
            look="gw-on" if layer in state.shown else "",
            more=f'aria-pressed="{str(layer in state.shown).lower()}"',
        )
        for layer in LAYERS
    )
    return f'<div class="gw-bar gw-layers"><small>show</small>{"".join(buttons)}</div>'


def facts(state: State) -> str:
    """What is shown, in one or two short lines; HTML."""
    if state.opening:
        family = text(family_label(state.request.family))
        doing = "Making and planning the first scene" if state.scene is None else f"Making and planning: {family}"
        return f'<span class="gw-spin"></span>{doing} …'
    if state.failure is not None:
        left = "" if state.scene is None else "<br><small>What is shown is the scene before.</small>"
        return f'<div class="gw-error">{text(sentence(state.failure))}{left}</div>'
    if state.scene is None:
        return ""
    opened = state.scene
    asset = opened.scene.objects[0].asset
    size = " × ".join(f"{100 * side:.1f}" for side in asset.extents)
    return (
        f"<b>{text(asset.name)}</b> · {size} cm<br><small>stable pose {opened.request.pose + 1} of {opened.poses}"
        f" (rests so in {100 * opened.probability:.0f} % of drops)</small>"
    )


class ScenePanel:
    """Widgets that choose the scene."""

    def __init__(self, bridge: Bridge, catalogue: Catalogue, state: State) -> None:
        self._bridge = bridge
        request = state.request
        self._names = {family_label(family): family for family in catalogue.families}
        self._object = bridge.dropdown(
            "Object",
            tuple(self._names),
            family_label(request.family),
            lambda label: ShowObject(self._names[label]),
            "Families of household shapes made from parameters",
        )
        buttons = (
            bridge.button("Another object", "object:", hint="the next family, a new shape (O)"),
            bridge.button("Another pose", "pose:", hint="the same object, resting in another way (P)"),
            bridge.button("Random scene", "random:", hint="any object, pose and place (R)"),
        )
        bridge.html(f'<div class="gw"><div class="gw-bar">{"".join(buttons)}</div></div>')
        self._facts = bridge.html()
        self._planner = bridge.dropdown(
            "Planner", catalogue.planners, request.planner, UsePlanner, "What plans the grasps from the depth image"
        )
        bridge.command("Another object", "O", lambda: AnotherObject(draw()), "The next family, a new shape")
        bridge.command("Another pose", "P", AnotherPose, "The same object, resting in another way")
        bridge.command("Random scene", "R", lambda: RandomScene(draw()), "Any object, pose and place")
        bridge.command("Show or hide the candidates", None, lambda: Toggle("candidates"), "The grippers in the scene")

    def update(self, old: State | None, new: State) -> None:
        """Show `new`."""
        put(self._object, value=family_label(new.request.family))
        put(self._planner, value=new.request.planner)
        told = f'<div class="gw-facts" data-facts="1">{facts(new)}</div>'
        put(self._facts, content=f'<div class="gw">{told}{layers(new, self._bridge)}</div>')
