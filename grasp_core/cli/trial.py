"""`grasp-core trial`: execute one grasp on one object in DART and say what happened."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tyro

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from grasp_core.objects.asset import ObjectAsset
    from grasp_core.simulation.physics import Physics
    from grasp_core.simulation.trial import Trial


_RESTING = 0.005
"""Metres: an object whose lowest point is farther from the table does not rest on it."""


@dataclass(frozen=True)
class TrialCommand:
    """Execute a grasp several times, each with its own noise, and lift the full 30 cm each time.

    The world has z up and the table at z = 0; metres and rad. A pose given by its index stands above the origin.

    Attributes:
        mesh: OFF, OBJ, STL, PLY, glTF, GLB or URDF file, or a name of the catalogue such as mug_003.
        position: midpoint of the fingers' lower ends when they close.
        angle: of the closing axis about z.
        width: opening of the fingers on the way in.
        scale: keep takes the mesh as metres, paper resizes its longest side to 10-20 cm, a number multiplies.
        pose: index of a stable pose, likeliest first, or a file with the 4×4 world_from_object (.txt, .npy or .yaml).
        attempts: how many.
        seed: of the noise, and of a drawn scale.
        noiseless: execute the grasp exactly as given.
        shake: after each successful lift, shake the object along this axis of the gripper, both ways and harder and
            harder until it slips: x is the closing axis, y runs across the fingers' faces, z up. The evidence then says
            what was withstood, in m/s² and N.
        shake_step: acceleration by which the shaking grows, m/s².
        shake_most: acceleration at which it ends, m/s².
        gripper: shipped name, or a .yaml file.
        physics: shipped name, or a .yaml file.
        record: write a recording of the first attempt here (.npz).
        json: print one JSON object and nothing else.
    """

    mesh: Annotated[str, tyro.conf.Positional]
    position: tuple[float, float, float]
    angle: float
    width: float
    scale: str = "keep"
    pose: str = "0"
    attempts: int = 5
    seed: int = 0
    noiseless: bool = False
    shake: Literal["x", "y", "z"] | None = None
    shake_step: float = 2.0
    shake_most: float = 60.0
    gripper: str = "paper"
    physics: str = "default"
    record: Path | None = None
    json: bool = False

    def run(self) -> int:
        """Load, settle, execute and print."""
        from grasp_core.errors import GraspError
        from grasp_core.grasp import Grasp
        from grasp_core.gripper import load_gripper
        from grasp_core.scene import Scene
        from grasp_core.simulation.physics import load_physics
        from grasp_core.simulation.trial import GraspNoise, GraspTrial, Shake

        if self.seed < 0:
            raise GraspError(f"--seed must be at least 0, not {self.seed}")
        gripper, physics = load_gripper(self.gripper), load_physics(self.physics)
        grasp = Grasp(self.position, self.angle, self.width)
        asset = self._asset()
        pose = self._pose(asset, physics)
        noise = None if self.noiseless else GraspNoise()
        try:
            shake = Shake(self.shake, self.shake_step, self.shake_most) if self.shake else None
        except ValueError as error:
            raise GraspError(f"--shake-step, --shake-most: {error}") from error
        runner = GraspTrial(Scene.single(asset, pose), gripper, physics, noise, whole=True, shake=shake)
        trial = runner.trial(grasp, self.attempts, self.seed)
        if self.record is not None:
            recording = runner.attempt(grasp, trial.attempts[0].seed, record=True).recording
            assert recording is not None
            try:
                recording.save(self.record)
            except OSError as error:
                raise GraspError(f"--record {self.record}: cannot be written ({error.strerror})") from error
        if self.json:
            made = {
                "object": asset.name,
                "mass": physics.mass(asset),
                "world_from_object": pose.tolist(),
                "gripper": gripper.digest,
                "physics": physics.digest,
                "seed": self.seed,
            }
            print(json.dumps(made | describe(trial), allow_nan=False))
        else:
            print(_table(trial))
        return 0

    def _asset(self) -> ObjectAsset:
        from grasp_core.errors import GraspError
        from grasp_core.evaluation.suites import parse_scale
        from grasp_core.objects.library import catalogue, load_object

        if Path(self.mesh).exists() or Path(self.mesh).suffix:
            return load_object(self.mesh, scale=parse_scale(self.scale), seed=self.seed)
        if self.scale != "keep":
            raise GraspError("--scale is for mesh files; objects of the catalogue have their own size")
        return catalogue(self.mesh)

    def _pose(self, asset: ObjectAsset, physics: Physics) -> NDArray[np.float64]:
        from grasp_core.errors import GraspError
        from grasp_core.simulation.settling import stable_poses

        if not self.pose.lstrip("-").isdigit():
            pose = read_pose(Path(self.pose))
            lowest = float((asset.hull.vertices @ pose[2, :3]).min() + pose[2, 3])
            if abs(lowest) > _RESTING:
                raise GraspError(
                    f"--pose {self.pose}: the lowest point of {asset.name} would be at z = {lowest * 1000:.1f} mm,"
                    " but it must rest on the table, z = 0; mend the last column"
                )
            return pose
        poses = stable_poses(asset, physics)
        index = int(self.pose)
        if not 0 <= index < len(poses):
            raise GraspError(
                f"--pose {index}: {asset.name} has {len(poses)} stable poses, 0 to {len(poses) - 1}; choose one of them"
            )
        return poses[index].pose


def read_pose(path: Path) -> NDArray[np.float64]:
    """A 4×4 rigid transform from .npy, .yaml (rows, or under the key world_from_object) or text (16 numbers).

    Raises:
        GraspError: missing or unreadable file, or not such a transform; the message names the file.
    """
    import numpy as np

    from grasp_core import config
    from grasp_core.errors import GraspError

    if not path.is_file():
        raise GraspError(f"--pose {path}: no such file; give the index of a stable pose or a .txt, .npy or .yaml file")
    try:
        if path.suffix == ".npy":
            value: Any = np.load(path, allow_pickle=False)
        elif path.suffix in (".yaml", ".yml"):
            value = config.read_yaml(path)
            value = value.get("world_from_object") if isinstance(value, dict) else value
        else:
            value = np.loadtxt(path)
        pose = np.asarray(value, float)
    except (ValueError, TypeError, OSError) as error:
        raise GraspError(f"--pose {path}: holds no numbers ({error})") from error
    if pose.size == 16:
        pose = pose.reshape(4, 4)
    if pose.shape != (4, 4) or not np.isfinite(pose).all():
        raise GraspError(f"--pose {path}: must hold a 4×4 matrix of finite numbers, not one of shape {pose.shape}")
    turn = pose[:3, :3]
    rigid = np.allclose(turn @ turn.T, np.eye(3), atol=1e-4) and np.linalg.det(turn) > 0
    if not rigid or not np.allclose(pose[3], [0, 0, 0, 1]):
        raise GraspError(f"--pose {path}: is no rigid transform; its 3×3 part must be a rotation, its last row 0 0 0 1")
    return pose


def describe(trial: Trial) -> dict[str, Any]:
    """A trial as plain values: grasp, quality, and each attempt with its evidence."""
    import msgspec

    return {
        "grasp": msgspec.to_builtins(trial.grasp),
        "quality": trial.quality,
        "outcomes": [str(outcome) for outcome in trial.outcomes],
        "attempts": [
            {
                "outcome": str(attempt.outcome),
                "seed": attempt.seed,
                "executed": msgspec.to_builtins(attempt.executed),
                "dynamic": attempt.dynamic,
                "redraws": attempt.redraws,
                "comfort": msgspec.to_builtins(attempt.comfort),
                "evidence": msgspec.to_builtins(attempt.evidence),
            }
            for attempt in trial.attempts
        ],
    }


def _table(trial: Trial) -> str:
    lines = [f"{attempt.outcome:<9}  {attempt.evidence.words}" for attempt in trial.attempts]
    good = sum(outcome == "SUCCESS" for outcome in trial.outcomes)
    return "\n".join([*lines, f"quality {trial.quality:.2f} ({good} of {len(trial.attempts)})"])
