import numpy as np
import pytest

from grasp_core.objects.parametric import toys

GROUP = toys


def test_sound(own_family, assert_sound):
    assert_sound(own_family)


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("name", ["animal", "toy_car"])
def test_on_four_feet(look, name, seed):
    toy = look(name, seed)
    feet = toy.slices("z", 0.03)
    assert len(feet) == 4
    assert len(toy.slices("z", 0.5)) == 1
    boxes = np.array([foot.bounds() for foot in feet])
    middles = (boxes[:, :2] + boxes[:, 2:]) / 2
    assert len({tuple(np.sign(m - middles.mean(axis=0))) for m in middles}) == 4


@pytest.mark.parametrize("seed", [0, 1, 3])
def test_a_brick_has_studs_in_a_grid(look, seed):
    brick = look("brick", seed)
    studs = brick.slices("z", 0.97)
    assert len(studs) in {2, 3, 4, 6, 8}
    assert np.ptp([stud.area() for stud in studs]) < 0.02 * studs[0].area()
    (block,) = brick.slices("z", 0.3)
    assert block.area() == pytest.approx(brick.sides[0] * brick.sides[1], rel=0.01)


@pytest.mark.parametrize("seed", range(4))
def test_a_polyomino_is_of_three_to_five_cubes(look, seed):
    """One part per cube, all alike; together they are all that is seen."""
    shape = look("polyomino", seed)
    cubes = [part.mesh.volume * 1e9 for part in shape.asset.parts]
    assert len(cubes) in {3, 4, 5}
    assert np.ptp(cubes) < 1e-3 * cubes[0]
    assert shape.body.volume() == pytest.approx(len(cubes) * cubes[0], rel=0.07)


@pytest.mark.parametrize("seed", [0, 1])
def test_a_dumbbell_is_thin_between_its_weights(look, seed):
    bell = look("dumbbell", seed)
    middle, left, right = (bell.spans("x", share).max() for share in (0.5, 0.15, 0.87))
    assert middle < 0.85 * min(left, right)


@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("name", ["toy_plane", "boat", "animal"])
def test_the_same_left_and_right(look, name, seed):
    toy = look(name, seed)
    both = toy.body ^ toy.body.mirror((0, 1, 0))
    assert both.volume() > 0.97 * toy.body.volume()


@pytest.mark.parametrize("seed", [0, 1])
def test_a_plane_has_wings_wider_than_its_tail_and_a_fin(look, seed):
    plane = look("toy_plane", seed)
    spans = [plane.spans("x", share)[0] for share in np.linspace(0.05, 0.95, 19)]
    assert max(spans[3:15]) > 2 * max(spans[-4:])
    (top,) = plane.slices("z", 0.9)
    assert (top.bounds()[0] + top.bounds()[2]) / 2 > plane.low[0] + 0.75 * plane.sides[0]


@pytest.mark.parametrize("seed", range(3))
def test_a_star_has_as_many_dents_as_points(look, seed):
    """Walked around, the rim goes out to a point and back to a dent four to seven times."""
    star = look("star", seed)
    middle = (star.low + star.high) / 2
    turns = np.radians(np.arange(0, 360, 2.0))
    away = np.array([star.hits(middle, (np.cos(t), np.sin(t), 0))[-1] for t in turns])
    rough = (away.max() + away.min()) / 2
    crossings = int((np.diff(np.r_[away, away[0]] > rough) != 0).sum())
    assert crossings in {8, 10, 12, 14}
    assert star.fill < 0.9


@pytest.mark.parametrize("seed", [0, 1])
def test_a_stone_is_convex_and_a_cluster_is_not(look, seed):
    assert look("stone", seed).fill > 0.999
    assert len(look("stone", seed).asset.parts) == 1
    assert look("cluster", seed).fill < 0.95


@pytest.mark.parametrize("seed", [0, 1])
def test_a_top_stands_on_a_tip_and_is_widest_below_its_peg(look, seed):
    top = look("spinning_top", seed)
    spans = np.array([top.spans("z", share).max() for share in (0.02, 0.45, 0.97)])
    assert spans[1] > 3 * spans[0] and spans[1] > 3 * spans[2]
