"""The cross-check over a list of objects: resumable, in parallel, with tables and a picture of each disagreement."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

import cv2
import msgspec
import numpy as np
from numpy.typing import NDArray

from grasp_core.errors import GraspError
from grasp_core.evaluation.seeds import child_seed
from grasp_core.evaluation.suites import PlannedObject, poses_of
from grasp_core.grasp import Grasp
from grasp_core.gripper import Gripper
from grasp_core.parallel import Executor, map_scenes
from grasp_core.scene import Scene
from grasp_core.simulation.crosscheck import ENGINES, Agreement, Judge, agree, correlation, open_grasps
from grasp_core.simulation.filmstrip import filmstrip
from grasp_core.simulation.physics import Physics

_CHUNK = 50
"""Grasps that are judged between two lines of the log."""
_LOG = "verdicts.jsonl"
_TRIED = 5
"""Grasps of a class of disagreement that are filmed at most."""


class Plan(msgspec.Struct, frozen=True):
    """What is compared.

    Attributes:
        objects: names, in order.
        engines: of `ENGINES`, without "dart".
        grasps: noiseless ones an object that need dynamics, spread over its poses.
        poses: stable poses an object, at most.
        noisy: grasps an object whose qualities are compared between DART and MuJoCo.
        attempts: executions of each of those.
        seed: of the choice of grasps and the noise.
        physics: digest.
        gripper: digest.
    """

    objects: tuple[str, ...]
    engines: tuple[str, ...]
    grasps: int
    poses: int
    noisy: int
    attempts: int
    seed: int
    physics: str
    gripper: str


class Line(msgspec.Struct, frozen=True):
    """One line of the log: some grasps on one pose in one engine.

    Attributes:
        object: name.
        pose: index of the stable pose.
        engine: of `ENGINES`.
        start: number of the first grasp on this pose.
        outcomes: noiseless verdicts, or none.
        qualities: with noise, or none.
    """

    object: str
    pose: int
    engine: str
    start: int
    outcomes: tuple[str, ...] = ()
    qualities: tuple[float, ...] = ()

    @property
    def key(self) -> tuple[str, int, str, int, bool]:
        """What tells one piece of work from another."""
        return self.object, self.pose, self.engine, self.start, bool(self.qualities)


class Work(msgspec.Struct, frozen=True):
    """One piece of work for a process."""

    source: PlannedObject
    pose: int
    engine: str
    start: int
    noisy: bool
    plan: Plan
    gripper: Gripper
    physics: Physics

    @property
    def key(self) -> tuple[str, int, str, int, bool]:
        """That of the line it makes."""
        return self.source.name, self.pose, self.engine, self.start, self.noisy


class Comparison(msgspec.Struct, frozen=True):
    """One engine against DART.

    Attributes:
        words: what the engine is.
        goal: least agreement.
        all: over every grasp.
        objects: name → agreement on it.
        pictures: class of disagreement ("ONE→OTHER") → file.
    """

    words: str
    goal: float
    all: Agreement
    objects: dict[str, Agreement]
    pictures: dict[str, str]


class Crosscheck(msgspec.Struct, frozen=True):
    """The report.

    Attributes:
        engines: name → how it compares with DART.
        quality_correlation: of DART's and MuJoCo's qualities under Eq. 4 noise; None if not measured.
        quality_difference: mean absolute difference of those.
        qualities: how many grasps that is.
    """

    engines: dict[str, Comparison]
    quality_correlation: float | None
    quality_difference: float | None
    qualities: int


def _scene(work: Work) -> tuple[Scene, list[Grasp]]:
    """The scene, and the grasps that are judged on it."""
    asset = work.source.make()
    poses = poses_of(asset, work.physics)[: work.plan.poses]
    if work.pose >= len(poses):
        return Scene.single(asset, poses[0].pose), []
    scene = Scene.single(asset, poses[work.pose].pose)
    share = _share(work.plan.noisy if work.noisy else work.plan.grasps, len(poses), work.pose)
    seed = child_seed(work.plan.seed, "crosscheck", work.source.name, work.pose, int(work.noisy))
    return scene, open_grasps(scene, work.gripper, work.physics, share, seed)


def _share(total: int, parts: int, index: int) -> int:
    return total // parts + (index < total % parts)


def judge(work: Work) -> Line:
    """Judge one chunk of grasps in one engine."""
    scene, grasps = _scene(work)
    chunk = grasps[work.start : work.start + _CHUNK]
    name, pose, engine, start, _ = work.key
    if not chunk:
        return Line(name, pose, engine, start)
    judge_ = Judge(engine, scene, work.gripper, work.physics)
    if not work.noisy:
        return Line(name, pose, engine, start, outcomes=tuple(str(judge_.verdict(grasp)) for grasp in chunk))
    seeds = [child_seed(work.plan.seed, "crosscheck noise", name, pose, start + number) for number in range(len(chunk))]
    qualities = [judge_.quality(grasp, work.plan.attempts, seed) for grasp, seed in zip(chunk, seeds, strict=True)]
    return Line(name, pose, engine, start, qualities=tuple(qualities))


def run_crosscheck(
    sources: Sequence[PlannedObject],
    plan: Plan,
    gripper: Gripper,
    physics: Physics,
    out: Path,
    executor: Executor | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Crosscheck:
    """Judge everything that the log in `out` does not hold yet, then compare and draw.

    Raises:
        GraspError: an unknown engine, or `out` holds the log of another comparison.
    """
    unknown = [name for name in plan.engines if name not in ENGINES]
    if unknown:
        raise GraspError(f"'{unknown[0]}' is no engine; choose from: {', '.join(ENGINES)}")
    lines = _open_log(out, plan)
    works = [
        Work(source, pose, engine, start, noisy, plan, gripper, physics)
        for source in sources
        for noisy in (False, True)
        for pose in range(plan.poses)
        for engine in (("dart", "mujoco") if noisy else ("dart", *plan.engines))
        for start in range(0, plan.noisy if noisy else plan.grasps, _CHUNK)
    ]
    known = {line.key for line in lines} | {(*line.key[:4], True) for line in lines if not line.outcomes}
    left = [work for work in works if work.key not in known]
    progress(len(works) - len(left), len(works))
    with (out / _LOG).open("ab") as log:
        for number, (_, line) in enumerate(map_scenes(judge, left, executor), 1):
            log.write(msgspec.json.encode(line) + b"\n")
            log.flush()
            lines.append(line)
            progress(len(works) - len(left) + number, len(works))
    return _report(sources, plan, gripper, physics, lines, out)


def _open_log(out: Path, plan: Plan) -> list[Line]:
    """The lines of an earlier run of the same plan; a new log begins with the plan."""
    out.mkdir(parents=True, exist_ok=True)
    path = out / _LOG
    if not path.exists() or not path.read_bytes().strip():
        path.write_bytes(msgspec.json.encode(plan) + b"\n")
        return []
    head, *rest = path.read_bytes().splitlines()
    try:
        same = msgspec.json.decode(head, type=Plan) == plan
    except msgspec.DecodeError:
        same = False
    if not same:
        raise GraspError(f"{path}: belongs to another comparison; give another --out or remove that file")
    lines = []
    for line in rest:
        try:
            lines.append(msgspec.json.decode(line, type=Line))
        except msgspec.DecodeError:  # the last line of a run that was killed
            continue
    path.write_bytes(b"\n".join([head, *(msgspec.json.encode(line) for line in lines)]) + b"\n")
    return lines


def _report(
    sources: Sequence[PlannedObject], plan: Plan, gripper: Gripper, physics: Physics, lines: Sequence[Line], out: Path
) -> Crosscheck:
    verdicts: dict[str, dict[tuple[str, int, int], str]] = {name: {} for name in ("dart", *plan.engines)}
    qualities: dict[str, dict[tuple[str, int, int], float]] = {"dart": {}, "mujoco": {}}
    for line in lines:
        for number, outcome in enumerate(line.outcomes):
            verdicts[line.engine][line.object, line.pose, line.start + number] = outcome
        for number, quality in enumerate(line.qualities):
            qualities[line.engine][line.object, line.pose, line.start + number] = quality
    keys = sorted(verdicts["dart"])
    if not keys:
        raise GraspError("no grasp on these objects needs dynamics; take other objects or more grasps")
    engines = {}
    for name in plan.engines:
        other = verdicts[name]

        def compare(chosen: list[tuple[str, int, int]], other: dict[tuple[str, int, int], str] = other) -> Agreement:
            return agree([verdicts["dart"][key] for key in chosen], [other[key] for key in chosen])

        by_object = {source.name: [key for key in keys if key[0] == source.name] for source in sources}
        engines[name] = Comparison(
            ENGINES[name].words,
            ENGINES[name].goal,
            compare(keys),
            {source: compare(mine) for source, mine in by_object.items() if mine},
            _draw(sources, plan, gripper, physics, verdicts["dart"], other, name, out),
        )
    both = sorted(set(qualities["dart"]) & set(qualities["mujoco"]))
    first, second = ([qualities[name][key] for key in both] for name in ("dart", "mujoco"))
    return Crosscheck(
        engines,
        round(correlation(first, second), 4) if both else None,
        round(float(np.abs(np.subtract(first, second)).mean()), 4) if both else None,
        len(both),
    )


def _draw(
    sources: Sequence[PlannedObject],
    plan: Plan,
    gripper: Gripper,
    physics: Physics,
    first: dict[tuple[str, int, int], str],
    second: dict[tuple[str, int, int], str],
    name: str,
    out: Path,
) -> dict[str, str]:
    """One picture per class of disagreement on success: both engines' films of one grasp, one above the other.

    It is of the object with most of that class. Films show the whole lift, which may end otherwise than a lift that
    stopped early: the first of a few grasps is taken whose films end as they were judged, else the first one.
    """
    classes: dict[str, list[tuple[str, int, int]]] = {}
    for key in sorted(first):
        if (first[key] == "SUCCESS") != (second[key] == "SUCCESS"):
            classes.setdefault(f"{first[key]}→{second[key]}", []).append(key)
    pictures: dict[str, str] = {}
    for words, keys in classes.items():
        worst = Counter(key[0] for key in keys).most_common(1)[0][0]
        source = next(source for source in sources if source.name == worst)
        strips: list[NDArray[np.uint8]] = []
        for key in [key for key in keys if key[0] == worst][:_TRIED]:
            scene, grasps = _scene(Work(source, key[1], name, 0, False, plan, gripper, physics))
            verdicts = {"dart": first[key], name: second[key]}
            films = {engine: Judge(engine, scene, gripper, physics).record(grasps[key[2]]) for engine in verdicts}
            as_judged = all(films[engine].outcome == verdict for engine, verdict in verdicts.items())
            if not strips or as_judged:
                strips = [
                    filmstrip(
                        [placed.asset for placed in scene.objects],
                        gripper,
                        film,
                        title=f"{engine} on {worst}, judged {verdicts[engine]}; {film.outcome}: {film.words}",
                    )
                    for engine, film in films.items()
                ]
            if as_judged:
                break
        width = max(strip.shape[1] for strip in strips)
        padded = [np.pad(strip, ((0, 0), (0, width - strip.shape[1]), (0, 0)), constant_values=255) for strip in strips]
        path = out / f"{name}_{words.replace('→', '_')}.png"
        cv2.imwrite(str(path), np.vstack(padded))
        pictures[words] = str(path)
    return pictures
