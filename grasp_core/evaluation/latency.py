"""The latency benchmark: the whole way from a 640×480 image to sorted grasps, by stage, on every backend.

Each image shows an object on the table with the noise of Eq. 5; where the camera file states no pose, finding the table
plane is part of the plan. In the same run the same network searches exhaustively.
"""

from __future__ import annotations

import importlib.util
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import msgspec
import numpy as np

from grasp_core.camera import Camera, DepthImage
from grasp_core.errors import GraspError
from grasp_core.evaluation.scenes import SceneSpec, make_scene, over_the_table
from grasp_core.evaluation.seeds import generator
from grasp_core.evaluation.suites import object_plans, poses_of
from grasp_core.gripper import Gripper
from grasp_core.networks.runtime import Backend, load_runtime
from grasp_core.planning.planner import Planner, make_planner
from grasp_core.sensing.noise import ImageNoise, add_noise
from grasp_core.sensing.renderer import render
from grasp_core.simulation.physics import Physics


class Timing(msgspec.Struct, frozen=True):
    """How long a planner takes.

    Attributes:
        median_ms: of a plan.
        p95_ms: of a plan.
        candidates: grasps that were scored, median.
        stages_ms: stage → median.
    """

    median_ms: float
    p95_ms: float
    candidates: float
    stages_ms: dict[str, float]


class Latency(msgspec.Struct, frozen=True):
    """The benchmark's results.

    Attributes:
        median_ms: of a plan on the backend that planning takes by itself.
        p95_ms: of a plan.
        candidates: grasps that were scored, median.
        backend: its name.
        stages_ms: stage → median.
        exhaustive_median_ms: of a plan by exhaustive search with the same network.
        exhaustive_candidates: grasps that it scored, median.
        exhaustive_ratio: how many times longer it takes.
        pruned_exhaustive_median_ms: of the same search where grasps that the gripper cannot reach are dropped before
            they are scored, as the cascade drops them.
        pruned_exhaustive_candidates: grasps that it scored, median.
        pruned_exhaustive_ratio: how many times longer than the cascade it takes.
        unpolished: the cascade on the same backend with at most 64 scored candidates in a region: nothing is drawn
            around the best ones (`polished: 0`).
        first_plan_ms: of a new process of `grasp-core plan`, from its start to its end.
        backends: every backend that is installed.
        images: that were planned on.
        repeats: plans an image.
        weights: that were planned with.
    """

    median_ms: float
    p95_ms: float
    candidates: float
    backend: str
    stages_ms: dict[str, float]
    exhaustive_median_ms: float
    exhaustive_candidates: float
    exhaustive_ratio: float
    pruned_exhaustive_median_ms: float
    pruned_exhaustive_candidates: float
    pruned_exhaustive_ratio: float
    unpolished: Timing
    first_plan_ms: float
    backends: dict[str, Timing]
    images: int
    repeats: int
    weights: str


def make_images(
    objects: str, camera: Camera, physics: Physics, noise: ImageNoise, count: int, seed: int
) -> list[DepthImage]:
    """Noisy images of the first `count` objects of a suite or folder, each in its likeliest stable pose.

    Raises:
        GraspError: no object of it can be used.
    """
    images: list[DepthImage] = []
    for plan in object_plans(objects, "keep", seed):
        try:
            asset = plan.make()
            pose = poses_of(asset, physics)[0].pose
            scene = make_scene(asset, pose, over_the_table(camera), SceneSpec(asset.name, asset.digest, 0, 0), seed)
        except GraspError:
            continue
        clean = render(scene)
        images.append(add_noise(clean, noise, generator(seed, "image", asset.name)).with_camera(camera))
        if len(images) == count:
            break
    if not images:
        raise GraspError(f"'{objects}' holds no object that can be used; give another suite or folder")
    return images


def time_planner(planner: Planner, images: Sequence[DepthImage], repeats: int, seed: int) -> Timing:
    """Plan on every image once to warm up, then `repeats` times in random order."""
    rng = generator(seed, "latency")
    for image in images:
        planner(image, rng=rng)
    total, counts = [], []
    stages: dict[str, list[float]] = {}
    for index in rng.permutation(np.tile(np.arange(len(images)), repeats)):
        start = time.perf_counter()
        plan = planner(images[index], rng=rng)
        total.append((time.perf_counter() - start) * 1000)
        counts.append(len(plan.scored))
        for name, ms in plan.stages_ms.items():
            stages.setdefault(name, []).append(ms)
    return Timing(
        round(float(np.median(total)), 3),
        round(float(np.percentile(total, 95)), 3),
        float(np.median(counts)),
        {name: round(float(np.median(values)), 3) for name, values in stages.items()},
    )


def time_first_plan(image: DepthImage, gripper: str, weights: str) -> float:
    """Milliseconds that a new process of `grasp-core plan` takes from its start to its end.

    Raises:
        GraspError: the process failed.
    """
    code = "import sys; from grasp_core.cli import main; sys.exit(main(sys.argv[1:]))"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        np.save(folder / "depth.npy", np.where(image.valid, image.depth, np.nan))
        k, pose = image.camera.intrinsics, image.camera.world_from_camera
        fields = {key: getattr(k, key) for key in ("fx", "fy", "cx", "cy", "width", "height")}
        if k.distortion is not None:
            fields["distortion"] = list(k.distortion)
        if pose is not None:
            fields["world_from_camera"] = pose.tolist()
        (folder / "camera.yaml").write_bytes(msgspec.yaml.encode(fields))
        words = ["plan", str(folder / "depth.npy"), "--camera", str(folder / "camera.yaml"), "--json"]
        words += ["--gripper", gripper, "--weights", weights]
        start = time.perf_counter()
        done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True)
        elapsed = (time.perf_counter() - start) * 1000
    if done.returncode:
        raise GraspError(f"a new process could not plan: {done.stderr.strip()}")
    return round(elapsed, 1)


def run_latency(
    images: Sequence[DepthImage], gripper: Gripper, gripper_name: str, weights: str, repeats: int, seed: int
) -> Latency:
    """Time the cascade on every backend that is installed, the exhaustive search, and the first plan of a process.

    Args:
        images: to plan on.
        gripper: whose grasps are planned.
        gripper_name: name or file of it, for the new process.
        weights: name or path.
        repeats: plans an image; the exhaustive search plans once.
        seed: of everything random.
    """
    installed: list[Backend] = ["openvino"] if importlib.util.find_spec("openvino") else []
    installed.append("torch")
    backends: dict[str, Timing] = {}
    exhaustive = pruned = unpolished = None
    name = ""
    for backend in installed:
        runtime = load_runtime(weights, backend, precision="auto")
        name = name or runtime.backend
        cascade = make_planner("cascade", gripper=gripper, runtime=runtime)
        backends[runtime.backend] = time_planner(cascade, images, repeats, seed)
        if exhaustive is None:
            fewer = make_planner("cascade", gripper=gripper, runtime=runtime, changes={"polished": 0})
            unpolished = time_planner(fewer, images, repeats, seed)
            search = make_planner("exhaustive", gripper=gripper, runtime=runtime)
            exhaustive = time_planner(search, images, 1, seed)
            search = make_planner("exhaustive", gripper=gripper, runtime=runtime, changes={"prune": True})
            pruned = time_planner(search, images, 1, seed)
            used = f"{runtime.meta.name} {runtime.digest}"
    assert exhaustive is not None and pruned is not None and unpolished is not None
    best = backends[name]
    return Latency(
        median_ms=best.median_ms,
        p95_ms=best.p95_ms,
        candidates=best.candidates,
        backend=name,
        stages_ms=best.stages_ms,
        exhaustive_median_ms=exhaustive.median_ms,
        exhaustive_candidates=exhaustive.candidates,
        exhaustive_ratio=round(exhaustive.median_ms / best.median_ms, 1),
        pruned_exhaustive_median_ms=pruned.median_ms,
        pruned_exhaustive_candidates=pruned.candidates,
        pruned_exhaustive_ratio=round(pruned.median_ms / best.median_ms, 1),
        unpolished=unpolished,
        first_plan_ms=time_first_plan(images[0], gripper_name, weights),
        backends=backends,
        images=len(images),
        repeats=repeats,
        weights=used,
    )
