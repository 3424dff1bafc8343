import numpy as np
import pytest

from grasp_core.camera import DepthImage, canonical_camera, look_down
from grasp_core.dataset.predictions import canonical, score_dataset, unscored_scenes
from grasp_core.dataset.queries import Query
from grasp_core.errors import Cancelled, MismatchError
from grasp_core.grasp import Grasp
from grasp_core.networks.weights import CropSpec, Weights


class FakeRuntime:
    """Scores a crop by its mean and a pixel by its height, so that what goes in can be told from what comes out."""

    def __init__(self, store, digest="d1", name="w1", gripper_digest=None):
        gripper = store.gripper()
        self.meta = Weights(
            name=name, gripper=gripper.name, gripper_digest=gripper_digest or gripper.digest, crop=CropSpec()
        )
        self.digest = digest
        self.backend = "fake"

    def quality_map(self, x):
        return x * 2

    def scores(self, crops):
        return (0.5 + 0.1 * crops.mean(axis=(1, 2))).clip(0, 1)


@pytest.fixture
def scenes(store, make_box, make_record, at_rest):
    for index in (1, 2):
        asset = make_box(f"box_{index:03d}", (0.05 + 0.01 * index, 0.04, 0.05))
        store.add_object(asset, "train", [at_rest(asset)])
        store.add_scene(make_record(asset, f"{asset.name}-0", grasps=3, seed=index))
    return store


def test_scores_are_kept_per_weights_and_shown(scenes):
    calls = []
    done = score_dataset(scenes, FakeRuntime(scenes), progress=lambda *c: calls.append(c))
    assert (done.scenes, done.before) == (3, 0) and calls == [(1, 3), (2, 3), (3, 3)]
    assert scenes.meta.weights == "d1"
    rows = scenes.page(Query(sort="score")).rows
    assert len(rows) == 10 and len({row.score for row in rows}) > 1
    assert rows[0].heat == pytest.approx(1.0)  # the box is 5 cm high: 0.5 network units, doubled by the fake
    again = score_dataset(scenes, FakeRuntime(scenes))
    assert (again.scenes, again.before) == (0, 3)
    score_dataset(scenes, FakeRuntime(scenes, "d2", "w2"))
    assert scenes.meta.weights == "d2"
    assert scenes.row("SELECT count(*) FROM predictions")[0] == 20


def test_a_cancelled_run_goes_on_where_it_stopped(scenes):
    asked = iter([False, True])
    with pytest.raises(Cancelled):
        score_dataset(scenes, FakeRuntime(scenes), cancelled=lambda: next(asked))
    assert unscored_scenes(scenes, "d1") == [2, 3]
    assert scenes.meta.weights is None
    assert score_dataset(scenes, FakeRuntime(scenes)).scenes == 2


def test_new_grasps_are_scored_later(scenes):
    score_dataset(scenes, FakeRuntime(scenes))
    new = scenes.add_grasp(2, Grasp((0.0, 0.0, 0.03), 0.4, 0.1), person="ann")
    assert unscored_scenes(scenes, "d1") == [2]
    score_dataset(scenes, FakeRuntime(scenes))
    assert scenes.grasp(new).score is not None


def test_weights_for_another_gripper_are_refused(scenes):
    with pytest.raises(MismatchError, match="gripper"):
        score_dataset(scenes, FakeRuntime(scenes, gripper_digest="other"))
    assert scenes.row("SELECT count(*) FROM predictions")[0] == 0


def test_other_cameras_are_brought_to_the_canonical_view():
    camera = canonical_camera()
    depth = np.full((300, 300), 0.7, np.float32)
    image = DepthImage.from_array(depth, camera)
    assert canonical(image) is image
    higher = DepthImage.from_array(depth + 0.2, camera.at(look_down(0.9)))
    assert float(np.median(canonical(higher).depth)) == pytest.approx(0.7, abs=1e-3)
