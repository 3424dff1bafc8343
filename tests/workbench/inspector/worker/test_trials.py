import msgspec
import pytest

from workbench.inspector.orders import SceneRequest, Thing
from workbench.inspector.setup import DEFAULT
from workbench.inspector.worker import trials
from workbench.inspector.worker.sights import open_scene

SETUP = msgspec.structs.replace(DEFAULT, planner="antipodal", attempts=2)


@pytest.fixture(scope="module")
def opened():
    return open_scene(SceneRequest((Thing("can_000"),), 3), SETUP, {})


def test_a_recorded_attempt_is_the_one_of_the_trial(opened):
    grasp = opened.candidates(0)[0].grasp
    attempts = trials.run_trial(opened.scene, SETUP, grasp)
    assert [attempt.number for attempt in attempts] == [0, 1] and all(a.recording is None for a in attempts)
    recorded = trials.record_attempt(opened.scene, SETUP, grasp, 1)
    assert recorded.recording is not None and recorded.words
    assert (recorded.outcome, recorded.executed) == (attempts[1].outcome, attempts[1].executed)


def test_an_expected_attempt_is_there_at_once(opened, monkeypatch):
    grasp = opened.candidates(0)[0].grasp
    trials.expect_attempt(opened.scene, SETUP, grasp)
    expected = trials.record_attempt(opened.scene, SETUP, grasp, 0)
    assert trials.record_attempt(opened.scene, SETUP, grasp, 0) is expected
    second = opened.candidates(0)[1].grasp
    trials.expect_attempt(opened.scene, SETUP, second)
    assert trials.record_attempt(opened.scene, SETUP, grasp, 0) is expected, "those of one scene are kept"
    noiseless = msgspec.structs.replace(SETUP, sigma_p=0.0, sigma_phi=0.0)
    other = trials.record_attempt(opened.scene, noiseless, grasp, 0)
    assert other is not expected and other.executed == grasp, "another noise is another trial"
    trials.expect_attempt(opened.scene, noiseless, grasp)
    assert trials.record_attempt(opened.scene, SETUP, second, 0) is not trials.record_attempt(
        opened.scene, SETUP, second, 0
    ), "others are let go"
