import pytest

from grasp_core.dataset.store import DatasetStore
from grasp_core.dataset.trials import fresh_seeds, pooled_quality, replay, scene_trial, verify_grasp
from grasp_core.errors import Cancelled, MismatchError, StoreError
from grasp_core.grasp import Grasp
from grasp_core.gripper import load_gripper
from grasp_core.rates import wilson
from grasp_core.simulation.physics import load_physics


@pytest.fixture
def real(tmp_path, make_box, make_record, at_rest):
    """One box with a grasp that succeeds; physics as shipped."""
    physics = load_physics()
    asset = make_box()
    with DatasetStore.create(tmp_path / "d", name="t", gripper=load_gripper(), physics=physics, recipe=physics) as s:
        s.add_object(asset, "train", [at_rest(asset)])
        s.add_scene(make_record(asset, grasps=0))
        s.add_grasp(1, Grasp((0.0, 0.0, 0.02), 0.3, 0.1), person="ann")  # the box is turned by 0.3 rad
        yield s


def test_more_attempts_are_pooled_with_their_interval(real):
    calls = []
    event, pooled = verify_grasp(real, 1, 3, person="ann", progress=lambda *c: calls.append(c))
    assert calls == [(1, 3), (2, 3), (3, 3)]
    assert (event.kind, event.source, event.person) == ("attempts", "dart", "ann")
    assert event.details["physics"] == real.meta.physics_digest and len(set(event.details["seeds"])) == 3
    assert (pooled.successes, pooled.attempts) == (real.grasp(1).successes, 3)
    assert (pooled.low, pooled.high) == wilson(pooled.successes, 3)
    assert pooled.quality == real.grasp(1).label == 1.0
    _, more = verify_grasp(real, 1, 2, trial=scene_trial(real, 1))
    assert more.attempts == 5 and more.low > pooled.low
    assert len({attempt.seed for attempt in real.attempts(1)}) == 5


def test_fresh_seeds_avoid_those_used(real):
    first = fresh_seeds(real, 1, 3)
    assert fresh_seeds(real, 1, 3) == first
    verify_grasp(real, 1, 2)
    assert fresh_seeds(real, 1, 2)[0] == first[2]


def test_a_replay_repeats_the_stored_attempt_and_records_it(real):
    verify_grasp(real, 1, 1)
    found = replay(real, 1, 0)
    assert found.same and found.attempt.recording is not None
    assert found.attempt.seed == found.stored.seed and found.words == found.attempt.evidence.words


def test_a_replay_that_ends_otherwise_says_so(real):
    verify_grasp(real, 1, 1)
    with real.transaction() as db:
        db.execute("UPDATE attempts SET outcome = 'SLIPPED'")
    found = replay(real, 1, 0)
    assert not found.same and "ends as SUCCESS now, but SLIPPED is stored" in found.words


def test_refusals(real):
    with pytest.raises(StoreError, match="at least one attempt"):
        verify_grasp(real, 1, 0)
    with pytest.raises(StoreError, match="no grasp"):
        verify_grasp(real, 9)
    with pytest.raises(StoreError, match="there is no 0"):
        replay(real, 1, 0)
    asked = iter([False, True])
    with pytest.raises(Cancelled):
        verify_grasp(real, 1, 2, cancelled=lambda: next(asked))
    assert real.attempts(1) == [] and pooled_quality(real, 1).quality is None


def test_physics_that_cannot_be_reproduced_is_refused(real):
    with real.transaction() as db:
        db.execute("UPDATE meta SET value = '\"other\"' WHERE key = 'physics_digest'")
    with pytest.raises(MismatchError, match="does not reproduce"):
        scene_trial(real, 1)
