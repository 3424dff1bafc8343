import numpy as np
import pytest

from grasp_core.grasp import Grasp
from grasp_core.simulation.filmstrip import filmstrip
from grasp_core.simulation.trial import GraspTrial


@pytest.fixture(scope="module")
def trial(physics, gripper, shapes):
    return GraspTrial(shapes.alone(shapes.box(0.04, 0.06, 0.06)), gripper, physics, None)


def blue(picture: np.ndarray) -> np.ndarray:
    """Pixels of the first object's colour, whatever their shade."""
    b, g, r = (picture[..., k].astype(int) for k in range(3))
    return (b > g + 20) & (g > r + 10)


def test_frames_show_the_object_between_the_fingers(trial, gripper):
    film = trial.attempt(Grasp((0, 0, 0.03), 0.0, 0.1), 0, record=True).recording
    assets = [placed.asset for placed in trial.scene.objects]
    picture = filmstrip(assets, gripper, film, frames=5, size=160)
    assert picture.shape == (160 + 26, 5 * 160, 3)
    assert picture.dtype == np.uint8
    for column in range(5):
        frame = picture[26:, column * 160 : (column + 1) * 160]
        rows, columns = np.nonzero(blue(frame))
        assert len(rows) > 200  # held, so it stays in view while the view rises
        assert abs(columns.mean() - 80) < 25


def test_a_lost_object_leaves_the_view(physics, gripper, shapes):
    trial = GraspTrial(shapes.alone(shapes.box(0.04, 0.14, 0.06, mass=4.0)), gripper, physics, None)
    film = trial.attempt(Grasp((0, 0, 0.03), 0.0, 0.1), 0, record=True).recording
    picture = filmstrip([trial.scene.objects[0].asset], gripper, film, frames=5, size=160)
    assert blue(picture[26:, :160]).sum() > 200
    assert blue(picture[26:, -160:]).sum() == 0


def test_a_collision_has_the_frames_it_has(trial, gripper):
    film = trial.attempt(Grasp((0.04, 0, 0.03), 0.0, 0.1), 0, record=True).recording
    picture = filmstrip([trial.scene.objects[0].asset], gripper, film, size=100, title="hit")
    assert picture.shape == (126, 100, 3)
