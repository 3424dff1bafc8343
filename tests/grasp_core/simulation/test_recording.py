import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from grasp_core.errors import GraspError
from grasp_core.grasp import Grasp
from grasp_core.simulation.recording import PHASES, Recording
from grasp_core.simulation.trial import GraspTrial, Outcome


@pytest.fixture(scope="module")
def attempt(physics, gripper, shapes):
    trial = GraspTrial(shapes.alone(shapes.box(0.04, 0.06, 0.06)), gripper, physics)
    return trial.attempt(Grasp((0, 0, 0.03), 0.4, 0.09), 3, record=True)


def test_a_recording_shows_the_whole_attempt(attempt, gripper):
    assert attempt.outcome is Outcome.SUCCESS
    film = attempt.recording
    assert film.outcome == "SUCCESS"
    assert film.words == attempt.evidence.words
    assert film.names == ("object_0", "base", "rod", "left_finger", "right_finger")
    assert film.poses.shape == (len(film.times), 5, 7)
    assert np.all(np.diff(film.times) > 0)
    assert [PHASES[p] for p in dict.fromkeys(film.phases.tolist())] == ["approach", "close", "lift"]
    assert np.allclose(np.linalg.norm(film.poses[..., 3:], axis=-1), 1, atol=1e-5)
    rod = film.poses[:, film.names.index("rod"), 2]
    assert rod[0] > rod[-1] - 0.3 + 0.1  # came from above
    assert rod[-1] - rod[film.phases == 1][0] == pytest.approx(0.30, abs=5e-3)  # the whole lift
    assert film.poses[-1, 0, 2] - film.poses[0, 0, 2] == pytest.approx(0.30, abs=0.01)
    assert film.fingers[0] == pytest.approx([0.005, 0.005], abs=1e-6)
    assert np.all(film.fingers <= gripper.opening / 2 + 1e-3)


def test_fingers_face_each_other_along_the_closing_axis(attempt, gripper):
    film = attempt.recording
    left = film.poses[:, film.names.index("left_finger")]
    right = film.poses[:, film.names.index("right_finger")]
    way = right[:, :3] - left[:, :3]
    opened = gripper.opening - film.fingers.sum(axis=1) + gripper.finger.x
    assert np.linalg.norm(way, axis=1) == pytest.approx(opened, abs=1e-5)
    axis = Rotation.from_quat(left[0, [4, 5, 6, 3]]).apply([1, 0, 0])
    assert np.allclose(axis, attempt.executed.closing_axis, atol=1e-6)
    assert np.allclose(way[0] / np.linalg.norm(way[0]), axis, atol=1e-5)


def test_contacts_lie_on_the_object_and_push_inwards(attempt):
    film = attempt.recording
    assert len(film.contact_frames) > 50
    last = film.contact_frames >= len(film.times) - 20
    assert set(film.contact_fingers[last].tolist()) == {0, 1}
    axis = attempt.executed.closing_axis
    for finger, sign in ((0, 1), (1, -1)):
        push = film.contact_forces[last & (film.contact_fingers == finger)].sum(axis=0) @ axis / 20
        assert push * sign == pytest.approx(20, rel=0.05)
    total = film.contact_forces[last].sum(axis=0) / 20
    assert total[2] == pytest.approx(0.072 * 9.81, abs=0.05)  # both fingers carry the weight


def test_collisions_and_misses_are_recorded_too(physics, gripper, shapes):
    trial = GraspTrial(shapes.alone(shapes.box(0.04, 0.06, 0.06)), gripper, physics, None)
    hit = trial.attempt(Grasp((0.04, 0, 0.03), 0.0, 0.1), 0, record=True)
    film = hit.recording
    tip = film.poses[-1, film.names.index("left_finger"), 2] - gripper.finger.z / 2
    assert tip == pytest.approx(0.06, abs=1e-5)  # stopped on top of the box
    assert set(film.phases.tolist()) == {0}
    missed = trial.attempt(Grasp((0, 0.2, 0.03), 0.0, 0.1), 0, record=True).recording
    assert missed.fingers[-1] == pytest.approx([0.05, 0.05], abs=1e-6)


def test_recording_does_not_change_the_attempt(physics, gripper, shapes, attempt):
    trial = GraspTrial(shapes.alone(shapes.box(0.04, 0.06, 0.06)), gripper, physics, whole=True)
    again = trial.attempt(Grasp((0, 0, 0.03), 0.4, 0.09), 3)
    assert (again.outcome, again.evidence, again.comfort) == (attempt.outcome, attempt.evidence, attempt.comfort)


def test_save_and_load(attempt, tmp_path):
    path = tmp_path / "one.npz"
    attempt.recording.save(path)
    again = Recording.load(path)
    for name in Recording.__dataclass_fields__:
        assert np.array_equal(getattr(again, name), getattr(attempt.recording, name)), name


def test_damaged_files_are_refused(tmp_path):
    with pytest.raises(GraspError, match="cannot be read"):
        Recording.load(tmp_path / "nowhere.npz")
    bad = tmp_path / "bad.npz"
    bad.write_bytes(b"not a recording")
    with pytest.raises(GraspError, match="holds no recording"):
        Recording.load(bad)
