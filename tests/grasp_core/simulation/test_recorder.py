from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from grasp_core.grasp import Grasp
from grasp_core.simulation.contacts import Touch
from grasp_core.simulation.evidence import Outcome
from grasp_core.simulation.recorder import Recorder, pose_rows
from grasp_core.simulation.recording import PHASES

GRASP = Grasp((0.1, 0.2, 0.03), 0.5, 0.08)


def resting(x=0.1):
    pose = np.eye(4)
    pose[:3, 3] = [x, 0.2, 0.025]
    return pose


class Still:
    """An engine frozen at a moment."""

    def __init__(self, time, lift, travel, objects, touches=()):
        self.time, self.lift, self.travel = time, lift, travel
        self.objects = [SimpleNamespace(pose=pose) for pose in objects]
        self._touches = list(touches)

    def touches(self):
        return self._touches


def inner_gap(recording, frame, gripper):
    """Distance between the fingers' inner faces along the closing axis, metres."""
    left, right = (recording.poses[frame, recording.names.index(f"{side}_finger"), :3] for side in ("left", "right"))
    return float((right - left) @ GRASP.closing_axis) - gripper.finger.x


def test_pose_rows_keep_place_and_turn():
    turn = Rotation.from_euler("xyz", [0.3, -0.4, 1.1])
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turn.as_matrix(), [1, 2, 3]
    (row,) = pose_rows([pose])
    assert row.dtype == np.float32
    assert row[:3].tolist() == [1, 2, 3]
    w, x, y, z = row[3:]
    assert Rotation.from_quat([x, y, z, w]).as_matrix() == pytest.approx(turn.as_matrix(), abs=1e-6)
    assert abs(w) == pytest.approx(np.cos(turn.magnitude() / 2), abs=1e-6)


def test_the_approach_comes_straight_down_with_the_fingers_as_wide_as_the_grasp(gripper):
    recorder = Recorder(gripper, GRASP, [resting()])
    recorder.approach(0.0)
    recording = recorder.finish(Outcome.MISSED, "nothing")
    assert recording.names == ("object_0", "base", "rod", "left_finger", "right_finger")
    assert {PHASES[phase] for phase in recording.phases} == {"approach"}
    assert recording.times[0] == 0 and (np.diff(recording.times) > 0).all()
    base = recording.poses[:, 1, :3]
    assert np.ptp(base[:, :2]) < 0.2 and np.allclose(base[:, :2], GRASP.position[:2], atol=1e-6)
    assert (np.diff(base[:, 2]) < 0).all()
    assert base[0, 2] - base[-1, 2] == pytest.approx(0.15, abs=1e-6)
    fingers_end = recording.poses[-1, 3, 2] - gripper.finger.z / 2
    assert fingers_end == pytest.approx(GRASP.position[2], abs=1e-6)
    assert inner_gap(recording, -1, gripper) == pytest.approx(GRASP.width, abs=1e-6)
    assert recording.fingers[-1].tolist() == pytest.approx([0.01, 0.01])
    assert np.array_equal(recording.poses[0, 0], recording.poses[-1, 0])
    speed = np.diff(base[:, 2]) / np.diff(recording.times)
    assert speed == pytest.approx([speed[0]] * len(speed), rel=1e-3)


def test_an_approach_that_meets_something_ends_above_the_grasp(gripper):
    recorder = Recorder(gripper, GRASP, [resting()])
    recorder.approach(0.13)
    recording = recorder.finish(Outcome.COLLISION, "met")
    low = recording.poses[:, 3, 2] - gripper.finger.z / 2 - GRASP.position[2]
    assert low[-1] == pytest.approx(0.13, abs=1e-6)
    assert low[0] > 0.17
    assert recording.outcome == "COLLISION"


def test_free_closing_moves_both_fingers_at_the_grippers_speed(gripper):
    recorder = Recorder(gripper, GRASP, [resting()])
    recorder.approach(0.0)
    recorder.free_closing(0.03)
    recording = recorder.finish(Outcome.MISSED, "nothing")
    closing = np.flatnonzero(recording.phases == PHASES.index("close"))
    begun = recording.times[closing[0] - 1]
    assert recording.times[-1] - begun == pytest.approx(0.03 / gripper.speed)
    assert inner_gap(recording, -1, gripper) == pytest.approx(GRASP.width - 0.06, abs=1e-6)
    assert (np.diff(recording.fingers[:, 0]) >= 0).all()
    assert recording.fingers[-1].tolist() == pytest.approx([0.04, 0.04])


def test_frames_follow_the_engine_and_keep_its_touches(gripper):
    recorder = Recorder(gripper, GRASP, [resting(), resting(0.4)])
    recorder.approach(0.0)
    before = len(recorder.finish(Outcome.MISSED, "").times)
    touch = Touch(1, 0, np.array([0.1, 0.2, 0.05]), np.array([1.0, 0, 0]), np.array([-20.0, 0, 3.0]))
    lifted = resting()
    lifted[2, 3] += 0.1
    recorder.frame(Still(0.05, 0.0, (0.03, 0.02), [resting(), resting(0.4)]), "close")
    recorder.frame(Still(0.25, 0.1, (0.03, 0.02), [lifted, resting(0.4)], [touch, touch]), "lift")
    recording = recorder.finish(Outcome.SUCCESS, "held")
    assert recording.names[:2] == ("object_0", "object_1") and recording.poses.shape[1:] == (6, 7)
    assert [PHASES[phase] for phase in recording.phases[-2:]] == ["close", "lift"]
    assert recording.times[-1] - recording.times[-2] == pytest.approx(0.2)
    assert recording.times[-2] - recording.times[before - 1] == pytest.approx(0.05)
    rise = recording.poses[-1, :, 2] - recording.poses[-2, :, 2]
    assert rise == pytest.approx([0.1, 0, 0.1, 0.1, 0.1, 0.1], abs=1e-6)
    assert inner_gap(recording, -1, gripper) == pytest.approx(gripper.opening - 0.05, abs=1e-6)
    left, right = recording.poses[-1, 4, :3], recording.poses[-1, 5, :3]
    middle = ((left + right) / 2 - GRASP.position) @ GRASP.closing_axis
    assert middle == pytest.approx(0.005, abs=1e-6)  # the left finger went farther
    assert recording.contact_frames.tolist() == [before + 1] * 2
    assert recording.contact_forces[0].tolist() == [-20, 0, 3]
    assert recording.contact_points.shape == (2, 3)
    assert recording.contact_fingers.tolist() == [1, 1] and recording.contact_objects.tolist() == [0, 0]
    assert (recording.outcome, recording.words) == ("SUCCESS", "held")


def test_without_touches_the_contact_arrays_are_empty(gripper):
    recorder = Recorder(gripper, GRASP, [resting()])
    recorder.approach(0.0)
    recording = recorder.finish(Outcome.MISSED, "nothing")
    assert recording.contact_points.shape == recording.contact_forces.shape == (0, 3)
    assert len(recording.contact_frames) == len(recording.contact_objects) == 0
