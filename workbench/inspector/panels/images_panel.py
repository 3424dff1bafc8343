"""The panel of what the planner sees: the image with everything on it, the selected crop, and the place asked about."""

from __future__ import annotations

import math

from grasp_core.planning.planner import needs_networks
from workbench import colours
from workbench.actions import Action
from workbench.bridge import Bridge, Reader
from workbench.casting import put, text
from workbench.inspector import actions as a
from workbench.inspector import images, polar
from workbench.inspector.state import MARKS, State

_MARK_NAMES = {
    "rectangles": ("grasps", "candidates: thin along the opening, thick where the fingers stand"),
    "region": ("region", "where grasps are sampled: within R of the best place of the quality map"),
    "samples": ("samples", "the sampled pixels"),
}


def _pair(argument: str) -> tuple[float, float]:
    first, second = (float(part) for part in argument.split(","))
    if not (math.isfinite(first) and math.isfinite(second)):
        raise ValueError(argument)
    return first, second


def _share(argument: str) -> float:
    value = float(argument)
    if not 0 <= value <= 1:
        raise ValueError(argument)
    return value


def _range(argument: str) -> Action:
    near, far = sorted(_share(part) for part in argument.split(","))
    return a.DepthRange(near, far)


def _mark(argument: str) -> Action:
    for mark in MARKS:
        if mark == argument:
            return a.ToggleMark(mark)
    raise ValueError(argument)


def _colours(argument: str) -> Action:
    if argument not in colours.DEPTH_MAPS:
        raise ValueError(argument)
    return a.DepthColours(argument)


READERS: dict[str, Reader] = {
    "ask": lambda argument: a.AskPlace(*_pair(argument)),
    "overlay": lambda argument: a.Overlay(_share(argument)),
    "range": _range,
    "mark": _mark,
    "colours": _colours,
}


_ABOVE = (
    "What planners look at: the depth image as a camera sees it that stands straight above the things, 0.70 m above "
    "the table, whatever your camera's place; your camera's own pixels (u, v) and depths (d) stand beside each grasp"
)


_MAPPED = "made around what stands on the table and is seen as a whole; of the rest of the image it is not asked for"


def selection(state: State) -> str:
    """A style sheet that marks the selected candidate in list and image, so that neither is sent anew."""
    if state.choice is None:
        return "<style></style>"
    name = f"{state.choice.side}-{state.choice.index}"
    return (
        f"<style>.gw-c{name} polygon{{stroke:#fff;stroke-width:1.4;stroke-opacity:1;fill:rgba(255,255,255,.12)}}"
        f".gw-c{name} path{{stroke:#fff;stroke-width:3}}.gw-c{name} text{{display:block}}"
        f".gw-list .gw-row{name} td{{background:var(--gw-chosen)}}</style>"
    )


def views(state: State, bridge: Bridge) -> str:
    """The image of each plan; HTML."""
    scene = state.scene
    if scene is None:
        told = "The image comes with the first plan." if state.failure is None else "There is no image."
        return f'<div class="gw-empty">{told}</div>'
    parts = []
    several = len(scene.sight.plans) > 1
    for side, (name, plan) in enumerate(zip(scene.setup.planners, scene.sight.plans, strict=True)):
        caption = ""
        if several:
            count = "no plan" if plan is None else f"{len(plan.candidates)} in {plan.total_ms:.0f} ms"
            on = ' class="gw-looked"' if side == state.side else ""
            caption = f"<figcaption{on} {bridge.onclick(f'look:{side}')}><b>{text(name)}</b> {count}</figcaption>"
        if plan is None:
            shown = f'<div class="gw-error">{text(scene.sight.failures[side])}</div>'
        else:
            shown = images.canvas(state, side, bridge)
        parts.append(f"<figure>{caption}{shown}</figure>")
    look = "gw-views gw-two" if several else "gw-views"
    return f'<div class="{look}">{"".join(parts)}</div>'


def legend(state: State) -> str:
    """What the colours of the image mean; HTML."""
    plan = state.plan
    if plan is None:
        return ""
    near, far = images.depth_range(state, plan)
    depth = (
        f'<div class="gw-legend"><span>{far:.3f} m</span><i style="background:'
        f'{colours.depth_gradient(state.picture.colours)}"></i><span>{near:.3f} m</span>'
    )
    if not plan.quality_map.any():
        return depth + "<span>no quality map</span></div>"
    top = colours.heat_top(plan.quality_map)
    return depth + (
        f'<span class="gw-gap" title="{_MAPPED}">quality 0</span><i style="background:{colours.heat_gradient()}"></i>'
        f"<span>{top:.2f}</span></div>"
    )


def controls(state: State, bridge: Bridge) -> str:
    """Opacity, marks, colours and range; HTML."""
    picture = state.picture
    marks = "".join(
        bridge.button(
            _MARK_NAMES[mark][0],
            f"mark:{mark}",
            hint=_MARK_NAMES[mark][1],
            look="gw-on" if mark in picture.marks else "",
            more=f'data-mark="{mark}" aria-pressed="{str(mark in picture.marks).lower()}"',
        )
        for mark in MARKS
    )
    live = "document.querySelectorAll('.gw-heat').forEach(e=>e.style.opacity=this.value)"
    options = "".join(
        f"<option{' selected' if name == picture.colours else ''}>{name}</option>" for name in colours.DEPTH_MAPS
    )
    send = "gwSend('range:'+[...this.closest('.gw-bar').querySelectorAll('input')].map(e=>e.value).join(','))"
    limits = "".join(
        f'<label title="{hint}">{name}<input type="range" min="0" max="1" step="0.02" value="{value:g}" '
        f'aria-label="depth {name}" onchange="{send}"></label>'
        for name, value, hint in (
            ("from", picture.near, "nearest depth of the colours, as a share of the image's depths"),
            ("to", picture.far, "farthest depth of the colours"),
        )
    )
    return (
        f'<div class="gw-bar gw-small"><label title="opacity of the quality map over the depth">quality map'
        f'<input type="range" min="0" max="1" step="0.05" value="{picture.opacity:g}" aria-label="opacity" '
        f'{bridge.onslide("overlay", live)}></label><span class="gw-marks">{marks}</span></div>'
        f'<div class="gw-bar gw-small"><label class="gw-tight">depth<select aria-label="depth colours" '
        f"{bridge.onchoice('colours')}>{options}</select></label>{limits}</div>"
    )


def speed(state: State) -> str:
    """How fast the plan follows a drag; HTML."""
    if state.live is None or not state.dragging:
        return (
            "" if state.scene is None or not state.request.things else "<span>drag the gizmo: the plan follows</span>"
        )
    rate = "" if state.live.rate is None else f"{state.live.rate:.1f}/s · "
    return f'<span data-live="1">{rate}{state.live.latency_ms:.0f} ms behind</span>'


def detail(state: State) -> str:
    """The crop of the selected candidate, and the place that was asked about; HTML."""
    return f'<div class="gw-detail"><div>{_crop(state)}</div><div>{_asked(state)}</div></div>'


def _crop(state: State) -> str:
    candidate, scene, choice = state.candidate, state.scene, state.choice
    hint = "What the Refined Network sees: depth round the grasp, turned so that the fingers close left to right"
    judged = state.scene is None or choice is None or needs_networks(state.scene.setup.planners[choice.side])
    title = f'<h4 title="{hint}">{"The network saw" if judged else "Around the grasp"}</h4>'
    if candidate is None or scene is None or choice is None:
        return f'{title}<div class="gw-empty">No candidate is selected.</div>'
    crops = scene.sight.crops[choice.side]
    if crops is None:
        shown = '<div class="gw-empty">The weights are for another gripper: the network sees nothing here.</div>'
    else:
        shown = images.crop_picture(crops[choice.index], scene.sight.context)
    seen = candidate.image
    told = (
        f"<b>{choice.index + 1}</b> score <b>{candidate.score:.3f}</b><br>camera u {seen.u:.0f} v {seen.v:.0f}"
        f"<br>d {seen.depth:.3f} m<br>φ {math.degrees(candidate.grasp.angle):.0f}°,"
        f" w {1000 * candidate.grasp.width:.0f} mm"
    )
    return f'{title}<div class="gw-seen">{shown}<small>{told}</small></div>'


def _asked(state: State) -> str:
    place = state.place
    title = '<h4 title="Score of one place over all angles">Why not here?</h4>'
    if place is None:
        return f'{title}<div class="gw-empty">Click any free pixel of the image: its score over all angles.</div>'
    plan = state.plan
    if place.failed:
        shown = f'<div class="gw-error">{text(place.failed)}</div>'
    elif place.scores is None or plan is None:
        shown = '<div class="gw-empty"><span class="gw-spin"></span>Scoring all angles …</div>'
    else:
        shown = polar.plot(place, state.setup.threshold, images.canvas_yaw(plan.canvas.camera))
    return f'{title}<div class="gw-seen" data-place="{place.u:.0f},{place.v:.0f}">{shown}</div>'


class ImagesPanel:
    """Everything that the planner saw and thought of the shown scene."""

    def __init__(self, bridge: Bridge) -> None:
        self._bridge = bridge
        self._selection = bridge.html("<style></style>")
        self._head = bridge.html()
        self._views = bridge.html()
        self._controls = bridge.html()
        self._detail = bridge.html()

    def update(self, old: State | None, new: State) -> None:
        """Show `new`; the pictures are sent when something on them changed only."""
        put(self._selection, content=selection(new))
        put(self._head, content=f'<div class="gw"><h3 title="{_ABOVE}">Seen from above {speed(new)}</h3></div>')
        if old is None or _on_image(old) != _on_image(new):
            put(self._views, content=f'<div class="gw">{views(new, self._bridge)}{legend(new)}</div>')
        put(self._controls, content=f'<div class="gw">{controls(new, self._bridge)}</div>')
        if old is None or _in_detail(old) != _in_detail(new):
            asked = "" if new.place is None else f'<div class="gw-asked">{text(polar.words(new.place))}</div>'
            put(self._detail, content=f'<div class="gw">{detail(new)}{asked}</div>')


def _on_image(state: State) -> tuple[object, ...]:
    picture = (state.picture.colours, state.picture.near, state.picture.far, state.picture.marks)
    physics = (state.by_physics, state.trials if state.by_physics else None)
    # The opacity is not among them: the page changes it by itself.
    return id(state.scene), state.dragging, state.least, state.side, id(state.place), state.failure, picture, physics


def _in_detail(state: State) -> tuple[object, ...]:
    return id(state.scene), state.choice, id(state.place), state.setup.threshold
