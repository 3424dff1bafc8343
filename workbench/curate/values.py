"""What the desk and the worker tell the curation: plain values, ready to be shown."""

from __future__ import annotations

from dataclasses import dataclass

from grasp_core.camera import DepthImage
from grasp_core.dataset.agreement import Accuracy, Agreement
from grasp_core.dataset.labels import CurrentLabel, LabelEvent
from grasp_core.dataset.lists import Key
from grasp_core.dataset.queries import Query
from grasp_core.dataset.review import Review
from grasp_core.dataset.rows import AttemptRow, GraspRow
from grasp_core.dataset.trials import Pooled
from grasp_core.scene import Scene
from grasp_core.simulation.recording import Recording


@dataclass(frozen=True)
class Thumb:
    """A sample in the list.

    Attributes:
        row: of the dataset.
        object: name of its object.
        picture: depth around the grasp with its rectangle, as a data URL.
    """

    row: GraspRow
    object: str
    picture: str


@dataclass(frozen=True)
class Shelf:
    """One page of a list.

    Attributes:
        thumbs: the samples.
        after: key of the next page, None when this is the last.
        total: samples of the list, None where they are too many to be counted at once.
    """

    thumbs: tuple[Thumb, ...]
    after: Key | None
    total: int | None


@dataclass(frozen=True)
class Sample:
    """One sample with all that is known of it.

    Attributes:
        row: of the dataset.
        scene_name: of its scene.
        object: name of its object.
        category: of the object.
        split: of the object.
        scene: placed objects and camera.
        image: what the camera saw.
        attempts: in order.
        history: label events, oldest first.
        label: what training uses now, and why.
        pooled: quality with its interval.
        crop: what the Refined Network sees, as a data URL.
    """

    row: GraspRow
    scene_name: str
    object: str
    category: str
    split: str
    scene: Scene
    image: DepthImage
    attempts: tuple[AttemptRow, ...]
    history: tuple[LabelEvent, ...]
    label: CurrentLabel
    pooled: Pooled
    crop: str

    @property
    def seen(self) -> int:
        """Id of the newest label event that whoever sees this sample knows of."""
        return max((event.id for event in self.history), default=0)


@dataclass(frozen=True)
class Facts:
    """What there is in the dataset, for choices.

    Attributes:
        name: of the dataset.
        samples: how many.
        categories: of objects.
        people: who labelled.
        views: saved lists, name → query.
        weights: name of the weights whose scores are shown; "" without scores.
        agreements: of pairs of people.
        accuracies: of people on hidden samples.
        reviews: of the person who asked, newest first.
    """

    name: str
    samples: int
    categories: tuple[str, ...]
    people: tuple[str, ...]
    views: dict[str, Query]
    weights: str
    agreements: tuple[Agreement, ...]
    accuracies: tuple[Accuracy, ...]
    reviews: tuple[Review, ...]


@dataclass(frozen=True)
class Decision:
    """A decision on its way into the dataset; JSON-able, so that a browser can keep it.

    Attributes:
        grasp: id of the sample.
        decision: a value in [0, 1], or a word that `DatasetStore.add_label` knows.
        note: free text.
        seen: id of the newest label event that the person saw.
        review: id of the review that it answers, None outside of one.
        place: of the answered sample in the review.
    """

    grasp: int
    decision: float | str
    note: str = ""
    seen: int = 0
    review: int | None = None
    place: int = 0


@dataclass(frozen=True)
class Played:
    """A stored attempt executed again.

    Attributes:
        number: of the attempt.
        same: it ends as stored.
        outcome: how it ends now.
        words: for people.
        recording: of everything that moved.
    """

    number: int
    same: bool
    outcome: str
    words: str
    recording: Recording
