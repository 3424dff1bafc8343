"""grasp-core dataset score, relabel and people: what curation needs without a browser."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, cast

import tyro

from grasp_core.dataset.labels import Kind
from grasp_core.dataset.queries import Query


@dataclass(frozen=True)
class Score:
    """Score every grasp of a dataset that has no score of these weights yet; an interrupted run goes on."""

    path: Annotated[Path, tyro.conf.Positional]
    """folder of the dataset"""
    weights: str = "default"
    """shipped name or a .safetensors file"""

    def run(self) -> int:
        """Score, with a progress bar on stderr."""
        from grasp_core.cli.dataset import Bar
        from grasp_core.dataset.predictions import score_dataset
        from grasp_core.dataset.store import DatasetStore
        from grasp_core.networks.runtime import load_runtime

        with DatasetStore.open(self.path) as store, Bar("scene") as bar:
            done = score_dataset(store, load_runtime(self.weights), progress=bar)
        print(f"{self.path}: {done.scenes} scenes scored, {done.before} were before")
        return 0


@dataclass(frozen=True)
class Relabel:
    """Give every sample of a filtered list one decision; --dry-run only counts."""

    path: Annotated[Path, tyro.conf.Positional]
    """folder of the dataset"""
    decision: Annotated[str, tyro.conf.Positional]
    """a value in [0, 1], or unsure, exclude, flag, unflag; undo takes the newest step of the person back"""
    person: str
    """who decides"""
    where: Query = field(default_factory=Query)
    """filters"""
    reason: str = ""
    """why, one sentence"""
    dry_run: bool = False
    """only count what would change"""

    def run(self) -> int:
        """Count, and label."""
        from grasp_core.cli.dataset import Bar
        from grasp_core.dataset.bulk import label_all, plan_bulk
        from grasp_core.dataset.store import DatasetStore
        from grasp_core.dataset.undo import undo

        with DatasetStore.open(self.path, readonly=self.dry_run) as store:
            if self.decision == "undo":
                print(f"{len(undo(store, self.person))} label events were taken back")
                return 0
            decision = _decision(self.decision)
            plan = plan_bulk(store, self.where, decision)
            print(
                f"{plan.samples} samples match, {plan.changing} change, {plan.human} of them were decided by people"
                " before"
            )
            if not self.dry_run and plan.samples:
                with Bar("sample") as bar:
                    bulk = label_all(store, self.where, self.person, decision, plan, reason=self.reason, progress=bar)
                print(f"{bulk.events} label events added; `relabel … undo` takes them back")
        return 0


@dataclass(frozen=True)
class People:
    """Who labelled, how well pairs agree (Cohen's kappa), and how accurate each is on hidden samples."""

    path: Annotated[Path, tyro.conf.Positional]
    """folder of the dataset"""
    json: bool = False
    """print one JSON object"""

    def run(self) -> int:
        """Print it."""
        import msgspec

        from grasp_core.dataset.agreement import accuracies, agreements, verdicts
        from grasp_core.dataset.store import DatasetStore

        with DatasetStore.open(self.path, readonly=True) as store:
            judged = {person: len(found) for person, found in verdicts(store).items()}
            pairs, accurate = agreements(store), accuracies(store)
        if self.json:
            print(msgspec.json.encode({"judged": judged, "agreements": pairs, "accuracies": accurate}).decode())
            return 0
        for person, count in sorted(judged.items()):
            print(f"{person}: {count} samples judged")
        for pair in pairs:
            kappa = "undefined" if pair.kappa is None else f"{pair.kappa:.3f}"
            print(f"{' and '.join(pair.people)}: kappa {kappa} on {pair.samples} common samples")
        for found in accurate:
            print(
                f"{found.person}: {found.right} of {found.samples} hidden samples right"
                f" ({100 * found.low:.0f}-{100 * found.high:.0f} %), {found.unsure} unsure"
            )
        return 0


def _decision(text: str) -> float | Kind:
    """A value, or a word that the store checks."""
    try:
        return float(text)
    except ValueError:
        return cast("Kind", text)
