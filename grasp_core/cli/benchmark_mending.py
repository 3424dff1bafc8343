"""`grasp-core benchmark mending`: how much of the loss by wrong labels curation wins back."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class BenchmarkMending:
    """Flip labels in a copy of a dataset, find them by disagreement, try them anew in DART, and train again.

    Attributes:
        dataset: folder of the dataset; it stays as it is.
        out: folder of the copy and of the training runs; an interrupted experiment goes on there.
        settings: training settings of the Refined Network: shipped, or a .yaml file.
        epochs: passes over the training scenes, instead of the settings' number.
        spoil: share of the training labels that is flipped.
        review: share that is tried anew, those of most disagreement.
        attempts: fresh ones for each of these.
        seeds: trainings to average over.
        workers: local processes for the attempts, by default one per core.
        json: print one JSON object.
    """

    dataset: Path
    out: Path
    settings: str = "refined"
    epochs: int | None = None
    spoil: float = 0.1
    review: float = 0.15
    attempts: int = 5
    seeds: int = 1
    workers: int | None = None
    json: bool = False

    def run(self) -> None:
        """Run the experiment and print its report."""
        import msgspec

        from grasp_core import config
        from grasp_core.evaluation.machine import Watch, envelope, print_envelope
        from grasp_core.evaluation.mending import MEASURES, Experiment, run_mending
        from grasp_core.evaluation.report import table
        from grasp_core.parallel import Executor
        from grasp_core.training.refined import RefinedSettings

        settings = config.load("training", self.settings, RefinedSettings)
        if self.epochs is not None:
            schedule = msgspec.structs.replace(settings.schedule, epochs=self.epochs)
            settings = msgspec.structs.replace(settings, schedule=schedule)
        experiment = Experiment(
            self.dataset, self.out, settings, self.spoil, self.review, self.attempts, tuple(range(self.seeds))
        )
        watch = Watch()
        found = run_mending(
            experiment,
            Executor(self.workers),
            tell=lambda text: print(text, file=sys.stderr),
            progress=sys.stderr.isatty(),
        )
        rows = [
            (
                name,
                f"{found.clean[name]:.4f}",
                f"{found.spoiled_measures[name]:.4f}",
                f"{found.mended_measures[name]:.4f}",
                "" if found.recovered[name] is None else f"{100 * (found.recovered[name] or 0):.0f} %",
            )
            for name in MEASURES
        ]
        text = "\n".join(
            [
                f"{found.spoiled} of {found.labels} training labels were flipped; {found.reviewed} were tried anew,"
                f" {found.found} of them flipped ones (chance: {found.chance:.0f}); {found.mended} were mended,"
                f" {found.harmed} sound ones harmed",
                "",
                table(("validation", "clean", "spoiled", "mended", "recovered"), rows),
            ]
        )
        print_envelope(envelope("mending", 0, found, watch), json=self.json, text=text)
