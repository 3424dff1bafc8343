"""The training loop that both networks share: schedule, checkpoints and resume, log, progress, early stop.

A run is a folder. Each network keeps two files there: `NAME.pt` (state, best state, optimiser, history; plain tensors
and JSON, read without unpickling code) and `NAME.csv` (one line an epoch); where TensorBoard is installed (extra
`report`), its log is `tensorboard/NAME`. Every epoch draws from a generator seeded by (seed, epoch), so an interrupted
run ends like an uninterrupted one.
"""

from __future__ import annotations

import csv
import importlib.util
import math
import os
import time
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import AbstractContextManager, closing, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, TypeVar

import msgspec
import numpy as np
import torch
from torch import Tensor, nn
from tqdm import tqdm

from grasp_core import config
from grasp_core.errors import ConfigError

Batch = tuple[Tensor, ...]
T = TypeVar("T")


class Schedule(config.Settings):
    """How long and how fast.

    Attributes:
        epochs: passes over the training scenes, at most; each pass shows every scene in one of its views.
        batch: samples a step.
        rate: highest learning rate.
        weight_decay: of AdamW.
        warmup: share of all steps in which the rate rises to its highest; it then falls along a cosine.
        patience: epochs without a better validation measure before stopping early.
        seed: of initial weights, order and augmentation.
    """

    epochs: int
    batch: int
    rate: float
    weight_decay: float = 1e-4
    warmup: float = 0.15
    patience: int = 8
    seed: int = 0

    def __post_init__(self) -> None:
        if min(self.epochs, self.batch, self.patience) < 1:
            raise ValueError("epochs, batch and patience are at least 1")
        if self.rate <= 0 or self.weight_decay < 0 or not 0 <= self.warmup < 1:
            raise ValueError("rate is above 0, weight_decay at least 0, warmup a share below 1")

    def rate_at(self, progress: float) -> float:
        """The learning rate after a share `progress` of all steps, in [0, 1]."""
        if progress < self.warmup:
            return self.rate * (0.05 + 0.95 * progress / self.warmup)
        falling = (progress - self.warmup) / (1 - self.warmup)
        return self.rate * (0.01 + 0.99 * (1 + math.cos(math.pi * min(falling, 1.0))) / 2)


class Task(Protocol):
    """One network to train.

    Attributes:
        name: "regression" or "refined"; names the files.
        network: on its device.
        measure: the validation measure that decides which epoch is best; higher is better.
    """

    name: str
    measure: str

    @property
    def network(self) -> nn.Module: ...  # noqa: D102

    def batches(self, rng: np.random.Generator) -> Iterator[tuple[float, Batch]]:
        """(Share of the epoch done after it, batch) for every step of one epoch."""
        ...

    def loss(self, batch: Batch) -> Tensor:
        """Mean loss of a batch."""
        ...

    def validate(self) -> dict[str, float]:
        """Validation measures by name."""
        ...


@dataclass(frozen=True)
class Fit:
    """A finished training.

    Attributes:
        metrics: of the best epoch.
        history: one record an epoch.
        stopped: why it ended.
    """

    metrics: dict[str, float]
    history: list[dict[str, float]]
    stopped: str


def pick_device() -> torch.device:
    """CUDA where there is a device, else the CPU."""
    return torch.device("cuda" if torch.cuda.is_available() else "cpu")


def half_precision(device: torch.device) -> bool:
    """Whether bfloat16 arithmetic is native there, so that training in mixed precision pays."""
    if device.type == "cuda":
        return torch.cuda.is_bf16_supported()
    return bool(torch.cpu.get_capabilities().get("avx512_bf16", False))


def fit(task: Task, schedule: Schedule, folder: Path, *, about: str, progress: bool = True) -> Fit:
    """Train a network, or go on where an interrupted run stopped; the network ends with its best epoch's weights.

    Args:
        task: network, data and loss.
        schedule: how long and how fast.
        folder: of the run; made when missing.
        about: a digest of settings and data; an earlier run in the folder must have the same.
        progress: show a progress bar.

    Raises:
        ConfigError: the folder holds a run with other settings or data, or cannot be written.
    """
    path = folder / f"{task.name}.pt"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ConfigError(f"{folder}: cannot be made ({error.strerror})") from error
    optimizer = torch.optim.AdamW(task.network.parameters(), schedule.rate, weight_decay=schedule.weight_decay)
    history: list[dict[str, float]] = []
    best: dict[str, Tensor] = {}
    if path.exists():
        saved = read_run(path)
        if saved["about"] != about:
            raise ConfigError(
                f"{path}: was trained with other settings or data; give another --out folder or remove that file"
            )
        task.network.load_state_dict(saved["state"])
        optimizer.load_state_dict(saved["optimizer"])
        best, history = saved["best"], msgspec.json.decode(saved["history"])
    stopped = "all epochs done"
    bar = tqdm(
        total=schedule.epochs,
        initial=len(history),
        desc=task.name,
        disable=not progress,
        bar_format="{desc}: {percentage:3.0f} %|{bar}| {elapsed}<{remaining}{postfix}",
    )
    with bar, _board(folder / "tensorboard" / task.name, len(history)) as board:
        for epoch in range(len(history), schedule.epochs):
            if _stale(history, task.measure) >= schedule.patience:
                stopped = f"no better {task.measure} in {schedule.patience} epochs"
                break
            started = time.perf_counter()
            loss = _epoch(task, schedule, optimizer, epoch, bar)
            task.network.eval()
            record = {"epoch": float(epoch), "loss": loss, **task.validate()}
            record["seconds"] = time.perf_counter() - started
            history.append(record)
            if _stale(history, task.measure) == 0:
                best = {name: tensor.detach().cpu().clone() for name, tensor in task.network.state_dict().items()}
            _write_run(path, task, optimizer, best, history, about)
            _write_log(folder / f"{task.name}.csv", history)
            if board is not None:
                for key in record.keys() - {"epoch"}:
                    board.add_scalar(key, record[key], epoch)
            bar.set_postfix({key: f"{record[key]:.4f}" for key in ("loss", task.measure)})
    task.network.load_state_dict(best)
    task.network.eval()
    chosen = history[_best(history, task.measure)]
    return Fit({k: v for k, v in chosen.items() if k not in ("epoch", "seconds", "loss")}, history, stopped)


def ahead(items: Iterator[T]) -> Iterator[T]:
    """The same items in the same order, each made in the background while the one before is in use."""
    with ThreadPoolExecutor(1) as background:
        waiting: Future[T | None] = background.submit(next, items, None)
        while (item := waiting.result()) is not None:
            waiting = background.submit(next, items, None)
            yield item


def _epoch(task: Task, schedule: Schedule, optimizer: torch.optim.Optimizer, epoch: int, bar: tqdm) -> float:
    """One pass, shown on the bar; the mean loss."""
    sequence = np.random.SeedSequence([schedule.seed, epoch])
    torch.manual_seed(int(sequence.generate_state(1)[0]))
    task.network.train()
    total, count, done = 0.0, 0, 0.0
    for share, batch in task.batches(np.random.default_rng(sequence)):
        for group in optimizer.param_groups:
            group["lr"] = schedule.rate_at((epoch + done) / schedule.epochs)
        loss = task.loss(batch)
        optimizer.zero_grad(set_to_none=True)
        loss.backward()
        nn.utils.clip_grad_norm_(task.network.parameters(), 5.0)
        optimizer.step()
        bar.update(share - done)
        done = share
        total, count = total + float(loss.detach()) * len(batch[0]), count + len(batch[0])
    if not count:
        raise ConfigError(f"{task.name}: no training sample; the dataset's training split is empty")
    if not math.isfinite(total):
        raise ConfigError(f"{task.name}: the loss is not finite any more in epoch {epoch}; train with a smaller rate")
    return total / count


def _board(folder: Path, epoch: int) -> AbstractContextManager[Any]:
    """TensorBoard's log, from an epoch on, or None where TensorBoard is not installed."""
    if importlib.util.find_spec("tensorboard") is None:
        return nullcontext()
    from torch.utils.tensorboard import SummaryWriter

    return closing(SummaryWriter(str(folder), purge_step=epoch))  # type: ignore[no-untyped-call]


def _best(history: list[dict[str, float]], measure: str) -> int:
    values = [record[measure] for record in history]
    return max(range(len(values)), key=lambda index: -math.inf if math.isnan(values[index]) else values[index])


def _stale(history: list[dict[str, float]], measure: str) -> int:
    """Epochs since the best one."""
    return len(history) - 1 - _best(history, measure) if history else 0


def _write_run(
    path: Path,
    task: Task,
    optimizer: torch.optim.Optimizer,
    best: dict[str, Tensor],
    history: list[dict[str, float]],
    about: str,
) -> None:
    run = {
        "about": about,
        "state": task.network.state_dict(),
        "best": best,
        "optimizer": optimizer.state_dict(),
        "history": msgspec.json.encode(history).decode(),
    }
    part = path.with_name(path.name + ".part")
    torch.save(run, part)
    os.replace(part, path)


def read_run(path: Path) -> dict[str, Any]:
    """Read a run's file: about, state, best, optimizer, history (JSON).

    Raises:
        ConfigError: missing, damaged or something else.
    """
    try:
        run = torch.load(path, map_location="cpu", weights_only=True)
        missing = {"about", "state", "best", "optimizer", "history"} - set(run)
    except Exception as error:
        raise ConfigError(f"{path}: is no readable training run ({error}); remove it and train again") from error
    if missing:
        raise ConfigError(f"{path}: is no training run, it lacks {', '.join(sorted(missing))}; train again")
    return run


def _write_log(path: Path, history: list[dict[str, float]]) -> None:
    with path.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, list(history[0]))
        writer.writeheader()
        writer.writerows(history)
