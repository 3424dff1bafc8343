"""The mending experiment: spoil labels of a copy of a dataset, find them by disagreement, mend them, train again.

A tenth of the training labels is flipped by a made-up person. The Refined Network learns from the spoiled labels, its
scores are compared with them, and the samples where both are furthest apart are tried anew in DART; what these fresh
attempts say becomes their label. Nothing that was known before the flip is used. Validation labels are left alone, so
that the three trainings (clean, spoiled, mended) are measured against the truth.
"""

from __future__ import annotations

import random
import shutil
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec
import numpy as np

from grasp_core import config
from grasp_core.dataset.database import FILE
from grasp_core.dataset.generate import attempt_row
from grasp_core.dataset.predictions import score_dataset
from grasp_core.dataset.queries import Query
from grasp_core.dataset.rows import AttemptRow
from grasp_core.dataset.store import DatasetStore
from grasp_core.dataset.trials import fresh_seeds, scene_trial
from grasp_core.errors import GraspError
from grasp_core.grasp import Grasp
from grasp_core.networks.runtime import load_runtime
from grasp_core.networks.weights import Weights, load_weights, save_weights
from grasp_core.parallel import Executor, map_scenes
from grasp_core.simulation.trial import GraspTrial
from grasp_core.training.corpus import load_corpus
from grasp_core.training.pack import Part, load_part, save_part
from grasp_core.training.refined import RefinedSettings, train_refined

SPOILER = "spoiler"
MENDER = "mender"
MEASURES = ("ap", "auc", "brier", "accuracy")

Tell = Callable[[str], None]


class Mending(msgspec.Struct, frozen=True):
    """The experiment's results.

    Attributes:
        labels: of the training split.
        spoiled: of them, flipped.
        reviewed: samples that were tried anew.
        found: of them, flipped ones.
        chance: flipped ones that as many samples at random would have held.
        mended: of the found ones, labels that lie on their old side of 0.5 again.
        harmed: sound labels that the review moved to the other side of 0.5.
        clean: measures on validation objects after training on the labels as they were; means over the seeds.
        spoiled_measures: after training on the spoiled labels.
        mended_measures: after training on the mended labels.
        recovered: measure → share of the loss that mending won back; None where spoiling lost nothing.
        seeds: of the trainings.
    """

    labels: int
    spoiled: int
    reviewed: int
    found: int
    chance: float
    mended: int
    harmed: int
    clean: dict[str, float]
    spoiled_measures: dict[str, float]
    mended_measures: dict[str, float]
    recovered: dict[str, float | None]
    seeds: tuple[int, ...]


@dataclass(frozen=True)
class Experiment:
    """What is done.

    Attributes:
        dataset: folder; it stays as it is.
        out: folder of the spoiled copy and of the training runs; an interrupted experiment goes on there.
        settings: of the Refined Network's training.
        spoil: share of the training labels that is flipped.
        review: share that is looked at again, those of most disagreement.
        attempts: fresh ones for each of these.
        seeds: of the trainings; measures are averaged over them.
    """

    dataset: Path
    out: Path
    settings: RefinedSettings
    spoil: float = 0.1
    review: float = 0.15
    attempts: int = 5
    seeds: tuple[int, ...] = (0,)

    def __post_init__(self) -> None:
        if not (0 < self.spoil <= 0.5 and 0 < self.review <= 1) or self.attempts < 1 or not self.seeds:
            raise GraspError("spoil lies in (0, 0.5], review in (0, 1], and it takes at least one attempt and one seed")


def run_mending(
    experiment: Experiment, executor: Executor | None = None, *, tell: Tell = lambda _: None, progress: bool = False
) -> Mending:
    """Run the experiment, or what is missing of it.

    Args:
        experiment: what is done.
        executor: where the fresh attempts run.
        tell: called with what is done next.
        progress: show the bars of the trainings.

    Raises:
        GraspError: a dataset without labels, or one whose physics this version cannot reproduce.
    """
    out = experiment.out
    tell("copy and spoil")
    copy = copy_dataset(experiment.dataset, out / "dataset")
    before = training_labels(experiment.dataset)
    with DatasetStore.open(copy) as store:
        flipped = spoil(store, experiment.spoil)
    clean = _train_all(experiment, experiment.dataset, "clean", tell, progress)
    finding = out / "found.json"
    if not finding.exists():  # afterwards the spoiled labels are no more
        spoiled = _train_all(experiment, copy, "spoiled", tell, progress)
        tell("find by disagreement")
        with DatasetStore.open(copy) as store:
            score_dataset(store, load_runtime(refined_weights(out / f"spoiled-{experiment.seeds[0]}")))
            chosen = most_mistaken(store, experiment.review)
        finding.write_bytes(msgspec.json.encode((chosen, spoiled)))
    chosen, spoiled = msgspec.json.decode(finding.read_bytes(), type=tuple[list[int], dict[str, float]])
    with DatasetStore.open(copy) as store:
        retry(store, chosen, experiment.attempts, executor, tell)
    mended = _train_all(experiment, copy, "mended", tell, progress)
    after = training_labels(copy)
    same = {grasp: (after[grasp] > 0.5) == (label > 0.5) for grasp, label in before.items()}
    lost = {name: clean[name] - spoiled[name] for name in MEASURES}
    return Mending(
        labels=len(before),
        spoiled=len(flipped),
        reviewed=len(chosen),
        found=len(flipped.intersection(chosen)),
        chance=round(len(chosen) * len(flipped) / len(before), 1),
        mended=sum(same[grasp] for grasp in flipped.intersection(chosen)),
        harmed=sum(not same[grasp] for grasp in set(chosen) - flipped),
        clean=clean,
        spoiled_measures=spoiled,
        mended_measures=mended,
        recovered={k: round((mended[k] - spoiled[k]) / lost[k], 3) if lost[k] else None for k in MEASURES},
        seeds=experiment.seeds,
    )


def copy_dataset(source: Path, target: Path) -> Path:
    """A copy of a dataset in a new folder; one that is there already is kept."""
    if (target / FILE).exists():
        return target
    with DatasetStore.open(source, readonly=True) as store:
        for part in ("depth", "objects"):
            shutil.copytree(store.path / part, target / part, dirs_exist_ok=True)
        store.backup(target / FILE)
    return target


def training_labels(dataset: Path) -> dict[int, float]:
    """Sample → label of the training split.

    Raises:
        GraspError: it has no label.
    """
    with DatasetStore.open(dataset, readonly=True) as store:
        found = store.rows("SELECT grasp, label FROM samples WHERE split = 'train' AND label IS NOT NULL")
    if not found:
        raise GraspError(f"{dataset}: its training split has no label")
    return {row["grasp"]: row["label"] for row in found}


def spoil(store: DatasetStore, share: float) -> set[int]:
    """Flip a share of the training labels, drawn at random, unless that was done before; the flipped samples."""
    events = store.batch(SPOILER)
    if events:
        return {event.grasp for event in events}
    found = store.rows("SELECT grasp, label FROM samples WHERE split = 'train' AND label IS NOT NULL ORDER BY grasp")
    labels = {row["grasp"]: row["label"] for row in found}
    chosen = random.Random(0).sample(list(labels), max(1, round(share * len(labels))))
    with store.transaction():
        for grasp in chosen:
            store.add_label(grasp, SPOILER, 1 - labels[grasp], reason="flipped on purpose", batch=SPOILER)
    return set(chosen)


def most_mistaken(store: DatasetStore, share: float) -> list[int]:
    """The training samples whose score and label are furthest apart, as a share of all labelled ones."""
    total = store.count(Query(split="train", label=(0.0, 1.0)))
    query = Query(split="train", sort="mistake", descending=True)
    return [row.id for row in store.page(query, size=max(1, round(share * total))).rows]


@dataclass(frozen=True)
class _Retry:
    """Grasps of one scene to execute, each with its seeds."""

    trial: GraspTrial
    grasps: tuple[Grasp, ...]
    seeds: tuple[tuple[int, ...], ...]


def _attempts(item: _Retry) -> list[list[AttemptRow]]:
    return [
        [attempt_row(item.trial.attempt(grasp, seed)) for seed in seeds]
        for grasp, seeds in zip(item.grasps, item.seeds, strict=True)
    ]


def retry(store: DatasetStore, chosen: Sequence[int], attempts: int, executor: Executor | None, tell: Tell) -> None:
    """Try samples anew in DART and label each by what its fresh attempts say; those done before are left out."""
    done = {event.grasp for event in store.events_of(MENDER, limit=10**9)}
    scenes: dict[int, list[int]] = defaultdict(list)
    for grasp in chosen:
        if grasp not in done:
            scenes[store.grasp(grasp).scene].append(grasp)
    ordered = list(scenes.values())
    items = [
        _Retry(
            scene_trial(store, scene),
            tuple(store.grasp(grasp).grasp for grasp in grasps),
            tuple(tuple(fresh_seeds(store, grasp, attempts)) for grasp in grasps),
        )
        for scene, grasps in scenes.items()
    ]
    for count, (index, rows) in enumerate(map_scenes(_attempts, items, executor), start=1):
        tell(f"tried anew {count} of {len(items)} scenes")
        with store.transaction():
            for grasp, fresh in zip(ordered[index], rows, strict=True):
                store.add_attempts(grasp, fresh, person=MENDER, reason="verified in DART")
                quality = sum(row.outcome == "SUCCESS" for row in fresh) / len(fresh)
                store.add_label(grasp, MENDER, quality, reason="what fresh attempts say")


def refined_weights(folder: Path) -> Path:
    """A weights file with a run's Refined Network, beside the shipped Regression Network that nobody asks."""
    part, state = load_part(folder, "refined")
    shipped = {name: array for name, array in load_weights().state.items() if name.startswith("regression.")}
    meta = Weights(
        name=folder.name, gripper=part.gripper, gripper_digest=part.gripper_digest, crop=part.crop, width=part.width
    )
    return save_weights(folder / "weights.safetensors", {**shipped, **state}, meta)


def _train_all(experiment: Experiment, dataset: Path, name: str, tell: Tell, progress: bool) -> dict[str, float]:
    """Mean measures on validation objects over the seeds."""
    found = []
    for seed in experiment.seeds:
        tell(f"train on {name} labels, seed {seed}")
        schedule = msgspec.structs.replace(experiment.settings.schedule, seed=seed)
        settings = msgspec.structs.replace(experiment.settings, schedule=schedule)
        folder = experiment.out / f"{name}-{seed}"
        corpus = load_corpus(dataset, settings.views, seed=seed, progress=progress)
        about = f"{config.digest(settings)} {corpus.digest}"
        opening = corpus.gripper.opening
        task, fit = train_refined(
            corpus.train, corpus.validation, settings, opening, folder, about=about, progress=progress
        )
        part = Part(
            network="refined",
            gripper=corpus.gripper.name,
            gripper_digest=corpus.gripper.digest,
            physics=corpus.physics,
            crop=settings.crop,
            width=settings.width,
        )
        save_part(folder, task.network, part)
        found.append([fit.metrics[measure] for measure in MEASURES])
    means = np.mean(found, axis=0)
    return {measure: round(float(value), 5) for measure, value in zip(MEASURES, means, strict=True)}
