"""The oracle: grasps that simulation itself has verified; they say which scenes are graspable and are the ceiling.

For a stable pose of an object the paper's grid of grasps is searched, positions nearest to the centre of mass first: a
noiseless attempt, then a few noisy ones, then a re-test with fresh seeds, which alone gives the quality. The search
ends when enough grasps are verified. Before it calls a pose ungraspable it has gone through the whole grid and through
one about twice as fine in positions and angles, because thin walls lie between the paper's positions. What is found
holds for every place and yaw of that pose on the table, and is cached by content: object, pose, gripper, physics, noise
and the code that simulates.

The limits: a grasp that lies between the finer grid's positions (1 cm apart on a 20 cm object) is not known to the
oracle; planners that succeed where it knows none are counted (`grasped_ungraspable`).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import msgspec
import numpy as np
from numpy.typing import NDArray

from grasp_core import config
from grasp_core.camera import canonical_camera
from grasp_core.dataset.generate import grid_grasps
from grasp_core.dataset.recipe import Recipe
from grasp_core.evaluation.cache import code_digest, remembered
from grasp_core.evaluation.seeds import child_seed
from grasp_core.grasp import Grasp
from grasp_core.gripper import Gripper
from grasp_core.objects.asset import ObjectAsset
from grasp_core.scene import Scene, place
from grasp_core.sensing.renderer import render
from grasp_core.simulation.physics import Physics
from grasp_core.simulation.trial import GraspNoise, GraspTrial, Trial

_BLOCK = 48
"""Grid grasps tried before looking whether enough are verified."""


class ScoredGrasp(msgspec.Struct, frozen=True):
    """A grasp in the world and how good its planner holds it."""

    grasp: Grasp
    score: float


class ScenePlanner(Protocol):
    """A planner that is told the true scene, as no planner on a robot is."""

    def __call__(self, scene: Scene, *, rng: np.random.Generator) -> Sequence[ScoredGrasp]:
        """Grasps for the scene, best first; none is a result."""
        ...


class OracleSettings(config.Settings):
    """How the oracle searches.

    Attributes:
        grid: positions along each side of the object's bounding rectangle.
        angles: closing axes at each position.
        finer: how many times as fine the grid is that is searched where this one holds no grasp; 1 searches no other.
        enough: verified grasps that end the search.
        attempts: noisy attempts before the re-test; one may fail.
        retest: attempts with fresh seeds that give the quality.
        least: quality from which on a grasp counts as verified and its scene as graspable.
    """

    grid: int = 11
    angles: int = 6
    finer: int = 2
    enough: int = 8
    attempts: int = 5
    retest: int = 10
    least: float = 0.8


class Verified(msgspec.Struct, frozen=True):
    """What the oracle knows of an object in a stable pose.

    Attributes:
        pose: 4×4 world_from_object, rows, in which the grasps are given.
        grasps: verified ones, best first; their score is the quality of the re-test.
        tried: grid grasps that were looked at.
        whole: whether nothing was left to look at.
    """

    pose: list[list[float]]
    grasps: tuple[ScoredGrasp, ...]
    tried: int
    whole: bool

    @property
    def graspable(self) -> bool:
        """Whether any grasp is known."""
        return bool(self.grasps)

    def placed(self, world_from_object: NDArray[np.float64]) -> list[ScoredGrasp]:
        """The grasps for the same stable pose elsewhere on the table, turned about the vertical."""
        moved = world_from_object @ np.linalg.inv(np.array(self.pose))
        yaw = math.atan2(moved[1, 0], moved[0, 0])
        found = []
        for item in self.grasps:
            x, y, z = moved[:3, :3] @ item.grasp.position + moved[:3, 3]
            found.append(ScoredGrasp(Grasp((x, y, z), item.grasp.angle + yaw, item.grasp.width), item.score))
        return found


class Oracle:
    """The ceiling as a scene planner: the verified grasps of the scene's object."""

    def __init__(self, verified: Verified, count: int = 5) -> None:
        self._verified = verified
        self._count = count

    def __call__(self, scene: Scene, *, rng: np.random.Generator) -> list[ScoredGrasp]:
        """The best verified grasps; `rng` is not needed."""
        return self._verified.placed(scene.objects[0].world_from_object)[: self._count]


_SETTINGS = OracleSettings()


def verified_grasps(
    asset: ObjectAsset,
    pose: NDArray[np.float64],
    gripper: Gripper,
    physics: Physics,
    noise: GraspNoise,
    settings: OracleSettings = _SETTINGS,
) -> Verified:
    """What the oracle knows of a stable pose (4×4), cached by content; see `search`."""
    key = [
        code_digest("simulation", "dataset/generate.py", "evaluation/oracle.py"),
        asset.digest,
        np.round(pose, 6).tolist(),
        gripper.digest,
        physics.digest,
        config.digest(noise),
        config.digest(settings),
    ]
    return remembered("oracle", key, Verified, lambda: search(asset, pose, gripper, physics, noise, settings))


def search(
    asset: ObjectAsset,
    pose: NDArray[np.float64],
    gripper: Gripper,
    physics: Physics,
    noise: GraspNoise,
    settings: OracleSettings = _SETTINGS,
) -> Verified:
    """Search the grid for verified grasps.

    Args:
        asset: the object.
        pose: 4×4, a stable pose resting on z = 0.
        gripper: what grasps.
        physics: of the attempts.
        noise: Eq. 4.
        settings: how much is tried.
    """
    upright = place(np.asarray(pose, float), 0.0, 0.0, 0.0)
    scene = Scene.single(asset, upright)
    image = render(scene, canonical_camera())
    exact, noisy = (GraspTrial(scene, gripper, physics, noise=kind) for kind in (None, noise))
    found: list[ScoredGrasp] = []
    tried, left = 0, 0
    for fine in dict.fromkeys((1, settings.finer)):
        if not found:
            recipe = Recipe(name="oracle", grid=fine * (settings.grid - 1) + 1, angles=fine * settings.angles)
            grasps = grid_grasps(scene.objects[0], image, gripper, recipe)
            seed = child_seed(0, "oracle", asset.digest, physics.digest, fine)
            looked = _search_grid(grasps, exact, noisy, settings, seed, found)
            tried, left = tried + looked, len(grasps) - looked
    found.sort(key=lambda item: -item.score)
    return Verified(upright.tolist(), tuple(found), tried, left == 0)


def _search_grid(
    grasps: list[Grasp],
    exact: GraspTrial,
    noisy: GraspTrial,
    settings: OracleSettings,
    seed: int,
    found: list[ScoredGrasp],
) -> int:
    """Add the verified ones of these grasps to `found` until they are enough; returns how many were looked at."""
    order = np.argsort([math.hypot(*grasp.position[:2]) for grasp in grasps], kind="stable")
    tried = 0
    while tried < len(order) and len(found) < settings.enough:
        block = [grasps[index] for index in order[tried : tried + _BLOCK]]
        passed = _passing(exact, block, 1, 1, child_seed(seed, "exact", tried))
        tried += len(block)
        for number, grasp in enumerate(passed):
            words = (tried, number)
            if not _passing(
                noisy, [grasp], settings.attempts, settings.attempts - 1, child_seed(seed, "noisy", *words)
            ):
                continue
            quality = (
                successes(noisy.trial(grasp, settings.retest, child_seed(seed, "retest", *words))) / settings.retest
            )
            if quality >= settings.least:
                found.append(ScoredGrasp(grasp, quality))
            if len(found) >= settings.enough:
                break
    return tried


def successes(trial: Trial) -> int:
    """Attempts that succeeded at first draw: an execution whose solver diverged counts as failed."""
    return sum(attempt.outcome == "SUCCESS" and not attempt.redraws for attempt in trial.attempts)


def _passing(trials: GraspTrial, grasps: list[Grasp], attempts: int, least: int, seed: int) -> list[Grasp]:
    """Those grasps that succeed in at least `least` of `attempts`."""
    if not grasps:
        return []
    return [trial.grasp for trial in trials.batch(grasps, attempts, seed) if successes(trial) >= max(1, least)]
