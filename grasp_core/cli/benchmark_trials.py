"""`grasp-core benchmark trials`: how fast DART trials are, beside MuJoCo on the same grasps."""

from __future__ import annotations

import sys
from dataclasses import dataclass


@dataclass(frozen=True)
class BenchmarkTrials:
    """Run trials of the paper's grid on a fixed mix of objects and print attempts per second and core.

    All attempts, and those that need dynamics alone, by outcome; in the same run MuJoCo executes the same attempts with
    the same noise draws and stopping rules. Rates count the processor time of one process, so that a busy machine
    changes them little. The throughput of two processes is the ratio of the time that one and two spend in trials, per
    process; loading, handing out work and waiting at the end do not count.

    Attributes:
        objects: a suite by name, a suite file, or a folder of meshes (in metres).
        share: of the 726 grasps on each object, drawn at random.
        attempts: a grasp.
        seed: of everything random.
        gripper: a shipped gripper or a gripper file.
        physics: a shipped physics or a physics file.
        two: also compare the throughput of two processes with that of one.
        json: print one JSON object.
    """

    objects: str = "trials"
    share: float = 0.2
    attempts: int = 5
    seed: int = 0
    gripper: str = "paper"
    physics: str = "default"
    two: bool = True
    json: bool = False

    def run(self) -> None:
        """Run the benchmark and print its report."""
        from grasp_core.evaluation.machine import Watch, envelope, print_envelope
        from grasp_core.evaluation.report import table
        from grasp_core.evaluation.suites import object_plans
        from grasp_core.evaluation.trials import run_trials
        from grasp_core.gripper import load_gripper
        from grasp_core.simulation.physics import load_physics

        plans = object_plans(self.objects, "keep", self.seed)
        watch = Watch()
        result = run_trials(
            plans,
            load_gripper(self.gripper),
            load_physics(self.physics),
            share=self.share,
            attempts=self.attempts,
            seed=self.seed,
            two=self.two,
            progress=lambda name: print(f"trials on {name}", file=sys.stderr),
        )
        rows = [
            (
                name,
                row.attempts,
                row.dynamic,
                f"{row.attempts_per_second_per_core:.0f}",
                f"{row.dynamic_attempts_per_second_per_core or 0:.1f}",
                f"{row.mujoco_dynamic_attempts_per_second_per_core or 0:.1f}",
            )
            for name, row in result.objects.items()
        ]
        whole = (
            "all",
            result.attempts,
            result.dynamic_attempts,
            f"{result.attempts_per_second_per_core:.0f}",
            f"{result.dynamic_attempts_per_second_per_core:.1f}",
            f"{result.mujoco_dynamic_attempts_per_second_per_core:.1f}",
        )
        ends: list[tuple[object, ...]] = []
        for name, count in result.outcomes.items():
            found = result.by_outcome.get(name)
            if found is None:
                ends.append((name, count, 0, "", "", ""))
                continue
            rates = (found.dynamic_attempts_per_second_per_core, found.mujoco_dynamic_attempts_per_second_per_core)
            ends.append((name, count, found.dynamic, result.dynamic_ms[name], *(f"{rate or 0:.1f}" for rate in rates)))
        lines = [
            table(("object", "attempts", "dynamic", "all/s", "dynamic/s", "MuJoCo/s"), [*rows, whole]),
            "",
            table(("outcome in DART", "attempts", "dynamic", "ms if dynamic", "dynamic/s", "MuJoCo/s"), ends),
            "",
            f"MuJoCo is {result.mujoco_ratio:.2f} times as fast on the dynamic attempts and agrees on"
            f" {result.mujoco_agreement:.3f} of them; unstable: {result.unstable_share:.4%}",
        ]
        if result.two_process_speedup is not None:
            rounds = ", ".join(f"{speedup:.2f}" for speedup in sorted(result.two_process_rounds))
            lines.append(
                f"two processes get through {result.two_process_speedup:.2f} times as much as one, by the time spent in"
                f" trials ({rounds})"
            )
        report = envelope("trials", self.seed, result, watch)
        report["settings"] = {"objects": self.objects, "share": self.share, "attempts": self.attempts}
        print_envelope(report, json=self.json, text="\n".join(lines))
