"""Recording: everything that moved during one attempt, to be replayed and kept."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray

from grasp_core.errors import GraspError

PHASES = ("approach", "close", "lift", "shake")


@dataclass(frozen=True)
class Recording:
    """One attempt over time.

    Attributes:
        names: B bodies: object_0 …, base, rod, left_finger, right_finger.
        times: (T,) float64, s from the start of the approach.
        phases: (T,) int8, index into `PHASES`.
        poses: (T, B, 7) float32: x y z qw qx qy qz, world_from_body. An object's frame is its asset's; those of the
            gripper's bodies lie at the centres of their boxes.
        fingers: (T, 2) float32, each finger's travel from fully open, metres.
        contact_frames: (C,) int32, the frame of each contact between finger and object.
        contact_points: (C, 3) float32, world metres.
        contact_forces: (C, 3) float32, N in the world, on the object.
        contact_fingers: (C,) int8, 0 left, 1 right.
        contact_objects: (C,) int16, index of the object.
        outcome: of the attempt.
        words: the outcome in one sentence.
    """

    names: tuple[str, ...]
    times: NDArray[np.float64]
    phases: NDArray[np.int8]
    poses: NDArray[np.float32]
    fingers: NDArray[np.float32]
    contact_frames: NDArray[np.int32]
    contact_points: NDArray[np.float32]
    contact_forces: NDArray[np.float32]
    contact_fingers: NDArray[np.int8]
    contact_objects: NDArray[np.int16]
    outcome: str
    words: str

    def save(self, path: Path) -> None:
        """Write everything to one compressed `.npz` file."""
        arrays = {name: getattr(self, name) for name in _ARRAYS}
        head = msgspec.json.encode({"names": self.names, "outcome": self.outcome, "words": self.words})
        with path.open("wb") as stream:
            np.savez_compressed(stream, head=np.frombuffer(head, np.uint8), **arrays)

    @classmethod
    def load(cls, path: Path) -> Recording:
        """Read what `save` wrote.

        Raises:
            GraspError: missing or damaged file, or something else.
        """
        try:
            with np.load(path, allow_pickle=False) as data:
                head = msgspec.json.decode(data["head"].tobytes())
                head["names"] = tuple(head["names"])
                return cls(**head, **{name: data[name] for name in _ARRAYS})
        except OSError as error:
            raise GraspError(f"{path}: cannot be read ({error.strerror or error})") from error
        except Exception as error:
            raise GraspError(f"{path}: holds no recording ({error}); record the attempt again") from error


_ARRAYS = (
    "times",
    "phases",
    "poses",
    "fingers",
    "contact_frames",
    "contact_points",
    "contact_forces",
    "contact_fingers",
    "contact_objects",
)
