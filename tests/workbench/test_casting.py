import numpy as np
import pytest

from grasp_core.errors import GraspError
from workbench.casting import brief, plain, pose, put, sentence, text


def test_values_become_builtins():
    out = plain([np.float32(0.5), np.int64(3), np.bool_(True), "a", (np.float64(1.0),)])
    assert out == (0.5, 3, True, "a", (1.0,))
    assert [type(value) for value in out[:3]] == [float, int, bool]
    assert plain(np.zeros(3)) is not None


@pytest.mark.parametrize("value", [object(), {"a": 1}, float("nan"), float("inf"), np.array([object()]), [object()]])
def test_what_viser_cannot_encode_never_reaches_it(value):
    with pytest.raises(GraspError, match="cannot be shown"):
        plain(value)


def test_equal_values_are_not_sent_again():
    sent = []

    class Handle:
        value = 1.0

        def __setattr__(self, name, value):
            sent.append((name, value))

    put(Handle(), value=1.0)
    put(Handle(), value=np.float32(2.0))
    assert sent == [("value", 2.0)]


def test_foreign_text_cannot_become_html():
    assert text('<img src=x onerror="alert(1)">') == "&lt;img src=x onerror=&quot;alert(1)&quot;&gt;"


def test_poses_are_handed_over_as_quaternion_and_place():
    transform = np.array([[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1.0]])
    turn, place = pose(transform)
    assert np.allclose(turn, [np.sqrt(0.5), 0, 0, np.sqrt(0.5)])
    assert place == (1.0, 2.0, 3.0)


def test_sentences():
    assert sentence("held to the end") == "Held to the end."
    assert sentence("mm.npy: no metres") == "mm.npy: no metres." and sentence("box_003 fell") == "box_003 fell."
    assert sentence("Done!") == "Done!" and sentence("  ") == ""


def test_long_texts_end_at_a_word():
    assert brief("short") == "short"
    told = brief("choose one of: " + "family, " * 100)
    assert len(told) < 245 and told.endswith("family, …")
