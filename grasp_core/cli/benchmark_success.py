"""`grasp-core benchmark success`: how often planned grasps succeed on objects that nobody has planned on before."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class BenchmarkSuccess:
    """Plan on scenes of unseen objects, execute every candidate in DART with fresh seeds, and report success rates.

    Each scene shows one object in a random stable pose at a random place and yaw, with the noise of Eq. 5; each
    candidate is executed several times with that of Eq. 4. An oracle that searches the simulated grid says which scenes
    are graspable. Raw outcomes and pictures of the failures go to the folder --out.

    Attributes:
        objects: a folder of meshes (searched downwards), a suite by name, or a suite file that ends in .yaml.
        planner: one or several planners by name or settings file; "oracle" is the ceiling.
        scale: of a folder's meshes: keep takes them as metres, paper resizes the longest side to 10-20 cm, a number
            multiplies.
        poses: stable poses an object, at most; the suite's number, or 2.
        draws: scenes a pose, each at another place and yaw; the suite's number, or 1.
        attempts: executions of each candidate.
        seed: of everything random.
        limit: at most so many scenes.
        weights: of the planners with networks: a shipped name or a file.
        camera: a shipped camera or a camera file; without a pose it looks straight down from 0.70 m.
        gripper: a shipped gripper or a gripper file.
        physics: a shipped physics or a physics file.
        noise: of the image: a shipped noise or a noise file.
        out: folder for the log and the pictures.
        resume: go on with the log that is in --out.
        workers: local processes; none takes one per core, 0 works in this process.
        ray: address of a Ray cluster to work on instead.
        json: print one JSON object.
    """

    objects: str
    planner: tuple[str, ...] = ("cascade",)
    scale: str = "keep"
    poses: int | None = None
    draws: int | None = None
    attempts: int = 5
    seed: int = 0
    limit: int | None = None
    weights: str = "default"
    camera: str = "primesense"
    gripper: str = "paper"
    physics: str = "default"
    noise: str = "paper"
    out: Path | None = None
    resume: bool = False
    workers: int | None = None
    ray: str | None = None
    json: bool = False

    def run(self) -> None:
        """Run the benchmark and print its report."""
        from grasp_core.camera import load_camera
        from grasp_core.errors import GraspError
        from grasp_core.evaluation.benchmark import Benchmark
        from grasp_core.evaluation.gallery import contact_sheet
        from grasp_core.evaluation.machine import Watch, envelope, print_envelope
        from grasp_core.evaluation.success import run_benchmark
        from grasp_core.evaluation.suites import find_suite, parse_scale
        from grasp_core.evaluation.summary import summarise, text
        from grasp_core.gripper import load_gripper
        from grasp_core.parallel import Executor
        from grasp_core.sensing.noise import load_noise
        from grasp_core.simulation.physics import load_physics

        watch = Watch()
        suite = find_suite(self.objects)
        poses, draws = (suite.poses, suite.draws) if suite else (2, 1)
        benchmark = Benchmark(
            objects=self.objects,
            planners=self.planner,
            weights=self.weights,
            camera=load_camera(self.camera),
            gripper=load_gripper(self.gripper),
            physics=load_physics(self.physics),
            scale=parse_scale(self.scale),
            poses=poses if self.poses is None else self.poses,
            draws=draws if self.draws is None else self.draws,
            attempts=self.attempts,
            seed=self.seed,
            limit=self.limit,
            image_noise=load_noise(self.noise),
        )
        out = None if self.out is None else self.out.expanduser()
        if out is not None and not self.resume and (out / "outcomes.jsonl").exists():
            raise GraspError(f"{out}: holds the log of a run; go on with it with --resume, or give another folder")
        if out is None and self.resume:
            raise GraspError("--resume goes on with the log in a folder: name it with --out")
        log, refused = run_benchmark(benchmark, out, Executor(self.workers, self.ray), _Progress())
        summaries = summarise(log, self.attempts)
        report = envelope("success", self.seed, summaries, watch)
        report |= {"settings": {"objects": self.objects, "scale": self.scale}}
        report["settings"] |= {
            "poses": benchmark.poses,
            "draws": benchmark.draws,
            "attempts": self.attempts,
            "camera": self.camera,
            "noise": self.noise,
            "limit": self.limit,
        }
        report["settings"] |= {"gripper": self.gripper, "gripper_digest": benchmark.gripper.digest}
        report["settings"] |= {"physics": self.physics, "physics_digest": benchmark.physics.digest}
        report["refused"] = refused
        lines = [text(summaries), *(f"left out: {name}: {why}" for name, why in refused.items())]
        if out is not None:
            folders = [out / "failures" / Path(name).stem for name in self.planner]
            sheets = [sheet for folder in folders if (sheet := contact_sheet(folder))]
            report["files"] = {"outcomes": str(out / "outcomes.jsonl"), "failures": [str(sheet) for sheet in sheets]}
            lines += [
                f"outcomes: {out / 'outcomes.jsonl'}",
                *map(_told, sheets),
            ]
        print_envelope(report, json=self.json, text="\n".join(lines))


def _told(sheet: Path) -> str:
    from grasp_core.evaluation.gallery import failures

    return f"failures: {sheet}; all {len(failures(sheet.parent))} pictures are beside it"


class _Progress:
    """One bar a stage on stderr; silent where stderr is no terminal."""

    def __init__(self) -> None:
        self._stage = ""
        self._bar: object = None

    def __call__(self, stage: str, done: int, total: int) -> None:
        from tqdm import tqdm

        if stage != self._stage:
            if isinstance(self._bar, tqdm):
                self._bar.close()
            self._stage = stage
            self._bar = tqdm(total=total, desc=stage, unit="", file=sys.stderr, disable=None)
        if isinstance(self._bar, tqdm):
            self._bar.update(done - self._bar.n)
            if done == total:
                self._bar.close()
