"""`grasp-core benchmark latency`: how long a plan takes, by stage, on every backend."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class BenchmarkLatency:
    """Time the whole way from a depth image to sorted grasps: median, 95th percentile and stages, on every backend.

    In the same run the same network searches exhaustively, and a new process makes its first plan.

    Attributes:
        objects: whose images are planned on: a suite by name, a suite file, or a folder of meshes (in metres).
        images: how many objects.
        repeats: plans an image.
        seed: of everything random.
        weights: a shipped name or a file.
        camera: a shipped camera or a camera file; without a pose the plan finds the table plane too.
        gripper: a shipped gripper or a gripper file.
        noise: of the image: a shipped noise or a noise file.
        json: print one JSON object.
    """

    objects: str = "catalogue"
    images: int = 8
    repeats: int = 10
    seed: int = 0
    weights: str = "default"
    camera: str = "primesense"
    gripper: str = "paper"
    noise: str = "paper"
    json: bool = False

    def run(self) -> None:
        """Run the benchmark and print its report."""
        from grasp_core.camera import load_camera
        from grasp_core.errors import GraspError
        from grasp_core.evaluation.latency import make_images, run_latency
        from grasp_core.evaluation.machine import Watch, envelope, print_envelope
        from grasp_core.evaluation.report import table
        from grasp_core.gripper import load_gripper
        from grasp_core.sensing.noise import load_noise
        from grasp_core.simulation.physics import load_physics

        if self.images < 1 or self.repeats < 1:
            raise GraspError(f"--images and --repeats must be at least 1, not {self.images} and {self.repeats}")
        camera, noise = load_camera(self.camera), load_noise(self.noise)
        images = make_images(self.objects, camera, load_physics(), noise, self.images, self.seed)
        watch = Watch()
        result = run_latency(images, load_gripper(self.gripper), self.gripper, self.weights, self.repeats, self.seed)
        rows = [
            (f"cascade, {name}", f"{t.median_ms:.1f}", f"{t.p95_ms:.1f}", f"{t.candidates:.0f}")
            for name, t in (*result.backends.items(), (f"{result.backend}, 64 a region", result.unpolished))
        ]
        rows.append(
            ("exhaustive search", f"{result.exhaustive_median_ms:.1f}", "", f"{result.exhaustive_candidates:.0f}")
        )
        rows.append(
            (
                "exhaustive, of what is reached",
                f"{result.pruned_exhaustive_median_ms:.1f}",
                "",
                f"{result.pruned_exhaustive_candidates:.0f}",
            )
        )
        stages = [(name, f"{ms:.2f}") for name, ms in result.stages_ms.items()]
        lines = [table(("plan", "median ms", "p95 ms", "scored"), rows), "", table(("stage", "median ms"), stages), ""]
        lines.append(
            f"exhaustive search takes {result.exhaustive_ratio:.0f} times as long as the cascade with its default"
            f" settings, {result.pruned_exhaustive_ratio:.0f} times where it scores only what the gripper reaches"
        )
        lines.append(f"first plan of a new process: {result.first_plan_ms / 1000:.1f} s")
        report = envelope("latency", self.seed, result, watch)
        report["settings"] = {"objects": self.objects, "camera": self.camera, "gripper": self.gripper}
        print_envelope(report, json=self.json, text="\n".join(lines))
