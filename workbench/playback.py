"""Where a replay stands: time that runs, pauses, is sought and ends."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

from grasp_core.simulation.recording import Recording


@dataclass(frozen=True, kw_only=True)
class Replay:
    """A recording that is played; what is shown besides belongs to those who derive from it.

    Attributes:
        position: seconds into it.
        playing: whether time moves it.
        at: clock of the last tick while playing, seconds.
    """

    position: float = 0.0
    playing: bool = True
    at: float | None = None

    @property
    def recording(self) -> Recording | None:
        """What is played."""
        raise NotImplementedError

    @property
    def duration(self) -> float:
        """Seconds of the recording."""
        recording = self.recording
        if recording is None or len(recording.times) == 0:
            return 0.0
        return float(recording.times[-1] - recording.times[0])

    def toggled(self) -> Self:
        """Paused, or going on; from the start where it had ended."""
        ended = self.position >= self.duration - 1e-9
        position = 0.0 if ended and not self.playing else self.position
        return replace(self, playing=not self.playing, position=position, at=None)

    def sought(self, time: float) -> Self:
        """Paused at a time, seconds, as far as there is something to see."""
        return replace(self, position=min(max(time, 0.0), self.duration), playing=False, at=None)

    def ticked(self, now: float, *, speed: float = 1.0, loop: bool = False) -> Self:
        """After a tick of the clock.

        Args:
            now: the clock, seconds.
            speed: of the replay, times real time.
            loop: it starts over at its end.
        """
        if not self.playing:
            return self
        position = self.position + speed * (0.0 if self.at is None else max(0.0, now - self.at))
        if position < self.duration:
            return replace(self, position=position, at=now)
        if loop:
            return replace(self, position=0.0, at=now)
        return replace(self, position=self.duration, playing=False, at=None)
