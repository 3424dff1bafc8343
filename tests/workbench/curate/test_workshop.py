import pytest

from grasp_core.errors import GraspError
from workbench.curate import workshop


@pytest.fixture(autouse=True)
def _fresh():
    workshop._trial.cache_clear()


def test_verifying_pools_and_says_so(folder, store):
    words = workshop.verify(folder, 1, 2, "ann")
    row = store.grasp(1)
    assert f"quality {row.successes}/4" in words and row.attempts == 4
    assert store.history(1)[0].person == "ann"


def test_a_replay_has_everything_that_moved(folder):
    played = workshop.replay(folder, 1, 0)
    assert played.number == 0 and len(played.recording.times) > 2 and "object_0" in played.recording.names
    with pytest.raises(GraspError, match="there is no 7"):
        workshop.replay(folder, 1, 7)


def test_scoring_ends_with_scores_on_show(folder, store):
    assert workshop.score(folder) == (1, 1)
    assert store.row("SELECT count(*) FROM samples WHERE score IS NULL")[0] == 0
    assert workshop.score(folder) == (1, 1)


def test_scoring_hands_over_after_a_moment(folder, monkeypatch):
    from grasp_core.dataset import predictions
    from grasp_core.errors import Cancelled

    def long(store, runtime, *, progress, cancelled):
        for done in range(1, 9):
            progress(done, 8)
            if cancelled():
                raise Cancelled("cancelled")
        raise AssertionError("it was not asked to stop")

    monkeypatch.setattr(predictions, "score_dataset", long)
    monkeypatch.setattr(workshop, "_runtime", lambda: None)
    monkeypatch.setattr(workshop, "SLICE", -1.0)
    assert workshop.score(folder) == (1, 8)
