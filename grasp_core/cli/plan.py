"""`grasp-core plan`: grasps from one depth image file."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

if TYPE_CHECKING:
    from grasp_core.camera import Camera
    from grasp_core.planning.planner import Candidate, Plan


@dataclass(frozen=True)
class PlanCommand:
    """Plan grasps from one depth image: .npy with metres, or 16-bit .png or .tiff with --depth-scale.

    Grasps are in the camera file's world: z up, the table at z = 0, metres and rad.

    Attributes:
        depth: the depth image.
        camera: camera file (.yaml) or shipped name.
        depth_scale: metres per unit of the image file, 0.001 for millimetres; whole numbers need it.
        mask: image of the same size; grasps are centred where it is not black.
        planner: shipped name, or a .yaml file of planner settings.
        weights: shipped name, or a .safetensors file.
        gripper: shipped name, or a .yaml file.
        budget_ms: return the best found within this time, ms; a plan that finds nothing in time says so.
        seed: of everything that is random.
        picture: write a picture of the plan here (.png).
        json: print one JSON object and nothing else.
    """

    depth: Annotated[Path, tyro.conf.Positional]
    camera: str
    depth_scale: float | None = None
    mask: Path | None = None
    planner: str = "cascade"
    weights: str = "default"
    gripper: str = "paper"
    budget_ms: float | None = None
    seed: int = 0
    picture: Path | None = None
    json: bool = False

    def run(self) -> int:
        """Plan, draw and print."""
        import numpy as np

        from grasp_core.camera import load_camera
        from grasp_core.errors import GraspError
        from grasp_core.gripper import load_gripper
        from grasp_core.planning.picture import save_picture
        from grasp_core.planning.planner import make_planner
        from grasp_core.sensing.preprocess import read_depth, read_mask

        if self.budget_ms is not None and not self.budget_ms > 0:
            raise GraspError(f"--budget-ms must be above 0, not {self.budget_ms}")
        if self.seed < 0:
            raise GraspError(f"--seed must be at least 0, not {self.seed}")
        image = read_depth(self.depth, load_camera(self.camera), self.depth_scale)
        mask = None if self.mask is None else read_mask(self.mask, image.depth.shape)
        planner = make_planner(self.planner, gripper=load_gripper(self.gripper), weights=self.weights)
        plan = planner(image, mask=mask, budget_ms=self.budget_ms, rng=np.random.default_rng(self.seed))
        if self.picture is not None:
            save_picture(self.picture, plan, image)
        print(json.dumps(describe(plan), allow_nan=False) if self.json else _table(plan))
        return 0


def describe(plan: Plan) -> dict[str, Any]:
    """A plan as the JSON object of the command's contract."""
    return {
        "grasps": [_grasp(candidate) for candidate in plan.candidates],
        "reason": plan.reason,
        "stages_ms": {stage: round(ms, 3) for stage, ms in plan.stages_ms.items()},
        "camera": _camera(plan.camera),
        "weights": plan.weights or None,
        "missing": round(plan.missing, 4),
    }


def _grasp(candidate: Candidate) -> dict[str, Any]:
    grasp, seen = candidate.grasp, candidate.image
    return {
        "position": list(grasp.position),
        "angle": grasp.angle,
        "width": grasp.width,
        "score": float(candidate.score),
        "image": {"u": seen.u, "v": seen.v, "angle": seen.angle, "width": seen.width, "depth": seen.depth},
    }


def _camera(camera: Camera) -> dict[str, Any]:
    k = camera.intrinsics
    pose = camera.world_from_camera
    return {
        "fx": k.fx,
        "fy": k.fy,
        "cx": k.cx,
        "cy": k.cy,
        "width": k.width,
        "height": k.height,
        "distortion": None if k.distortion is None else list(k.distortion),
        "world_from_camera": None if pose is None else pose.tolist(),
    }


def _table(plan: Plan) -> str:
    lines = []
    if plan.candidates:
        lines.append("score      x       y       z   angle  width   (m, degrees; best first)")
        for candidate in plan.candidates:
            (x, y, z), grasp = candidate.grasp.position, candidate.grasp
            lines.append(
                f"{candidate.score:.3f} {x:7.3f} {y:7.3f} {z:7.3f} {grasp.angle * 57.29578:7.1f} {grasp.width:6.3f}"
            )
    else:
        lines.append(f"no grasp: {plan.reason}")
    stages = ", ".join(f"{stage} {ms:.1f}" for stage, ms in plan.stages_ms.items())
    lines.append(f"{plan.total_ms:.1f} ms ({stages}); {plan.missing:.1%} of the pixels were missing")
    return "\n".join(lines)
