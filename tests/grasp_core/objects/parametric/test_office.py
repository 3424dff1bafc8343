import numpy as np
import pytest

from grasp_core.objects.parametric import office

GROUP = office


def test_sound(own_family, assert_sound):
    assert_sound(own_family)


@pytest.mark.parametrize("seed", [0, 1])
def test_scissors_have_two_eyes_and_a_blade(look, seed):
    scissors = look("scissors", seed)
    assert scissors.holes == 2
    assert scissors.spans("x", 0.95)[0] < 0.5 * scissors.spans("x", 0.1)[0]
    # through the eyes nothing is met, neither in what is seen nor in the parts
    columns = [
        (x, y)
        for x in np.linspace(scissors.low[0], scissors.high[0], 40)
        for y in np.linspace(scissors.low[1], scissors.high[1], 12)
    ]
    free = [
        not len(scissors.hits(np.array([x, y, scissors.high[2] + 5]), (0, 0, -1), parts=True))
        for x, y in columns
        if abs(x - scissors.low[0] - 0.13 * scissors.sides[0]) < 0.04 * scissors.sides[0]
    ]
    assert 0.1 < np.mean(free) < 0.9


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_pen_is_slender_and_has_a_tip(look, seed):
    pen = look("pen", seed)
    assert pen.sides[0] > 4.5 * pen.sides[1:].max()
    assert pen.spans("x", 0.01).max() < 0.5 * pen.spans("x", 0.4).max()


@pytest.mark.parametrize("seed", [0, 1])
def test_a_phone_is_flat_with_a_bump_in_one_corner(look, seed):
    phone = look("phone", seed)
    assert phone.sides[2] < 0.25 * phone.sides[:2].min()
    assert phone.fill > 0.9


def test_some_phones_have_a_camera(look):
    tops = [look("phone", seed).slices("z", 0.99)[0] for seed in range(5)]
    shares = [top.area() / np.prod(look("phone", seed).sides[:2]) for seed, top in enumerate(tops)]
    assert min(shares) < 0.15 and max(shares) > 0.8


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_box_fills_its_box(look, seed):
    box = look("box", seed)
    assert box.body.volume() > 0.85 * np.prod(box.sides)
    assert box.fill > 0.999
    assert len(box.asset.parts) == 1


@pytest.mark.parametrize("seed", [0, 1])
def test_a_carton_is_upright_with_a_gable(look, seed):
    carton = look("carton", seed)
    assert carton.sides.argmax() == 2
    low, high = carton.slices("z", 0.2)[0].area(), carton.slices("z", 0.99)[0].area()
    assert high < 0.25 * low


@pytest.mark.parametrize("seed", [0, 1])
def test_a_stapler_gapes_at_its_front(look, seed):
    stapler = look("stapler", seed)
    assert [len(stapler.slices("x", share)) for share in (0.05, 0.97)] == [1, 2]


@pytest.mark.parametrize("seed", [0, 1])
def test_a_glue_sticks_cap_is_a_step_wider(look, seed):
    stick = look("glue_stick", seed)
    assert stick.spans("z", 0.85).max() == pytest.approx(1.12 * stick.spans("z", 0.3).max(), rel=0.01)


@pytest.mark.parametrize("seed", [0, 1])
def test_a_stamp_has_a_waist_below_its_knob(look, seed):
    stamp = look("stamp", seed)
    foot, waist, knob = (stamp.spans("z", share).max() for share in (0.1, 0.5, 0.8))
    assert waist < 0.75 * knob and waist < 0.75 * foot


@pytest.mark.parametrize("seed", [0, 1])
def test_a_mouse_is_flat_below_and_humped_above(look, seed):
    mouse = look("mouse", seed)
    assert mouse.slices("z", 0.01)[0].area() > 1.5 * mouse.slices("z", 0.85)[0].area()
