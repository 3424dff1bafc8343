import numpy as np
import trimesh

from grasp_core.objects.decomposition import build_asset
from grasp_core.objects.parametric import make
from grasp_core.objects.similarity import NEAR, descriptor, distance, distances, near_duplicates


def changed(asset, matrix):
    matrix = np.asarray(matrix, float)
    return build_asset(
        asset.name + "_changed",
        asset.category,
        trimesh.Trimesh(asset.vertices @ matrix.T, asset.faces, process=False),
        parts=[part.vertices @ matrix.T for part in asset.parts],
    )


def test_a_turned_object_is_the_same():
    mug = make("mug", 0)
    turn = trimesh.transformations.euler_matrix(0.4, 1.1, 2.0)[:3, :3]
    assert distance(mug, changed(mug, turn)) < 0.03


def test_a_slightly_larger_object_is_a_near_duplicate_and_a_much_larger_one_is_not():
    mug = make("mug", 0)
    assert 0.02 < distance(mug, changed(mug, np.eye(3) * 1.05)) < NEAR
    assert distance(mug, changed(mug, np.eye(3) * 1.3)) > NEAR


def test_different_things_are_far_apart():
    assert distance(make("mug", 0), make("pen", 0)) > 3 * NEAR
    assert distance(make("donut", 0), make("can", 0)) > NEAR


def test_pairs_are_found_nearest_first():
    mug, pen = make("mug", 0), make("pen", 0)
    near = changed(mug, np.eye(3) * 1.04)
    pairs = near_duplicates([mug, pen], [near, mug])
    assert [pair[:2] for pair in pairs] == [("mug_000", "mug_000"), ("mug_000", "mug_000_changed")]
    assert near_duplicates([], [mug]) == []


def test_distances_are_symmetric_and_zero_on_the_diagonal():
    table = np.array([descriptor(make(name, 0)) for name in ("mug", "pen", "box")])
    got = distances(table, table)
    assert np.allclose(got, got.T) and np.allclose(np.diag(got), 0)
