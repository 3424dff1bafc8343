import numpy as np
import pytest

from grasp_core.scene import place
from workbench.inspector.poses import matrix, slid, vector


def test_poses_survive_the_way_to_seven_numbers_and_back():
    rng = np.random.default_rng(0)
    for _ in range(50):
        turn = rng.normal(size=4)
        pose = matrix((*rng.uniform(-0.2, 0.2, 3), *(turn / np.linalg.norm(turn))))
        assert matrix(vector(pose)) == pytest.approx(pose, abs=5e-5)


def test_sliding_is_told_from_lifting_and_tipping():
    rest = np.eye(4)
    rest[2, 3] = 0.03
    assert slid(rest, place(rest, 0.1, -0.05, 2.0))
    lifted = rest.copy()
    lifted[2, 3] += 0.01
    assert not slid(rest, lifted)
    assert not slid(rest, matrix((0, 0, 0.03, np.cos(0.1), np.sin(0.1), 0, 0)))
