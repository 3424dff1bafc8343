"""Ablations: the same training with one thing changed at a time, compared on validation objects.

Each variant is a run folder of its own, so that an interrupted ablation goes on where it stopped.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, Literal

import msgspec

from grasp_core import config
from grasp_core.errors import ConfigError
from grasp_core.training.corpus import Corpus
from grasp_core.training.loop import Fit
from grasp_core.training.refined import RefinedSettings, train_refined
from grasp_core.training.regression import RegressionSettings, train_regression
from grasp_core.training.scenes import Views

BASE = "as shipped"
"""Name of the variant that changes nothing."""

Settings = RefinedSettings | RegressionSettings


class Ablation(config.Settings):
    """What is compared.

    Attributes:
        network: which one is trained.
        settings: training settings that the variants change: shipped, or a .yaml file.
        epochs: of each variant; fewer than in a real training, since only differences count.
        variants: name → changed keys, nested as in the settings file.
    """

    network: Literal["regression", "refined"]
    settings: str
    epochs: int
    variants: dict[str, dict[str, Any]]

    def __post_init__(self) -> None:
        if self.epochs < 1:
            raise ValueError(f"epochs must be at least 1, not {self.epochs}")
        if BASE in self.variants:
            raise ValueError(f"'{BASE}' is the variant that changes nothing; give yours another name")


class Row(msgspec.Struct, frozen=True):
    """One variant's result.

    Attributes:
        variant: its name.
        parameters: of the network.
        seconds: of training, validation included.
        metrics: of the best epoch on validation objects, by name.
    """

    variant: str
    parameters: int
    seconds: float
    metrics: dict[str, float]


def variant_settings(ablation: Ablation) -> dict[str, Settings]:
    """Variant → its settings; the unchanged one comes first.

    Raises:
        ConfigError: a changed key does not exist or has an impossible value; the message names the variant.
    """
    kind: type[Settings] = RefinedSettings if ablation.network == "refined" else RegressionSettings
    base = config.read_yaml(config.locate("training", ablation.settings))
    found: dict[str, Settings] = {}
    for name, changes in {BASE: {}, **ablation.variants}.items():
        chosen = config.convert(_merged(base, changes), kind, f"variant '{name}' of {ablation.settings}")
        found[name] = msgspec.structs.replace(
            chosen, schedule=msgspec.structs.replace(chosen.schedule, epochs=ablation.epochs)
        )
    return found


def run_ablation(
    ablation: Ablation, load: Callable[[Views], Corpus], out: Path, *, progress: bool = True
) -> Iterator[Row]:
    """Train every variant and give its row when it is done; `out/ablation.csv` holds all rows so far.

    Args:
        ablation: what is compared.
        load: reads the dataset with its further views.
        out: folder of the runs.
        progress: show progress bars.

    Raises:
        ConfigError: see `variant_settings` and `loop.fit`.
    """
    rows: list[Row] = []
    views, corpus = None, None
    for name, settings in variant_settings(ablation).items():
        if corpus is None or settings.views != views:
            views, corpus = settings.views, load(settings.views)
        rows.append(_train(name, settings, corpus, out / name.replace("/", "_"), progress))
        _write(out / "ablation.csv", rows)
        yield rows[-1]


def _train(name: str, settings: Settings, corpus: Corpus, folder: Path, progress: bool) -> Row:
    about = f"{config.digest(settings)} {corpus.digest}"
    fitted: Fit
    if isinstance(settings, RefinedSettings):
        task, fitted = train_refined(
            corpus.train, corpus.validation, settings, corpus.gripper.opening, folder, about=about, progress=progress
        )
        network = task.network
    else:
        other, fitted = train_regression(
            corpus.train, corpus.validation, settings, corpus.gripper.opening, folder, about=about, progress=progress
        )
        network = other.network  # type: ignore[assignment]
    count = sum(parameter.numel() for parameter in network.parameters())
    return Row(name, count, round(sum(record["seconds"] for record in fitted.history), 1), fitted.metrics)


def _merged(base: Any, changes: dict[str, Any]) -> dict[str, Any]:
    """A copy of nested values with others put in their place."""
    if not isinstance(base, dict):
        raise ConfigError("training settings are a mapping of keys to values")
    merged = dict(base)
    for key, value in changes.items():
        merged[key] = _merged(merged.get(key) or {}, value) if isinstance(value, dict) else value
    return merged


def _write(path: Path, rows: Sequence[Row]) -> None:
    with path.open("w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(["variant", "parameters", "seconds", *rows[0].metrics])
        for row in rows:
            values = (f"{row.metrics[name]:.5f}" for name in rows[0].metrics)
            writer.writerow([row.variant, row.parameters, row.seconds, *values])
