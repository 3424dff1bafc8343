"""Generation: from a recipe to a dataset, on any executor, stopped and resumed at will.

Two stages. First every object is made and let come to rest (asset and stable poses are stored); then every scene is
rendered, its grid of grasps tried in DART, and stored whole by this process, the one writer. What is stored is done:
a second run of the same recipe on the same folder makes only what is missing.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from grasp_core.camera import Camera, DepthImage, canonical_camera, load_camera
from grasp_core.dataset.content import SceneRecord
from grasp_core.dataset.database import FILE
from grasp_core.dataset.recipe import ObjectPlan, Recipe, check_sets, name_seed, plan_objects
from grasp_core.dataset.rows import AttemptRow, StoredPose
from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import ConfigError, GraspError, MismatchError
from grasp_core.grasp import Grasp
from grasp_core.gripper import Gripper, load_gripper
from grasp_core.objects.asset import ObjectAsset
from grasp_core.parallel import Executor, map_scenes
from grasp_core.planning.crops import deepen, grasp_pixels, sample, surface_map
from grasp_core.scene import PlacedObject, Scene, place
from grasp_core.sensing.renderer import Renderer
from grasp_core.simulation.evidence import Evidence
from grasp_core.simulation.physics import Physics, load_physics
from grasp_core.simulation.settling import stable_poses
from grasp_core.simulation.trial import Attempt, GraspTrial


@dataclass(frozen=True)
class Progress:
    """How far generation is: `done` of `total` in the stage "objects" or "scenes", those done before included."""

    stage: str
    done: int
    total: int


@dataclass
class Summary:
    """What a run of `generate` did.

    Attributes:
        scenes: stored by this run.
        before: scenes that were there already.
        refused: object → why it could not be used, over all runs.
        outcomes: attempts of this run by outcome.
        seconds: of this run.
    """

    scenes: int = 0
    before: int = 0
    refused: dict[str, str] = field(default_factory=dict)
    outcomes: Counter[str] = field(default_factory=Counter)
    seconds: float = 0.0


def grid_grasps(placed: PlacedObject, canonical: DepthImage, gripper: Gripper, recipe: Recipe) -> list[Grasp]:
    """The grasps to try on a placed object: a grid of positions, each with every angle, fully open.

    The positions span the object's axis-aligned bounding rectangle in the table plane, its edges included; their
    height follows the recipe's depth rule on what the canonical camera sees above them.

    Args:
        placed: the object.
        canonical: its clean image by a canonical camera.
        gripper: gives the opening.
        recipe: gives grid, angles and depth rule.

    Returns:
        grid · grid · angles grasps; x changes slowest, then y, then the angle.
    """
    low, high = placed.vertices[:, :2].min(axis=0), placed.vertices[:, :2].max(axis=0)
    steps = np.linspace(0, 1, recipe.grid) if recipe.grid > 1 else np.array([0.5])
    x, y = (low[axis] + (high[axis] - low[axis]) * steps for axis in (0, 1))
    xy = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    flat = np.column_stack([xy, np.zeros(len(xy))])
    u, v, _, _ = grasp_pixels(canonical.depth, canonical.camera, flat, np.zeros(len(xy)))
    surface = sample(surface_map(canonical.depth), u, v)
    z = canonical.camera.pose[2, 3] - deepen(surface, canonical.camera, recipe.depth_rule)
    angles = [k * np.pi / recipe.angles for k in range(recipe.angles)]
    return [
        Grasp((float(px), float(py), float(pz)), float(angle), gripper.opening)
        for (px, py), pz in zip(xy, z, strict=True)
        for angle in angles
    ]


@dataclass(frozen=True)
class _ObjectItem:
    plan: ObjectPlan
    physics: Physics
    seed: int


@dataclass(frozen=True)
class SceneItem:
    """Everything that a worker needs to make one scene.

    Attributes:
        name: of the scene.
        asset: of its object.
        pose: number of the stable pose.
        stored: that pose.
        recipe: what to do.
        camera: that looks at it.
        gripper: that tries.
        physics: of the trials.
    """

    name: str
    asset: ObjectAsset
    pose: int
    stored: StoredPose
    recipe: Recipe
    camera: Camera
    gripper: Gripper
    physics: Physics


def make_object(item: _ObjectItem) -> tuple[ObjectAsset, list[StoredPose]] | str:
    """The object with its stable poses, or why it cannot be used."""
    try:
        asset = item.plan.make()
        poses = stable_poses(asset, item.physics, seed=item.seed)
    except GraspError as error:
        return str(error)
    if not poses:
        return "it has no stable pose"
    return asset, [StoredPose(tuple(found.pose.reshape(-1).tolist()), float(found.probability)) for found in poses]


def place_scene(asset: ObjectAsset, pose: StoredPose, name: str, recipe: Recipe, camera: Camera) -> Scene:
    """The object in the centre of the view, turned by a yaw that is drawn from the scene's name."""
    yaw = np.random.default_rng(name_seed(recipe.seed, "yaw", name)).uniform(-np.pi, np.pi)
    return Scene.single(asset, place(pose.matrix, 0.0, 0.0, float(yaw)), camera)


def render_scene(scene: Scene) -> tuple[DepthImage, DepthImage]:
    """The clean images of the scene's own camera and of the canonical one."""
    renderer = Renderer(scene)
    return renderer.render(), renderer.render(canonical_camera())


def make_scene(item: SceneItem) -> SceneRecord:
    """Place, render and try: all of one scene."""
    start = time.perf_counter()
    recipe = item.recipe
    scene = place_scene(item.asset, item.stored, item.name, recipe, item.camera)
    depth, canonical = render_scene(scene)
    grasps = grid_grasps(scene.objects[0], canonical, item.gripper, recipe)
    seed = name_seed(recipe.seed, "trials", item.name)
    trials = GraspTrial(scene, item.gripper, item.physics, noise=recipe.noise).batch(grasps, recipe.attempts, seed)
    return SceneRecord(
        name=item.name,
        object=item.asset.name,
        pose=item.pose,
        seed=seed,
        scene=scene,
        depth=depth,
        grasps=grasps,
        attempts=[[attempt_row(attempt) for attempt in trial.attempts] for trial in trials],
        seconds=time.perf_counter() - start,
    )


def attempt_row(attempt: Attempt) -> AttemptRow:
    """A simulated attempt as it is stored; evidence is kept where the engine was needed."""
    grasp, comfort = attempt.executed, attempt.comfort
    return AttemptRow(
        outcome=attempt.outcome.value,
        seed=attempt.seed,
        executed=(*grasp.position, grasp.angle),
        dynamic=attempt.dynamic,
        redraws=attempt.redraws,
        comfort=None if comfort is None else (float(comfort.distance), float(comfort.rotation)),
        evidence=evidence_json(attempt.evidence) if attempt.dynamic else None,
    )


def evidence_json(evidence: Evidence) -> str:
    """Evidence as it is stored: what is absent is left out, numbers to a millionth (µm, µN, …)."""

    def plain(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: plain(item) for key, item in value.items() if item is not None}
        if isinstance(value, list | tuple):
            return [plain(item) for item in value]
        return round(value, 6) if isinstance(value, float) else value

    return msgspec.json.encode(plain(msgspec.to_builtins(evidence))).decode()


def open_for(recipe: Recipe, path: Path, gripper: Gripper, physics: Physics) -> DatasetStore:
    """The dataset of a recipe at a path, made when missing.

    Raises:
        MismatchError: the dataset there follows another recipe, gripper or physics.
        StoreError: it cannot be opened or made.
    """
    if not (path / FILE).exists():
        return DatasetStore.create(path, name=recipe.name, gripper=gripper, physics=physics, recipe=recipe)
    store = DatasetStore.open(path)
    try:
        store.check(gripper=gripper, physics=physics)
        theirs, ours = store.meta.recipe, msgspec.json.decode(msgspec.json.encode(recipe))
        if theirs != ours:
            differ = ", ".join(sorted(key for key in {*theirs, *ours} if theirs.get(key) != ours.get(key)))
            raise MismatchError(
                f"{path}: holds a dataset of another recipe ({differ} differ); give another folder with --out"
            )
    except BaseException:
        store.close()
        raise
    return store


def generate(
    recipe: Recipe,
    path: str | Path,
    executor: Executor | None = None,
    *,
    progress: Callable[[Progress], None] | None = None,
    cancelled: Callable[[], bool] | None = None,
) -> Summary:
    """Make the dataset of a recipe, or what is missing of it.

    Args:
        recipe: what to make.
        path: folder of the dataset.
        executor: where the work runs.
        progress: called after each object and scene.
        cancelled: asked a few times a second; true ends the run, what is stored stays.

    Raises:
        Cancelled: `cancelled` said so.
        MismatchError: the folder holds a dataset of another recipe, gripper or physics.
        GraspError: the recipe cannot be followed or the dataset not be written.
    """
    start = time.perf_counter()
    gripper, physics, camera = load_gripper(recipe.gripper), load_physics(recipe.physics), load_camera(recipe.camera)
    if camera.world_from_camera is None:
        raise ConfigError(
            f"recipe '{recipe.name}': the camera '{recipe.camera}' has no pose; add world_from_camera to it"
        )
    plans = plan_objects(recipe)
    summary = Summary()
    tell = progress or (lambda _: None)
    with open_for(recipe, Path(path).expanduser(), gripper, physics) as store:
        _make_objects(store, plans, recipe, physics, executor, tell, cancelled)
        summary.refused = store.refused()
        stored = {row.name for row in store.scenes()}
        items: list[SceneItem] = []
        total = 0
        for plan in plans:
            if plan.name in summary.refused:
                continue
            poses = list(enumerate(store.poses(plan.name)))[: recipe.poses]
            total += len(poses)
            missing = [(k, pose) for k, pose in poses if scene_name(plan.name, k) not in stored]
            if missing:
                asset = store.object(plan.name)
                items += [
                    SceneItem(scene_name(plan.name, k), asset, k, pose, recipe, camera, gripper, physics)
                    for k, pose in missing
                ]
        summary.before = total - len(items)
        # Shuffled, so that what is done at any time is a fair sample: splits grow together, the time left is told well.
        np.random.default_rng(recipe.seed).shuffle(items)
        tell(Progress("scenes", summary.before, total))
        for _, record in map_scenes(make_scene, items, executor, cancelled=cancelled):
            if store.add_scene(record):
                summary.scenes += 1
                summary.outcomes.update(row.outcome for rows in record.attempts for row in rows)
            tell(Progress("scenes", summary.before + summary.scenes, total))
    summary.seconds = time.perf_counter() - start
    return summary


def scene_name(object_name: str, pose: int) -> str:
    """The name of the scene of an object in its stable pose number `pose`."""
    return f"{object_name}-{pose}"


def _make_objects(
    store: DatasetStore,
    plans: list[ObjectPlan],
    recipe: Recipe,
    physics: Physics,
    executor: Executor | None,
    tell: Callable[[Progress], None],
    cancelled: Callable[[], bool] | None,
) -> None:
    known = {row.name for row in store.objects()} | set(store.refused())
    missing = [plan for plan in plans if plan.name not in known]
    check_sets(recipe, missing)
    done = len(plans) - len(missing)
    tell(Progress("objects", done, len(plans)))
    items = [_ObjectItem(plan, physics, name_seed(recipe.seed, "poses", plan.name)) for plan in missing]
    results: Any = map_scenes(make_object, items, executor, cancelled=cancelled)
    for index, made in results:
        if isinstance(made, str):
            store.refuse(missing[index].name, made)
        else:
            store.add_object(made[0], missing[index].split, made[1])
        done += 1
        tell(Progress("objects", done, len(plans)))
