"""grasp-core train …: train a network on a dataset, and pack both into one weights file."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import msgspec


@dataclass(frozen=True)
class _Common:
    dataset: Path
    """Folder of the dataset."""
    out: Path
    """Run folder: checkpoints, log and the trained network; an interrupted run goes on where it stopped."""
    labels: Literal["curated", "dart"] = "curated"
    """Curated: people's decisions before DART's attempts; dart: the attempts alone."""
    epochs: int | None = None
    """Passes over the training scenes, instead of the settings' number."""
    seed: int | None = None
    """Seed, instead of the settings'."""
    threads: int | None = None
    """CPU threads; all cores by default."""
    json: bool = False
    """Print the metrics as one JSON object."""


@dataclass(frozen=True)
class Regression(_Common):
    """Train the Regression Network."""

    settings: str = "regression"
    """Shipped training settings or a .yaml file."""

    def run(self) -> int:
        """Train and report."""
        _report(self.json, train_one("regression", self, self.settings))
        return 0


@dataclass(frozen=True)
class Refined(_Common):
    """Train the Refined Network."""

    settings: str = "refined"
    """Shipped training settings or a .yaml file."""

    def run(self) -> int:
        """Train and report."""
        _report(self.json, train_one("refined", self, self.settings))
        return 0


@dataclass(frozen=True)
class All(_Common):
    """Train both networks and pack them as OUT/weights.safetensors."""

    regression: str = "regression"
    """Training settings of the Regression Network: shipped, or a .yaml file."""
    refined: str = "refined"
    """Training settings of the Refined Network: shipped, or a .yaml file."""
    name: str = "weights"
    """What the weights are called."""

    def run(self) -> int:
        """Train both and pack."""
        from grasp_core.training.pack import pack

        train_one("regression", self, self.regression)
        train_one("refined", self, self.refined)
        path = self.out / "weights.safetensors"
        meta = pack(self.out, self.out, path, self.name)
        _report(self.json, {"weights": str(path), **meta.metrics})
        return 0


@dataclass(frozen=True)
class Pack:
    """Pack the networks of one or two run folders into a weights file."""

    out: Path
    """The file; its name ends in .safetensors."""
    regression: Path
    """Run folder of the Regression Network."""
    refined: Path | None = None
    """Run folder of the Refined Network; the same by default."""
    name: str | None = None
    """What the weights are called; the file's name by default."""

    def run(self) -> int:
        """Pack."""
        from grasp_core.training.pack import pack

        meta = pack(self.regression, self.refined or self.regression, self.out, self.name)
        print(f"{self.out}: {meta.name}, {self.out.stat().st_size / 1e6:.2f} MB")
        return 0


@dataclass(frozen=True)
class Assess:
    """Measure weights on a dataset: the numbers in total and per object, and three figures."""

    dataset: Path
    """Folder of the dataset."""
    out: Path
    """Folder for refined.png (curves, reliability), objects.png (per object) and regression.png (quality maps)."""
    weights: str = "default"
    """Shipped name or a .safetensors file."""
    split: Literal["train", "validation", "test"] = "validation"
    """Whose objects."""
    views: int = 2
    """Further views of each scene, from elsewhere and by tilted cameras."""
    seed: int = 0
    """Of noise and views."""
    json: bool = False
    """Print one JSON object."""

    def run(self) -> int:
        """Measure, print, draw."""
        from grasp_core.errors import StoreError
        from grasp_core.networks.runtime import load_runtime
        from grasp_core.training.assess import assess
        from grasp_core.training.corpus import load_corpus
        from grasp_core.training.figures import classifier_figure, maps_figure, objects_figure
        from grasp_core.training.scenes import Views

        runtime = load_runtime(self.weights)
        corpus = load_corpus(self.dataset, Views(count=self.views), seed=self.seed, progress=sys.stderr.isatty())
        runtime.meta.check(corpus.gripper)
        scenes = {"train": corpus.train, "validation": corpus.validation, "test": corpus.test}[self.split]
        if not scenes:
            raise StoreError(f"{self.dataset}: has no scene in its {self.split} split; choose another --split")
        found = assess(runtime, scenes, corpus.gripper.opening, seed=self.seed)
        self.out.mkdir(parents=True, exist_ok=True)
        classifier_figure(self.out / "refined.png", found.scores, found.labels)
        shown = [index * len(scenes) // 24 for index in range(24)] if len(scenes) > 24 else range(len(scenes))
        maps_figure(self.out / "regression.png", [scenes[k] for k in shown], [found.maps[k] for k in shown])
        per_object = found.by_object()
        objects_figure(self.out / "objects.png", per_object)
        if self.json:
            print(msgspec.json.encode({"totals": found.totals, "objects": per_object}).decode())
            return 0
        _report(False, {name: round(value, 4) for name, value in found.totals.items()})
        for name, values in per_object.items():
            print(f"  {name:<22}", "  ".join(f"{key} {value:.3f}" for key, value in values.items()))
        return 0


@dataclass(frozen=True)
class Compare:
    """Train variants of a network for a few epochs each and compare them on validation objects (ablation)."""

    dataset: Path
    """Folder of the dataset."""
    out: Path
    """Folder of the runs and of ablation.csv; an interrupted ablation goes on where it stopped."""
    ablation: str = "refined"
    """What is compared: shipped, or a .yaml file."""
    threads: int | None = None
    """CPU threads; all cores by default."""
    json: bool = False
    """Print one JSON object a variant."""

    def run(self) -> int:
        """Train, print the rows."""
        import torch

        from grasp_core import config
        from grasp_core.training.ablation import Ablation, run_ablation
        from grasp_core.training.corpus import load_corpus

        if self.threads is not None:
            torch.set_num_threads(self.threads)
        progress = sys.stderr.isatty()
        chosen = config.load("ablations", self.ablation, Ablation)
        rows = run_ablation(
            chosen, lambda views: load_corpus(self.dataset, views, progress=progress), self.out, progress=progress
        )
        for row in rows:
            if self.json:
                print(msgspec.json.encode(row).decode(), flush=True)
                continue
            words = "  ".join(f"{name} {value:.4f}" for name, value in row.metrics.items())
            print(f"{row.variant:<30} {row.parameters:>10,} parameters  {row.seconds:7.1f} s  {words}", flush=True)
        return 0


def train_one(network: Literal["regression", "refined"], options: _Common, settings: str) -> dict[str, Any]:
    """Train one network, keep it in the run folder, and give its metrics."""
    import torch

    from grasp_core import config
    from grasp_core.training.corpus import load_corpus
    from grasp_core.training.pack import Part, save_part
    from grasp_core.training.refined import RefinedSettings, train_refined
    from grasp_core.training.regression import RegressionSettings, train_regression

    if options.threads is not None:
        torch.set_num_threads(options.threads)
    chosen: RegressionSettings | RefinedSettings
    if network == "regression":
        chosen = config.load("training", settings, RegressionSettings)
    else:
        chosen = config.load("training", settings, RefinedSettings)
    changed = {name: getattr(options, name) for name in ("epochs", "seed") if getattr(options, name) is not None}
    chosen = msgspec.structs.replace(chosen, schedule=msgspec.structs.replace(chosen.schedule, **changed))
    seed = chosen.schedule.seed
    progress = sys.stderr.isatty()
    corpus = load_corpus(options.dataset, chosen.views, labels=options.labels, seed=seed, progress=progress)
    about = f"{config.digest(chosen)} {corpus.digest}"
    opening = corpus.gripper.opening
    part = Part(
        network=network,
        gripper=corpus.gripper.name,
        gripper_digest=corpus.gripper.digest,
        physics=corpus.physics,
        recipe={**corpus.recipe, "settings": Path(settings).stem, "seed": seed},
    )
    if isinstance(chosen, RefinedSettings):
        task, fit = train_refined(
            corpus.train, corpus.validation, chosen, opening, options.out, about=about, progress=progress
        )
        test = task.measures(corpus.test) if corpus.test else {}
        part = msgspec.structs.replace(part, crop=chosen.crop, width=chosen.width)
        network_module: torch.nn.Module = task.network
    else:
        map_task, fit = train_regression(
            corpus.train, corpus.validation, chosen, opening, options.out, about=about, progress=progress
        )
        graspable = [scene for scene in corpus.test if len(scene.perfect)]
        test = map_task.measures(graspable) if graspable else {}
        network_module = map_task.network
    metrics = {**fit.metrics, **{f"test_{key}": value for key, value in test.items()}}
    part = msgspec.structs.replace(part, recipe={**part.recipe, "epochs": len(fit.history)})
    part = msgspec.structs.replace(part, metrics={key: round(value, 5) for key, value in metrics.items()})
    path = save_part(options.out, network_module, part)
    return {"network": str(path), "epochs": len(fit.history), "stopped": fit.stopped, **part.metrics}


def _report(as_json: bool, values: dict[str, Any]) -> None:
    if as_json:
        print(msgspec.json.encode(values).decode())
        return
    for key, value in values.items():
        print(f"{key:<24} {value}")
