"""`grasp-core benchmark curation`: how long pages, filters and labels take on a large made dataset."""

from __future__ import annotations

import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class BenchmarkCuration:
    """Make a dataset of many samples and time what people do with its lists: pages, filters, labels, a dry run.

    Attributes:
        samples: at least so many.
        out: folder to keep the made dataset in, or where it was kept; by default it is made anew and thrown away.
        repeat: how often each list is asked for.
        seed: of everything random.
        json: print one JSON object.
    """

    samples: int = 1_000_000
    out: Path | None = None
    repeat: int = 5
    seed: int = 0
    json: bool = False

    def run(self) -> None:
        """Run the benchmark and print its report."""
        from grasp_core.dataset.database import FILE
        from grasp_core.dataset.store import DatasetStore
        from grasp_core.errors import GraspError
        from grasp_core.evaluation.curation import run_curation
        from grasp_core.evaluation.machine import Watch, envelope, print_envelope
        from grasp_core.evaluation.made_dataset import Made, make_dataset
        from grasp_core.evaluation.report import table

        if self.samples < 1 or self.repeat < 1:
            raise GraspError(f"--samples and --repeat must be at least 1, not {self.samples} and {self.repeat}")
        with tempfile.TemporaryDirectory() as folder:
            path = self.out or Path(folder) / "made"
            if (path / FILE).exists():
                store = DatasetStore.open(path)
            else:
                made = Made(samples=self.samples, decisions=max(1, self.samples // 50), seed=self.seed)
                store = make_dataset(path, made, progress=_progress)
            with store:
                watch = Watch()
                found = run_curation(
                    store, repeat=self.repeat, seed=self.seed, tell=lambda text: print(text, file=sys.stderr)
                )
        rows = [
            *((f"page by {name}", times) for name, times in found.page_ms.items()),
            *((f"filter {name}", times) for name, times in found.filter_ms.items()),
            ("label", found.label_ms),
            ("undo", found.undo_ms),
            ("dry run", found.dry_run_ms),
        ]
        text = table(
            ("ms", "median", "slowest", "processor"),
            [(name, times.median_ms, times.most_ms, times.cpu_most_ms) for name, times in rows],
        )
        report = envelope("curation", self.seed, found, watch)
        print_envelope(report, json=self.json, text=f"{found.samples} samples, {found.events} label events\n\n{text}")


def _progress(done: int, total: int) -> None:
    if done % 100 == 0 or done == total:
        print(f"made {done} of {total} scenes", file=sys.stderr)
