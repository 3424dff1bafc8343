from dataclasses import dataclass, replace

import numpy as np
import pytest

from grasp_core.simulation.recording import Recording
from workbench.playback import Replay


@dataclass(frozen=True)
class Two(Replay):
    """A replay of two seconds."""

    name: str
    length: int = 21

    @property
    def recording(self):
        count = self.length
        return Recording(
            ("object_0",), np.linspace(0, 2, count), np.zeros(count, np.int8), np.zeros((count, 1, 7), np.float32),
            np.zeros((count, 2), np.float32), np.zeros(0, np.int32), np.zeros((0, 3), np.float32),
            np.zeros((0, 3), np.float32), np.zeros(0, np.int8), np.zeros(0, np.int16), "SUCCESS", "held",
        )  # fmt: skip


def test_time_passes_between_ticks_only():
    first = Two("x").ticked(10.0)
    assert first.position == 0 and first.at == 10.0
    assert first.ticked(10.5, speed=2.0).position == pytest.approx(1.0)
    assert first.ticked(9.0).position == 0  # a clock that runs backwards moves nothing
    assert replace(first, playing=False).ticked(11.0).position == 0


def test_the_end_pauses_or_starts_over():
    late = replace(Two("x"), position=1.9, at=10.0)
    ended = late.ticked(10.5)
    assert (ended.position, ended.playing, ended.at, ended.name) == (2.0, False, None, "x")
    assert late.ticked(10.5, loop=True).position == 0 and late.ticked(10.5, loop=True).playing
    assert ended.toggled().playing and ended.toggled().position == 0


def test_pausing_and_seeking():
    halfway = replace(Two("x"), position=1.0, at=3.0).toggled()
    assert (halfway.playing, halfway.position, halfway.at) == (False, 1.0, None)
    assert halfway.toggled().position == 1.0
    assert [Two("x").sought(time).position for time in (-1.0, 0.7, 9.0)] == [0.0, 0.7, 2.0]
    assert not Two("x").sought(0.7).playing


def test_nothing_recorded_lasts_no_time():
    assert Two("x", 0).duration == 0 and not Two("x", 0).ticked(1.0).playing
    with pytest.raises(NotImplementedError):
        Replay().recording  # noqa: B018 (a property)
