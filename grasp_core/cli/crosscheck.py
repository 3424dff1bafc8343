"""`grasp-core crosscheck`: whether verdicts depend on the time step, the collision detector or the physics engine."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from grasp_core.evaluation.crosscheck import Crosscheck


@dataclass(frozen=True)
class CrosscheckCommand:
    """Judge the same grasps in DART, in DART with other settings, and in MuJoCo, and compare the verdicts.

    The grasps are those of a fine grid that need dynamics, executed without noise; with that of Eq. 4 the qualities
    in DART and MuJoCo are correlated. What was judged is logged in --out: stopped and started again with the same
    arguments it goes on. Pictures there show one grasp of each class of disagreement in both engines. Needs the extra
    `crosscheck`.

    Attributes:
        objects: a suite by name, a suite file, or a folder of meshes (in metres).
        engines: to compare with DART: whole (lift), half (time step), fcl (detector), mujoco.
        grasps: noiseless ones an object.
        poses: stable poses an object, at most; the grasps are spread over them.
        noisy: grasps an object whose qualities are correlated.
        attempts: noisy executions of each of those.
        seed: of the choice of grasps and the noise.
        gripper: a shipped gripper or a gripper file.
        physics: a shipped physics or a physics file.
        out: folder for the log and the pictures; in the user's data folder by default.
        workers: local processes; none takes one per core, 0 works in this process.
        json: print one JSON object.
    """

    objects: str = "trials"
    engines: tuple[str, ...] = ("whole", "half", "fcl", "mujoco")
    grasps: int = 200
    poses: int = 2
    noisy: int = 20
    attempts: int = 10
    seed: int = 0
    gripper: str = "paper"
    physics: str = "default"
    out: Path | None = None
    workers: int | None = None
    json: bool = False

    def run(self) -> None:
        """Compare, with a progress bar on stderr."""
        import platformdirs
        import tqdm

        from grasp_core.errors import GraspError
        from grasp_core.evaluation.crosscheck import Plan, run_crosscheck
        from grasp_core.evaluation.machine import Watch, envelope, print_envelope
        from grasp_core.evaluation.suites import object_plans
        from grasp_core.gripper import load_gripper
        from grasp_core.parallel import Executor
        from grasp_core.simulation.physics import load_physics

        if self.grasps < 1 or self.poses < 1 or self.noisy < 0 or self.attempts < 1 or self.seed < 0:
            raise GraspError("--grasps, --poses and --attempts must be at least 1, --noisy and --seed at least 0")
        gripper, physics = load_gripper(self.gripper), load_physics(self.physics)
        sources = object_plans(self.objects, "keep", self.seed)
        plan = Plan(
            tuple(source.name for source in sources),
            self.engines,
            self.grasps,
            self.poses,
            self.noisy,
            self.attempts,
            self.seed,
            physics.digest,
            gripper.digest,
        )
        out = self.out or Path(platformdirs.user_data_dir("grasp-workbench")) / "crosscheck"
        watch = Watch()
        with tqdm.tqdm(desc="crosscheck", unit="chunk") as bar:

            def progress(done: int, total: int) -> None:
                bar.total = total
                bar.update(done - bar.n)

            result = run_crosscheck(sources, plan, gripper, physics, out, Executor(self.workers), progress)
        report = envelope("crosscheck", self.seed, result, watch)
        if self.json:
            print(json.dumps(report, ensure_ascii=False))
        else:
            print_envelope(report, json=False, text=_text(result))


def _text(result: Crosscheck) -> str:
    from grasp_core.evaluation.report import table

    rows = [
        (c.words, c.all.count, f"{c.all.agreement:.3f}", f"{c.goal:.3f}", f"{c.all.kappa:.2f}", f"{c.all.outcomes:.3f}")
        for c in result.engines.values()
    ]
    lines = [table(("DART against", "grasps", "agreement", "goal", "kappa", "same outcome"), rows), ""]
    names = sorted({name for c in result.engines.values() for name in c.objects})
    per = [(n, *(f"{c.objects[n].agreement:.3f}" for c in result.engines.values())) for n in names]
    lines += [table(("object", *result.engines), per), ""]
    for name, comparison in result.engines.items():
        differ = {pair: n for pair, n in comparison.all.confusion.items() if len(set(pair.split("→"))) == 2}
        lines.append(f"DART → {name}: " + (", ".join(f"{pair} {n}" for pair, n in differ.items()) or "no difference"))
        lines += [f"  {pair}: {path}" for pair, path in comparison.pictures.items()]
    if result.quality_correlation is not None:
        lines.append(
            f"qualities with noise, {result.qualities} grasps: DART and MuJoCo correlate at"
            f" {result.quality_correlation:.3f} and differ by {result.quality_difference:.3f} on average"
        )
    return "\n".join(lines)
