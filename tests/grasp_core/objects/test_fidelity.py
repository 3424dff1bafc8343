import numpy as np
import pytest
import trimesh

from grasp_core.objects.fidelity import fidelity, signed_distance
from grasp_core.objects.hulls import convex_part


def test_exact_parts_stand_nowhere_off():
    box = trimesh.creation.box((0.1, 0.05, 0.02))
    found = fidelity(box, [convex_part(box.vertices)])
    assert found.error < 1e-4 and found.missing < 1e-9 and found.filled == 0


def test_filled_bowl_is_told_from_a_faithful_one():
    pot = trimesh.creation.annulus(0.04, 0.05, 0.06, sections=24)
    found = fidelity(pot, [convex_part(pot.vertices, 64)])
    assert found.filled > 0.1 and found.error > 0.003
    assert found.words == {"parts_off_mm": f"{1000 * found.error:.2f}", "parts_filled": f"{found.filled:.3f}"}


def test_a_missing_half_is_missing():
    box = trimesh.creation.box((0.1, 0.02, 0.02))
    half = box.vertices.copy()
    half[:, 0] = np.minimum(half[:, 0], 0)
    found = fidelity(box, [convex_part(half)])
    assert found.missing == pytest.approx(0.5 * 0.025, rel=0.15) and found.filled == 0


def test_signed_distance_to_a_union_is_the_nearest_parts():
    box = trimesh.creation.box((2, 2, 2))
    parts = [convex_part(box.vertices), convex_part(box.vertices + np.array([3.0, 0, 0]))]
    assert np.allclose(
        signed_distance(np.array([[0, 0, 0], [1.25, 0, 0], [5, 0, 0], [1.75, 0, 0]]), parts), [-1, 0.25, 1, 0.25]
    )
