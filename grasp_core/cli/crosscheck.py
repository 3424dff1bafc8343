"""`grasp-core crosscheck`: whether verdicts depend on the time step, the collision detector or the physics engine."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class CrosscheckCommand:
    """Judge the same grasps in DART, in DART with other settings, and in MuJoCo, and compare the verdicts.

    The grasps are those of a fine grid that need dynamics, executed without noise; with that of Eq. 4 the qualities
    in DART and MuJoCo are correlated, if MuJoCo is among the engines, which needs the extra `crosscheck`. Executions
    that diverge (UNSTABLE) are no verdicts: they are left out and their share is reported. What was judged is logged in
    --out: stopped and started again with the same arguments, code and objects it goes on. Pictures there show one
    grasp of each class of disagreement in both engines.

    Attributes:
        objects: a suite by name, a suite file, or a folder of meshes (in metres).
        engines: to compare with DART: whole (lift), half (time step), fcl (detector), mujoco.
        grasps: noiseless ones an object.
        poses: stable poses an object, at most; the grasps are spread over them.
        noisy: grasps an object whose qualities in DART and MuJoCo are correlated.
        attempts: noisy executions of each of those.
        seed: of the choice of grasps and the noise.
        gripper: a shipped gripper or a gripper file.
        physics: a shipped physics or a physics file.
        out: folder for the log and the pictures; by default one in the user's data folder, of this comparison alone.
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

        from grasp_core.evaluation.crosscheck import run_crosscheck
        from grasp_core.evaluation.crosscheck_text import text
        from grasp_core.evaluation.machine import Watch, envelope, print_envelope
        from grasp_core.evaluation.suites import object_plans
        from grasp_core.evaluation.verdicts import make_plan
        from grasp_core.gripper import load_gripper
        from grasp_core.parallel import Executor
        from grasp_core.simulation.physics import load_physics

        gripper, physics = load_gripper(self.gripper), load_physics(self.physics)
        sources = object_plans(self.objects, "keep", self.seed)
        executor = Executor(self.workers)
        with _bar("objects", "object") as progress:
            plan = make_plan(
                sources,
                self.engines,
                gripper,
                physics,
                grasps=self.grasps,
                poses=self.poses,
                noisy=self.noisy,
                attempts=self.attempts,
                seed=self.seed,
                executor=executor,
                progress=progress,
            )
        out = self.out or Path(platformdirs.user_data_dir("grasp-workbench")) / "crosscheck" / plan.digest
        watch = Watch()
        with _bar("crosscheck", "chunk") as progress:
            result = run_crosscheck(sources, plan, gripper, physics, out, executor, progress)
        report = envelope("crosscheck", self.seed, result, watch)
        report["settings"] = {"objects": self.objects, "physics": self.physics, "gripper": self.gripper}
        report["out"] = str(out)
        print_envelope(report, json=self.json, text=f"{text(result)}\n\nlog and pictures: {out}")


@contextmanager
def _bar(what: str, unit: str) -> Iterator[Callable[[int, int], None]]:
    """A progress bar on stderr, told how much is done of how much."""
    import tqdm

    with tqdm.tqdm(desc=what, unit=unit) as bar:

        def progress(done: int, total: int) -> None:
            bar.total = total
            bar.update(done - bar.n)

        yield progress
