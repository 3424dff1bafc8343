import pytest

from grasp_core.dataset.stats import compute_stats, draw_stats
from grasp_core.errors import GraspError


def test_figures(store):
    stats = compute_stats(store)
    assert stats.scenes == {"train": 1, "validation": 0, "test": 0} == stats.graspable_scenes
    assert (stats.grasps, stats.attempts) == (4, 20)
    assert stats.outcomes == {"SUCCESS": 14 / 20, "COLLISION": 3 / 20, "MISSED": 2 / 20, "SLIPPED": 1 / 20}
    assert stats.quality == [0, 0, 0, 0, 1, 0, 1, 0, 1, 0, 1]
    assert list(stats.good_grasps.values()) == [0.25]
    assert stats.graspable == {"box": 1.0}
    assert stats.dynamic_share == 0.6
    assert stats.comfort_mm == [1.0] * 5


def test_picture(store, tmp_path):
    pytest.importorskip("matplotlib", reason="needs the extra 'report'")
    import cv2

    file = tmp_path / "stats.png"
    draw_stats(store, compute_stats(store), file)
    picture = cv2.imread(str(file))
    assert picture.shape[0] > 500 and picture.std() > 5


def test_a_picture_that_cannot_be_written_is_named(store, tmp_path):
    pytest.importorskip("matplotlib", reason="needs the extra 'report'")
    with pytest.raises(GraspError, match=r"a\.png: cannot be written"):
        draw_stats(store, compute_stats(store), tmp_path / "no" / "a.png")


def test_empty_dataset_says_so(tmp_path, make_store):
    with make_store(tmp_path / "e") as empty, pytest.raises(GraspError, match="no scene yet"):
        compute_stats(empty)
