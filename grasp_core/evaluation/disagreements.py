"""Where two engines disagree: each class of it counted, filmed in both engines and put into words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path

import cv2
import msgspec
import numpy as np

from grasp_core.evaluation.verdicts import REFERENCE
from grasp_core.grasp import Grasp
from grasp_core.gripper import Gripper
from grasp_core.scene import Scene
from grasp_core.simulation.crosscheck import Judge
from grasp_core.simulation.evidence import Outcome
from grasp_core.simulation.filmstrip import filmstrip
from grasp_core.simulation.physics import Physics
from grasp_core.simulation.recording import Recording

Key = tuple[str, int, int]
"""Object, stable pose, number of the grasp."""
_TRIED = 5
"""Grasps of a class of disagreement that are filmed at most."""


class Disagreement(msgspec.Struct, frozen=True):
    """One class: grasps that DART calls one thing and another engine another.

    Attributes:
        count: how many.
        objects: name → how many on it, most first.
        words: engine → outcome and evidence of its film.
        as_judged: whether both films end as the grasp was judged. They show the whole lift, while the verdict may come
            from one that stopped early.
        filmed: grasps that were filmed for it; the picture shows the last one if its films end as judged, else the
            first.
        picture: file.
    """

    count: int
    objects: dict[str, int]
    words: dict[str, str]
    as_judged: bool
    filmed: int
    picture: str


def disagreements(
    first: Mapping[Key, str],
    second: Mapping[Key, str],
    engine: str,
    grasp_of: Callable[[Key], tuple[Scene, Grasp]],
    gripper: Gripper,
    physics: Physics,
    out: Path,
) -> dict[str, Disagreement]:
    """Count and draw every class of different outcomes; diverged executions are no verdicts and left out.

    A picture holds both engines' films of one grasp, one above the other, on the object with most of that class.

    Args:
        first: DART's outcomes.
        second: the other engine's, of the same grasps.
        engine: the other's name.
        grasp_of: finds a grasp and its scene again.
        gripper: that executed.
        physics: of both.
        out: folder of the pictures.

    Returns:
        "ONE→OTHER" → what there is of it.
    """
    classes: dict[tuple[str, str], list[Key]] = {}
    for key in sorted(first):
        pair = first[key], second[key]
        if pair[0] != pair[1] and Outcome.UNSTABLE not in pair:
            classes.setdefault(pair, []).append(key)
    found = {}
    for (one, other), keys in sorted(classes.items()):
        objects = dict(Counter(key[0] for key in keys).most_common())
        tried = [key for key in keys if key[0] == next(iter(objects))][:_TRIED]
        verdicts = {REFERENCE: one, engine: other}
        kept: tuple[Scene, dict[str, Recording]] | None = None
        filmed, as_judged = 0, False
        while filmed < len(tried) and not as_judged:
            scene, grasp = grasp_of(tried[filmed])
            films = {name: Judge(name, scene, gripper, physics).record(grasp) for name in verdicts}
            as_judged = all(films[name].outcome == verdict for name, verdict in verdicts.items())
            kept = (scene, films) if as_judged or kept is None else kept
            filmed += 1
        assert kept is not None
        scene, films = kept
        path = out / f"{engine}_{one}_{other}.png"
        _draw(path, scene, gripper, films, verdicts, as_judged)
        words = {name: f"{film.outcome}: {film.words}" for name, film in films.items()}
        found[f"{one}→{other}"] = Disagreement(len(keys), objects, words, as_judged, filmed, str(path))
    return found


def _draw(
    path: Path,
    scene: Scene,
    gripper: Gripper,
    films: Mapping[str, Recording],
    verdicts: Mapping[str, str],
    as_judged: bool,
) -> None:
    note = "" if as_judged else "NO FILM TRIED ENDS AS JUDGED - "
    assets = [placed.asset for placed in scene.objects]
    name = scene.objects[0].asset.name
    strips = []
    for engine, film in films.items():
        title = f"{note}{engine} on {name}, judged {verdicts[engine]}; film {film.outcome}: {film.words}"
        strips.append(filmstrip(assets, gripper, film, title=title))
    width = max(strip.shape[1] for strip in strips)
    padded = [np.pad(strip, ((0, 0), (0, width - strip.shape[1]), (0, 0)), constant_values=255) for strip in strips]
    cv2.imwrite(str(path), np.vstack(padded))
