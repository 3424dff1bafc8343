from grasp_core.dataset.queries import Query
from grasp_core.evaluation.made_dataset import GRASPS, WEIGHTS, Made, make_dataset


def test_rows_are_consistent_and_the_same_each_time(tmp_path):
    digests = []
    for name in "ab":
        calls = []
        made = Made(samples=GRASPS + 1, decisions=40, seed=3)
        with make_dataset(tmp_path / name, made, progress=lambda *c: calls.append(c)) as store:  # noqa: B023
            assert calls == [(1, 2), (2, 2)]
            assert store.count(Query()) == 2 * GRASPS
            assert store.differing_labels() == []
            assert len(store.events()) == 40
            assert store.meta.weights == WEIGHTS
            assert store.rows("PRAGMA foreign_key_check") == []
            found = store.rows("SELECT grasp, label, score, state, flagged FROM samples ORDER BY grasp")
            digests.append([tuple(row) for row in found])
    assert digests[0] == digests[1]
    assert len({row[3] for row in digests[0]}) == 3
