import numpy as np
import pytest

from grasp_core.simulation.precheck import BODIES, TABLE, HeightMap, Precheck, Verdict


def posed(asset, pose):
    return [part.vertices @ pose[:3, :3].T + pose[:3, 3] for part in asset.parts]


def check(shapes, gripper, physics, assets, grasps):
    scene = [posed(asset, pose) for asset, pose in assets]
    return Precheck(scene, gripper, physics).check(np.array(grasps, float))


def test_height_map_is_the_top_of_the_parts(shapes):
    box = shapes.box(0.04, 0.06, 0.05)
    heights = HeightMap.of([posed(box, shapes.standing(box))], 0.0005)
    rng = np.random.default_rng(0)
    x, y = rng.uniform(-0.03, 0.03, 500), rng.uniform(-0.04, 0.04, 500)
    clear = (np.abs(np.abs(x) - 0.02) > 0.0005) & (np.abs(np.abs(y) - 0.03) > 0.0005)
    expected = np.where((np.abs(x) < 0.02) & (np.abs(y) < 0.03), 0.05, 0.0)
    _, found = heights.at(x, y)
    assert np.allclose(found[clear], expected[clear], atol=1e-6)
    assert heights.owners.max() == 0
    assert heights.at(np.array([5.0]), np.array([0.0]))[1][0] == 0.0


def test_height_map_of_slopes_and_overlaps(shapes):
    """The highest of several parts counts; a tilted box has the slope of its upper faces."""
    box = shapes.box(0.06, 0.06, 0.06)
    pose = shapes.standing(box)
    c = np.sqrt(0.5)
    pose[:3, :3] = [[c, 0, c], [0, 1, 0], [-c, 0, c]]
    pose[2, 3] = 0.06 * c
    heights = HeightMap.of([posed(box, pose)], 0.0005)
    x = np.linspace(-0.04, 0.04, 41)
    _, found = heights.at(x, np.zeros(41))
    assert np.allclose(found, 0.12 * c - np.abs(x), atol=6e-4)


@pytest.mark.parametrize(
    ("x", "z", "body"),
    [(0.035, 0.02, "left_finger"), (-0.035, 0.02, "right_finger"), (0.0, 0.005, "rod")],
)
def test_what_collides_is_named(shapes, gripper, physics, x, z, body):
    box = shapes.box(0.04, 0.06, 0.08)
    found = check(shapes, gripper, physics, [(box, shapes.standing(box))], [[x, 0, z, 0, 0.1]])
    assert found.verdict[0] == Verdict.COLLISION
    assert BODIES[found.body[0]] == body
    assert found.obstacle[0] == 0
    assert found.place[0, 2] == pytest.approx(0.08, abs=1e-6)


def test_the_base_collides_beside_the_rod(shapes, gripper, physics):
    low, tall = shapes.box(0.03, 0.02, 0.03), shapes.box(0.02, 0.01, 0.12)
    scene = [(low, shapes.standing(low)), (tall, shapes.standing(tall, y=0.0165))]
    found = check(shapes, gripper, physics, scene, [[0, 0, 0.01, 0, 0.1]])
    assert (BODIES[found.body[0]], found.obstacle[0]) == ("base", 1)


def test_the_table_collides(shapes, gripper, physics):
    box = shapes.box(0.04, 0.06, 0.05)
    found = check(shapes, gripper, physics, [(box, shapes.standing(box))], [[0, 0.2, -0.001, 0, 0.1]])
    assert found.verdict[0] == Verdict.COLLISION
    assert found.obstacle[0] == TABLE
    assert found.place[0, 2] == 0


def test_missed_and_gaps(shapes, gripper, physics):
    box = shapes.box(0.04, 0.06, 0.05)
    scene = [(box, shapes.standing(box))]
    found = check(
        shapes,
        gripper,
        physics,
        scene,
        [[0.01, 0, 0.02, 0, 0.1], [0, 0.2, 0.02, 0, 0.1], [0, 0, 0.051, 0, 0.1], [0, 0, 0.02, np.pi / 2, 0.08]],
    )
    assert found.verdict.tolist() == [Verdict.OPEN, Verdict.MISSED, Verdict.MISSED, Verdict.OPEN]
    assert found.gaps[0] == pytest.approx([0.02, 0.04], abs=6e-4)
    assert found.gaps[3] == pytest.approx([0.01, 0.01], abs=6e-4)
    assert np.isinf(found.gaps[1]).all()


def test_a_batch_equals_its_single_grasps(shapes, gripper, physics):
    mug = shapes.mug()
    rng = np.random.default_rng(0)
    grasps = np.column_stack(
        [rng.uniform(-0.06, 0.06, (300, 2)), rng.uniform(0, 0.09, 300), rng.uniform(-1.5, 1.5, 300), np.full(300, 0.09)]
    )
    precheck = Precheck([posed(mug, shapes.standing(mug))], gripper, physics)
    together = precheck.check(grasps)
    assert set(together.verdict.tolist()) == {0, 1, 2}
    for index in range(0, 300, 7):
        one = precheck.check(grasps[index : index + 1])
        for name in ("verdict", "body", "obstacle", "place", "gaps"):
            assert np.array_equal(getattr(one, name)[0], getattr(together, name)[index], equal_nan=name == "place")
