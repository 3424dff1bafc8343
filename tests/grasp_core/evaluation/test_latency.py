import time

import numpy as np
import pytest
import torch

from grasp_core.camera import Camera, CameraIntrinsics, DepthImage, load_camera, look_down
from grasp_core.errors import GraspError
from grasp_core.evaluation import cache, latency, suites
from grasp_core.evaluation.latency import make_images, run_latency, time_first_plan, time_planner
from grasp_core.gripper import load_gripper
from grasp_core.networks.modules import tensors
from grasp_core.networks.refined import RefinedNetwork
from grasp_core.networks.regression import RegressionNetwork
from grasp_core.networks.weights import Weights, save_weights
from grasp_core.planning.planner import Plan
from grasp_core.sensing.noise import ImageNoise
from grasp_core.simulation.physics import load_physics

CAMERA = Camera(CameraIntrinsics(525, 525, 319.5, 239.5, 640, 480), look_down(0.7))


@pytest.fixture
def weights(tmp_path):
    gripper = load_gripper()
    state = {**tensors(RegressionNetwork(), "regression"), **tensors(RefinedNetwork(4), "refined")}
    meta = Weights(name="tiny", gripper=gripper.name, gripper_digest=gripper.digest, width=4)
    return str(save_weights(tmp_path / "tiny.safetensors", state, meta))


def block_image() -> DepthImage:
    depth = np.full((480, 640), 0.7)
    depth[230:250, 290:350] = 0.66
    return DepthImage.from_array(depth, CAMERA)


def test_times_stages_and_counts_of_a_planner():
    calls = []

    def planner(image, *, mask=None, budget_ms=None, rng):
        calls.append(rng.random())
        time.sleep(0.01)
        empty = np.zeros((0, 2))
        stages = {"one": 4.0, "two": float(len(calls))}
        heat = np.zeros(image.depth.shape, np.float32)
        return Plan((), None, image, heat, None, empty, (None,) * 7, stages, image.camera, "", 0.0)  # type: ignore[arg-type]

    timing = time_planner(planner, [block_image()] * 3, 4, 0)
    assert len(calls) == 3 + 12 and len(set(calls)) == 15  # warm-up, then four plans an image
    assert 10 <= timing.median_ms <= timing.p95_ms
    assert timing.candidates == 7
    assert timing.stages_ms["one"] == 4.0 and timing.stages_ms["two"] > 3  # the warm-up is left out


def test_all_backends_the_exhaustive_search_and_the_first_plan_are_timed(weights, monkeypatch):
    monkeypatch.setattr(latency, "time_first_plan", lambda *_: 123.0)
    threads = torch.get_num_threads()
    result = run_latency([block_image()], load_gripper(), "paper", weights, 2, 0)
    torch.set_num_threads(threads)
    assert "torch" in "".join(result.backends)
    assert result.backend in result.backends
    best = result.backends[result.backend]
    assert (result.median_ms, result.p95_ms) == (best.median_ms, best.p95_ms) and result.stages_ms
    assert 0 < result.candidates <= 5 * (64 + 64) < result.exhaustive_candidates  # regions and pairs, each polished
    assert result.exhaustive_ratio == pytest.approx(result.exhaustive_median_ms / result.median_ms, rel=0.1)
    assert result.pruned_exhaustive_candidates < result.exhaustive_candidates
    ratio = result.pruned_exhaustive_median_ms / result.median_ms
    assert result.pruned_exhaustive_ratio == pytest.approx(ratio, rel=0.1)
    assert 0 < result.unpolished.candidates < result.candidates
    assert result.first_plan_ms == 123.0 and result.weights.startswith("tiny ")
    assert result.images == 1 and result.repeats == 2


def test_the_first_plan_is_made_by_a_new_process(weights):
    ms = time_first_plan(block_image(), "paper", weights)
    assert ms > 100
    with pytest.raises(GraspError, match="a new process could not plan"):
        time_first_plan(block_image(), "no-such-gripper", weights)


def test_images_show_the_objects_with_noise_and_the_camera_as_given(tmp_path, monkeypatch):
    monkeypatch.setattr(cache, "folder", lambda: tmp_path)
    monkeypatch.setattr(suites, "_DROPS", 4)
    suite = tmp_path / "suite.yaml"
    suite.write_text("about: quick\nobjects: {names: [box_900, glue_stick_900]}\n")
    camera = load_camera("primesense")
    (image,) = make_images(str(suite), camera, load_physics(), ImageNoise(), 1, 0)
    assert image.depth.shape == (480, 640) and image.camera.world_from_camera is None
    assert np.median(image.depth) == pytest.approx(0.7, abs=0.002)
    assert 0.0005 < image.depth[:40, :40].std() < 0.002  # Eq. 5
    assert (image.depth < 0.68).sum() > 500


def test_objects_that_cannot_be_used_leave_no_image(tmp_path):
    (tmp_path / "bad.obj").write_text("v 0 0 0\n")
    with pytest.raises(GraspError, match="no object that can be used"):
        make_images(str(tmp_path), load_camera("primesense"), load_physics(), ImageNoise(), 1, 0)
