import numpy as np


def test_table_counts_and_labels(store):
    table = store.grasps(1)
    assert table.number.tolist() == [0, 1, 2, 3]
    assert table.attempts.tolist() == [5] * 4
    assert table.successes.tolist() == [5, 4, 3, 2]
    assert (table.slipped[1], table.missed[2], table.collisions[3]) == (1, 2, 3)
    assert table.quality.tolist() == [1.0, 0.8, 0.6, 0.4]
    assert np.array_equal(table.label, table.quality)
    assert not table.human.any()
    assert np.isnan(table.score).all()


def test_label_left_out_is_nan(store):
    store.add_label(2, "ann", "unsure")
    table = store.grasps(1)
    assert np.isnan(table.label[1]) and table.quality[1] == 0.8
    assert table.used.tolist() == [True, False, True, True]
    assert table.human.tolist() == [False, True, False, False]


def test_empty_table_keeps_its_shapes(store):
    table = store.grasps(99)
    assert len(table) == 0 and table.position.shape == (0, 3)


def test_attempts_come_back_as_given(store, asset, make_record):
    given = make_record(asset).attempts[1]
    assert store.attempts(2) == list(given)


def test_digest_ignores_what_people_add(store):
    before = store.scene_digest(1)
    store.add_label(1, "ann", 0.0)
    assert store.scene_digest(1) == before


def test_digest_sees_every_number(store):
    before = store.scene_digest(1)
    with store.transaction() as db:
        db.execute("UPDATE attempts SET z = z + 1e-12 WHERE grasp = 3 AND number = 4")
    assert store.scene_digest(1) != before
