"""A place's scores over the angle φ as a polar plot, drawn as the image is: 0° points right, 90° up."""

from __future__ import annotations

import math

from workbench import colours
from workbench.inspector.orders import Place

_RADIUS = 60.0


def _at(angle: float, score: float) -> tuple[float, float]:
    return _RADIUS * score * math.cos(angle), -_RADIUS * score * math.sin(angle)


def plot(place: Place, threshold: float, yaw: float = 0.0) -> str:
    """The scores of a place; SVG. A closing axis is a line, so each score stands at φ and at φ + 180°.

    Args:
        place: with its scores.
        threshold: t, drawn as a ring.
        yaw: of the canvas in the world, rad.
    """
    scores = place.scores
    assert scores is not None
    rings = "".join(f'<circle r="{_RADIUS * share}"/>' for share in (0.5, 1.0))
    names = "".join(
        f'<text x="{x}" y="{y}" text-anchor="{anchor}">{name}</text>'
        for x, y, anchor, name in (
            (_RADIUS + 3, 3, "start", "0°"), (0, -_RADIUS - 4, "middle", "90°"), (_RADIUS * 0.5, -2, "middle", "½"),
        )
    )  # fmt: skip
    turns = [(candidate.grasp.angle - yaw, min(max(candidate.score, 0.0), 1.0)) for candidate in scores.candidates]
    ring = sorted([(a % (2 * math.pi), s) for a, s in turns] + [((a + math.pi) % (2 * math.pi), s) for a, s in turns])
    outline = " ".join("{:.1f},{:.1f}".format(*_at(angle, score)) for angle, score in ring)
    dots = []
    for index, ((angle, score), free) in enumerate(zip(turns, scores.reachable, strict=True)):
        colour = colours.css(colours.score(score)) if free else "none"
        said = f"φ {math.degrees(angle + yaw):.0f}°: {score:.2f}" + (
            "" if free else ", the gripper would meet something"
        )
        for turn in (angle, angle + math.pi):
            x, y = _at(turn, score)
            size = 3.4 if index == scores.best else 2.1
            dots.append(
                f'<circle class="gw-dot" data-free="{int(bool(free))}" cx="{x:.1f}" cy="{y:.1f}" r="{size}"'
                f' fill="{colour}"><title>{said}</title></circle>'
            )
    return (
        f'<svg class="gw-polar" data-angles="{len(turns)}" viewBox="-78 -74 162 148"><g class="gw-rings">{rings}'
        f'<circle class="gw-least" r="{_RADIUS * threshold:.1f}"><title>t = {threshold:g}</title></circle></g>{names}'
        f'<polygon points="{outline}"/>{"".join(dots)}</svg>'
    )


def words(place: Place) -> str:
    """What is known of a place, in a sentence or two."""
    depth = "not measured (filled in)" if place.depth is None else f"{place.depth:.3f} m from above"
    told = f"Depth {depth}, heat {place.heat:.2f}."
    scores = place.scores
    if scores is None:
        return told
    height = round(1000 * scores.height)
    where = f"{height} mm above the table" if height >= 2 else "bare table"
    told = f"Depth {depth}, {where}, heat {place.heat:.2f}."
    blocked = int((~scores.reachable).sum())
    if scores.best is None:
        return f"{told} The gripper reaches it at no angle: fingers or rod would meet what is seen."
    best = scores.candidates[scores.best]
    if best.score < 0.005:
        return f"{told} No angle scores above 0.00: there is nothing to hold here."
    told += f" Best score {best.score:.2f} at φ = {math.degrees(best.grasp.angle):.0f}°"
    return told + (
        f"; at {blocked} of {len(scores.candidates)} angles the gripper would meet something." if blocked else "."
    )
