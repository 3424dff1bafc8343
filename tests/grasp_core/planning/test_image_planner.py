import numpy as np
import pytest

from grasp_core.errors import GraspError, ImageError, MismatchError
from grasp_core.gripper import load_gripper
from grasp_core.planning.candidates import Batch, make_batch
from grasp_core.planning.image_planner import Found, ImagePlanner, NetworkPlanner, NetworkSettings, SearchSettings
from grasp_core.planning.stages import Stages

GRIPPER = load_gripper()


class Middle(ImagePlanner[SearchSettings]):
    """Proposes grasps of given scores at the middle of what can be grasped, a good centimetre apart in order."""

    settings_type = SearchSettings
    scores: tuple[float, ...] = ()
    heat: np.ndarray | None = None

    def search(self, view, stages, rng) -> Found:
        v, u = (int(axis.mean()) for axis in np.nonzero(view.places))
        count = len(self.scores)
        batch = make_batch(view, np.full(count, u), v + 10.0 * np.arange(count), np.zeros(count))
        heat = None if self.heat is None else np.zeros(view.places.shape, np.float32)
        if heat is not None:
            heat[v + 10 * np.arange(count), u] = self.heat
        return Found(batch, np.array(self.scores), "nothing was proposed", np.column_stack([batch.u, batch.v]), heat)


def planner(*scores: float, heat=None, **settings) -> Middle:
    made = Middle(GRIPPER, SearchSettings(**settings))
    made.scores, made.heat = scores, heat
    return made


@pytest.fixture
def image(photo, make_box):
    return photo(make_box(0, 0, (0.05, 0.14, 0.05), 0.0))


def test_proposals_become_sorted_candidates_above_t(image, rng):
    plan = planner(0.2, 0.9, 0.6, threshold=0.5)(image, rng=rng)
    assert [c.score for c in plan.scored] == [0.9, 0.6, 0.2] and [c.score for c in plan.candidates] == [0.9, 0.6]
    assert plan.reason is None and plan.sampled.shape == (3, 2)
    assert [c.score for c in planner(0.2, 0.9, 0.6, candidates=1)(image, rng=rng).candidates] == [0.9]


def test_candidates_keep_their_least_distance(image, rng):
    plan = planner(0.9, 0.8, 0.7, least_distance=0.015)(image, rng=rng)
    assert [c.score for c in plan.candidates] == [0.9, 0.7] and len(plan.scored) == 3


def test_of_equal_scores_the_hotter_one_is_better(image, rng):
    plan = planner(0.5, 0.5, 0.5, heat=np.array([0.1, 0.3, 0.2], np.float32))(image, rng=rng)
    assert [c.heat for c in plan.scored] == pytest.approx([0.3, 0.2, 0.1])


def test_empty_plans_say_why(image, photo, rng):
    assert planner()(image, rng=rng).reason == "nothing was proposed"
    assert planner(0.2, threshold=0.5)(image, rng=rng).reason.startswith("all 1 scored grasps are below t = 0.5")
    assert planner(0.9)(photo(), rng=rng).reason.startswith("no object above the table")


@pytest.mark.parametrize("wrong", [{"threshold": 1.5}, {"candidates": 0}])
def test_impossible_settings_are_refused(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        SearchSettings(**wrong)


class Judge(NetworkPlanner[NetworkSettings]):
    settings_type = NetworkSettings

    def search(self, view, stages, rng) -> Found:
        raise NotImplementedError


def test_judging_ends_before_the_chunk_that_would_overrun_the_budget(image, make_runtime, clock, rng):
    from grasp_core.planning.view import ViewSettings, look

    _, view = look(image, None, ViewSettings())
    batch = make_batch(view, np.full(40, 150.0), np.full(40, 150.0), np.linspace(0, 1, 40))
    runtime = make_runtime(delay=0.05, clock=clock)
    judge = Judge(runtime, GRIPPER)
    assert len(judge.judge(batch, view, Stages(), 16)) == 40 and runtime.scored == [16, 16, 8]
    assert len(judge.judge(batch, view, Stages(110), 16)) == 32
    assert len(judge.judge(batch[:0], view, Stages(), 16)) == 0
    assert judge.weights == "fake 0123" and isinstance(batch, Batch)


def test_scores_are_those_of_the_network_times_the_share_of_free_poses_around(photo, make_box, make_runtime):
    from grasp_core.planning.candidates import PoseNoise, reach_share
    from grasp_core.planning.view import ViewSettings, look

    _, view = look(photo(make_box(0.0, 0.0, (0.14, 0.088, 0.05), 0.0)), None, ViewSettings())
    v, u = np.argwhere(view.depth < 0.66).mean(axis=0)
    batch = make_batch(view, [u], [v], [np.pi / 2])
    share = reach_share(batch, view, GRIPPER, PoseNoise())
    assert 0 < share[0] < 1
    raw = Judge(make_runtime(), GRIPPER, NetworkSettings(threshold=0.0, pose_noise=PoseNoise(draws=0)))
    both = Judge(make_runtime(), GRIPPER, NetworkSettings(threshold=0.0))
    above = Judge(make_runtime(), GRIPPER, NetworkSettings(threshold=1.0))
    plain = raw.judge(batch, view, Stages(), 16)
    assert plain[0] > 0 and both.judge(batch, view, Stages(), 16) == pytest.approx(plain * share)
    assert above.judge(batch, view, Stages(), 16) == pytest.approx(plain), "what is below t is not looked at further"


def test_weights_of_another_gripper_are_refused(make_runtime):
    import msgspec

    with pytest.raises(MismatchError, match="gripper"):
        Judge(make_runtime(msgspec.structs.replace(GRIPPER, force=5.0)), GRIPPER)


def test_arrays_and_impossible_budgets_are_refused(image, rng):
    plan = planner(0.9)
    with pytest.raises(ImageError, match=r"DepthImage, not ndarray.*read_depth.*from_array"):
        plan(image.depth, rng=rng)
    for budget in (0, -5.0, float("nan")):
        with pytest.raises(GraspError, match="above 0 ms"):
            plan(image, budget_ms=budget, rng=rng)
