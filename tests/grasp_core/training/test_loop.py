import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import torch

from grasp_core.errors import ConfigError
from grasp_core.training.loop import Batch, Schedule, ahead, fit, half_precision, pick_device, read_run


class Line:
    """y = 2x learned by one weight; the measure is minus the error."""

    name = "line"
    measure = "score"

    def __init__(self, frozen: bool = False) -> None:
        torch.manual_seed(0)
        self.network = torch.nn.Linear(1, 1, bias=False)
        self.frozen = frozen
        self.stop_at: int | None = None
        self.epochs = 0

    def batches(self, rng: np.random.Generator) -> Iterator[tuple[float, Batch]]:
        if self.epochs == self.stop_at:
            raise KeyboardInterrupt
        self.epochs += 1
        for step in range(4):
            x = torch.from_numpy(rng.normal(size=(8, 1)).astype(np.float32))
            yield (step + 1) / 4, (x, 2 * x)

    def loss(self, batch: Batch) -> torch.Tensor:
        x, y = batch
        loss = ((self.network(x) - y) ** 2).mean()
        return loss * 0 if self.frozen else loss

    def validate(self) -> dict[str, float]:
        return {"score": -abs(float(self.network.weight.detach()) - 2)}


SCHEDULE = Schedule(epochs=12, batch=8, rate=0.1, patience=4, weight_decay=0.0)


def test_learns_logs_and_keeps_the_best(tmp_path: Path) -> None:
    task = Line()
    result = fit(task, SCHEDULE, tmp_path, about="a", progress=False)
    assert result.history[-1]["loss"] < 0.1 * result.history[0]["loss"]
    assert result.metrics["score"] == max(record["score"] for record in result.history)
    assert -abs(float(task.network.weight.detach()) - 2) == pytest.approx(result.metrics["score"])
    lines = (tmp_path / "line.csv").read_text().splitlines()
    assert lines[0] == "epoch,loss,score,seconds"
    assert len(lines) == len(result.history) + 1


def test_tensorboard_shows_every_epoch_once(tmp_path: Path) -> None:
    accumulator = pytest.importorskip("tensorboard.backend.event_processing.event_accumulator")
    broken = Line()
    broken.stop_at = 5
    with pytest.raises(KeyboardInterrupt):
        fit(broken, SCHEDULE, tmp_path, about="a", progress=False)
    time.sleep(1.1)  # files are read in the order of their names: the second, then a counter, of which 10 is before 9
    result = fit(Line(), SCHEDULE, tmp_path, about="a", progress=False)
    log = accumulator.EventAccumulator(str(tmp_path / "tensorboard" / "line"))
    log.Reload()
    assert set(log.Tags()["scalars"]) == {"loss", "score", "seconds"}
    shown = [(event.step, event.value) for event in log.Scalars("score")]
    assert shown == [(k, pytest.approx(record["score"])) for k, record in enumerate(result.history)]


def test_an_interrupted_run_ends_like_an_uninterrupted_one(tmp_path: Path) -> None:
    whole, broken, resumed = Line(), Line(), Line()
    fit(whole, SCHEDULE, tmp_path / "whole", about="a", progress=False)
    broken.stop_at = 5
    with pytest.raises(KeyboardInterrupt):
        fit(broken, SCHEDULE, tmp_path / "broken", about="a", progress=False)
    result = fit(resumed, SCHEDULE, tmp_path / "broken", about="a", progress=False)
    assert resumed.epochs == len(result.history) - 5
    assert torch.equal(resumed.network.weight, whole.network.weight)


def test_finished_run_is_not_trained_again(tmp_path: Path) -> None:
    first, second = Line(), Line()
    a = fit(first, SCHEDULE, tmp_path, about="a", progress=False)
    b = fit(second, SCHEDULE, tmp_path, about="a", progress=False)
    assert second.epochs == 0
    assert a.metrics == b.metrics
    assert torch.equal(first.network.weight, second.network.weight)


def test_other_settings_or_data_are_refused(tmp_path: Path) -> None:
    fit(Line(), SCHEDULE, tmp_path, about="a", progress=False)
    with pytest.raises(ConfigError, match="other settings or data"):
        fit(Line(), SCHEDULE, tmp_path, about="b", progress=False)


def test_damaged_run_is_named(tmp_path: Path) -> None:
    (tmp_path / "line.pt").write_bytes(b"no run")
    with pytest.raises(ConfigError, match=r"line\.pt"):
        read_run(tmp_path / "line.pt")


def test_stops_early_without_progress(tmp_path: Path) -> None:
    result = fit(Line(frozen=True), SCHEDULE, tmp_path, about="a", progress=False)
    assert len(result.history) == SCHEDULE.patience + 1
    assert "no better score" in result.stopped


def test_rate_rises_and_falls() -> None:
    rates = [SCHEDULE.rate_at(x) for x in np.linspace(0, 1, 101)]
    top = int(np.argmax(rates))
    assert rates[top] == pytest.approx(SCHEDULE.rate)
    assert top == pytest.approx(100 * SCHEDULE.warmup, abs=1)
    assert rates[0] < 0.1 * SCHEDULE.rate
    assert rates[-1] < 0.02 * SCHEDULE.rate
    assert np.all(np.diff(rates[top:]) < 0)


def test_diverged_and_empty_training_say_so(tmp_path: Path) -> None:
    class Empty(Line):
        def batches(self, rng: np.random.Generator) -> Iterator[tuple[float, Batch]]:
            return iter(())

    class Infinite(Line):
        def loss(self, batch: Batch) -> torch.Tensor:
            return super().loss(batch) * float("inf")

    with pytest.raises(ConfigError, match="no training sample"):
        fit(Empty(), SCHEDULE, tmp_path / "a", about="a", progress=False)
    with pytest.raises(ConfigError, match="smaller rate"):
        fit(Infinite(), SCHEDULE, tmp_path / "b", about="a", progress=False)


@pytest.mark.parametrize(("there", "kind"), [(True, "cuda"), (False, "cpu")])
def test_cuda_is_taken_where_it_is(monkeypatch: pytest.MonkeyPatch, there: bool, kind: str) -> None:
    monkeypatch.setattr(torch.cuda, "is_available", lambda: there)
    assert pick_device().type == kind


@pytest.mark.parametrize("native", [True, False])
def test_half_precision_is_used_where_it_is_native(monkeypatch: pytest.MonkeyPatch, native: bool) -> None:
    monkeypatch.setattr(torch.cuda, "is_bf16_supported", lambda: native)
    monkeypatch.setattr(torch.cpu, "get_capabilities", lambda: {"avx512_bf16": native})
    assert half_precision(torch.device("cuda")) is native
    assert half_precision(torch.device("cpu")) is native


def test_schedule_refuses_nonsense() -> None:
    with pytest.raises(ValueError, match="at least 1"):
        Schedule(epochs=0, batch=1, rate=1.0)
    with pytest.raises(ValueError, match="rate"):
        Schedule(epochs=1, batch=1, rate=0.0)


def test_working_ahead_keeps_items_order_and_errors() -> None:
    assert list(ahead(iter([3, 1, 2]))) == [3, 1, 2]
    assert list(ahead(iter(()))) == []

    def failing() -> Iterator[int]:
        yield 1
        raise ValueError("no more")

    items = ahead(failing())
    assert next(items) == 1
    with pytest.raises(ValueError, match="no more"):
        next(items)
