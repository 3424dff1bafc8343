import importlib.util
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh

from grasp_core.camera import canonical_camera
from grasp_core.errors import ConfigError, ImageError
from grasp_core.networks.inputs import regression_input
from grasp_core.networks.runtime import load_runtime
from grasp_core.objects.asset import ObjectAsset, Part
from grasp_core.planning.crops import crops as cut
from grasp_core.planning.crops import deepen, sample, surface_map
from grasp_core.scene import Scene
from grasp_core.sensing.renderer import render

Maker = Callable[..., Path]
needs_openvino = pytest.mark.skipif(importlib.util.find_spec("openvino") is None, reason="OpenVINO is not installed")
BACKENDS = [pytest.param("openvino", marks=needs_openvino), "torch"]


@needs_openvino
def test_backends_agree(make_weights: Maker) -> None:
    path = make_weights(width=16)
    fast, reference = (load_runtime(path, backend, threads=1) for backend in ("openvino", "torch"))  # type: ignore[arg-type]
    assert fast.digest == reference.digest
    rng = np.random.default_rng(0)
    crops = rng.normal(0, 1, (70, 48, 48)).astype(np.float32)
    scores = fast.scores(crops)
    assert scores.std() > 0.01
    assert np.abs(scores - reference.scores(crops)).max() <= 0.005
    for shape in ((300, 300), (131, 222)):
        heights = rng.uniform(0, 2, (1, *shape)).astype(np.float32)
        maps = fast.quality_map(heights)
        assert maps.std() > 0.01
        np.testing.assert_allclose(maps, reference.quality_map(heights), atol=0.005)


@pytest.mark.parametrize("backend", BACKENDS)
def test_scores_and_maps_have_the_shape_of_what_is_given_whatever_it_is_filled_up_to(
    backend: str, make_weights: Maker
) -> None:
    runtime = load_runtime(make_weights(width=8), backend, threads=1)  # type: ignore[arg-type]
    rng = np.random.default_rng(0)
    crops = rng.normal(0, 1, (150, 48, 48)).astype(np.float32)
    scores = runtime.scores(crops)
    for count in (1, 16, 17, 63, 65, 149):
        found = runtime.scores(crops[:count])
        assert found.shape == (count,)
        np.testing.assert_allclose(found, scores[:count], atol=1e-5)
    heights = rng.uniform(0, 2, (1, 301, 444)).astype(np.float32)
    whole = runtime.quality_map(heights)
    assert whole.shape == heights.shape
    for height, width in ((180, 175), (230, 301), (301, 250)):
        found = runtime.quality_map(heights[:, :height, :width])
        assert found.shape == (1, height, width)
        np.testing.assert_allclose(found[:, :-48, :-48], whole[:, : height - 48, : width - 48], atol=1e-4)


@needs_openvino
def test_openvino_meets_few_sizes(make_weights: Maker, monkeypatch: pytest.MonkeyPatch) -> None:
    runtime = load_runtime(make_weights(width=8), "openvino", threads=1)
    sizes: set[tuple[int, ...]] = set()
    refined, regression = runtime._refined_request, runtime._regression_request  # type: ignore[attr-defined]

    class Spy:
        def __init__(self, request: object) -> None:
            self.request = request

        def infer(self, inputs: list[np.ndarray], **options: bool) -> object:
            sizes.add(inputs[0].shape)
            return self.request.infer(inputs, **options)  # type: ignore[attr-defined]

    monkeypatch.setattr(runtime, "_refined_request", Spy(refined))
    monkeypatch.setattr(runtime, "_regression_request", Spy(regression))
    for count in range(1, 300, 7):
        runtime.scores(np.zeros((count, 48, 48), np.float32))
        runtime.quality_map(np.zeros((1, count, 300 - count), np.float32))
    assert sizes == {(n, 1, 48, 48) for n in (16, 32, 48, 64)} | {(1, 1, n, n) for n in (180, 240, 300)}


@needs_openvino
def test_shipped_weights_agree_on_rendered_crops() -> None:
    camera = canonical_camera()
    mesh = trimesh.creation.box((0.12, 0.03, 0.05))
    part = Part(np.array(mesh.vertices), np.array(mesh.faces, np.int32))
    bar = ObjectAsset("bar", "bar", part.vertices, part.faces, (part,), float(mesh.volume), mesh.moment_inertia)
    pose = np.eye(4)
    pose[2, 3] = 0.025
    depth = render(Scene.single(bar, pose, camera)).depth
    v, u = (axis.ravel() for axis in np.mgrid[120:181:10, 100:201:10])
    angles = np.tile(np.arange(6) * np.pi / 6, len(u))
    u, v = np.repeat(u, 6), np.repeat(v, 6)
    seen = cut(depth, camera, u, v, angles, deepen(sample(surface_map(depth), u, v), camera))
    fast, reference, half = (
        load_runtime("default", backend, threads=1, precision=precision)  # type: ignore[arg-type]
        for backend, precision in (("openvino", "f32"), ("torch", "f32"), ("openvino", "bf16"))
    )
    scores = reference.scores(seen)
    assert scores.min() < 0.05 and scores.max() > 0.8  # of both kinds
    assert np.abs(fast.scores(seen) - scores).max() <= 0.005
    assert np.abs(half.scores(seen) - scores).max() <= 0.03
    heights = regression_input(depth)[None]
    np.testing.assert_allclose(fast.quality_map(heights), reference.quality_map(heights), atol=0.005)


@needs_openvino
def test_half_precision_stays_close(make_weights: Maker) -> None:
    path = make_weights(width=8)
    crops = np.random.default_rng(0).normal(0, 1, (64, 48, 48)).astype(np.float32)
    full = load_runtime(path, "openvino", threads=1).scores(crops)
    half = load_runtime(path, "openvino", threads=1, precision="bf16").scores(crops)
    assert np.abs(full - half).max() <= 0.03


@needs_openvino
def test_automatic_precision_is_what_the_processor_computes_in(make_weights: Maker, monkeypatch) -> None:
    path = make_weights()
    for native, name in ((True, "openvino-bf16"), (False, "openvino")):
        monkeypatch.setattr("grasp_core.networks.openvino_models.native_bf16", lambda native=native: native)
        assert load_runtime(path, "openvino", threads=1, precision="auto").backend == name
    assert load_runtime(path, "torch", threads=1, precision="auto").backend.startswith("torch")


@pytest.mark.parametrize("backend", BACKENDS)
def test_shapes_and_their_errors(make_weights: Maker, backend: str) -> None:
    runtime = load_runtime(make_weights(), backend, threads=1)  # type: ignore[arg-type]
    assert runtime.backend.startswith(backend)
    assert runtime.scores(np.zeros((0, 48, 48), np.float32)).shape == (0,)
    assert runtime.quality_map(np.zeros((0, 30, 30), np.float32)).shape == (0, 30, 30)
    assert runtime.quality_map(np.zeros((2, 31, 29), np.float32)).shape == (2, 31, 29)
    scores = runtime.scores(np.zeros((3, 48, 48), np.float32))
    assert scores.dtype == np.float32
    assert np.all((scores >= 0) & (scores <= 1))
    with pytest.raises(ImageError, match="48, 48"):
        runtime.scores(np.zeros((3, 32, 32), np.float32))
    with pytest.raises(ImageError, match="first axis"):
        runtime.quality_map(np.zeros((30, 30), np.float32))


@pytest.mark.parametrize("backend", BACKENDS)
def test_results_do_not_change_with_the_next_call(make_weights: Maker, backend: str) -> None:
    runtime = load_runtime(make_weights(), backend, threads=1)  # type: ignore[arg-type]
    rng = np.random.default_rng(0)
    first = runtime.scores(rng.normal(size=(4, 48, 48)).astype(np.float32))
    kept = first.copy()
    runtime.scores(rng.normal(size=(4, 48, 48)).astype(np.float32))
    np.testing.assert_array_equal(first, kept)


@pytest.mark.parametrize("backend", BACKENDS)
def test_several_threads_may_call(make_weights: Maker, backend: str) -> None:
    runtime = load_runtime(make_weights(), backend, threads=1)  # type: ignore[arg-type]
    crops = np.random.default_rng(0).normal(size=(6, 8, 48, 48)).astype(np.float32)
    wanted = [runtime.scores(batch) for batch in crops]
    wrong: list[int] = []

    def work(index: int) -> None:
        for _ in range(5):
            if not np.allclose(runtime.scores(crops[index]), wanted[index], atol=1e-6):
                wrong.append(index)

    threads = [threading.Thread(target=work, args=(index,)) for index in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []


def test_refuses_unknown_backend_and_threads(make_weights: Maker) -> None:
    with pytest.raises(ConfigError, match="auto, openvino, torch"):
        load_runtime(make_weights(), "tensorflow")  # type: ignore[arg-type]
    with pytest.raises(ConfigError, match="at least 1"):
        load_runtime(make_weights(), threads=0)


ALONE = """
import socket, sys
def refuse(*_, **__):
    raise SystemExit("something tried to reach the network")
socket.socket.connect = socket.socket.connect_ex = socket.getaddrinfo = socket.create_connection = refuse
import numpy as np
from grasp_core.networks.inputs import regression_input
from grasp_core.networks.runtime import load_runtime
runtime = load_runtime(sys.argv[1], threads=1)
runtime.quality_map(regression_input(np.full((1, 60, 60), 0.7, np.float32)))
runtime.scores(np.zeros((2, 48, 48), np.float32))
unwanted = ("torch", "openvino_telemetry")
loaded = [name for name, module in sys.modules.items() if module and name.split(".")[0] in unwanted]
assert not loaded, loaded
print(runtime.backend)
"""


@needs_openvino
def test_planning_needs_no_torch_and_no_network(make_weights: Maker) -> None:
    done = subprocess.run(
        [sys.executable, "-c", ALONE, str(make_weights())], capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "openvino"
