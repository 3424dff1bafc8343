import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import msgspec
import numpy as np
import pytest

from grasp_core.camera import canonical_camera, load_camera, look_down
from grasp_core.dataset.generate import Progress, evidence_json, generate, grid_grasps, place_scene, render_scene
from grasp_core.dataset.recipe import Objects, Recipe
from grasp_core.dataset.store import DatasetStore
from grasp_core.dataset.verify import verify
from grasp_core.errors import Cancelled, ConfigError, MismatchError
from grasp_core.gripper import load_gripper
from grasp_core.parallel import Executor
from grasp_core.simulation.evidence import Evidence
from grasp_core.simulation.trial import GraspTrial

CLI = [sys.executable, "-c", "import sys; from grasp_core.cli import main; sys.exit(main())"]
TINY = Recipe(
    name="tiny",
    train=Objects(families={"box": 1}),
    validation=Objects(families={"box": 1}, first=1),
    test=Objects(names=("box_002",)),
    poses=2,
    grid=3,
    angles=2,
    attempts=2,
)


@pytest.fixture(scope="module")
def tiny(tmp_path_factory):
    """(folder, summary, progress) of an uninterrupted run in this process."""
    path = tmp_path_factory.mktemp("tiny") / "data"
    seen: list[Progress] = []
    summary = generate(TINY, path, Executor(workers=0), progress=seen.append)
    return path, summary, seen


def digest(path: Path) -> str:
    with DatasetStore.open(path, readonly=True) as store:
        return store.content_digest()


def test_grid_spans_the_bounding_rectangle(make_box, at_rest):
    asset = make_box(size=(0.12, 0.04, 0.05))
    recipe = Recipe(name="t")
    scene = place_scene(asset, at_rest(asset), "b-0", recipe, canonical_camera())
    _, canonical = render_scene(scene)
    grasps = grid_grasps(scene.objects[0], canonical, load_gripper(), recipe)
    assert len(grasps) == 726
    positions = np.array([grasp.position for grasp in grasps])
    xy = scene.objects[0].vertices[:, :2]
    assert np.allclose(positions[:, :2].min(axis=0), xy.min(axis=0))
    assert np.allclose(positions[:, :2].max(axis=0), xy.max(axis=0))
    assert len(np.unique(positions[:, :2].round(9), axis=0)) == 121
    angles = np.unique(np.round(np.degrees([grasp.angle for grasp in grasps])))
    assert angles.tolist() == [-90, -60, -30, 0, 30, 60]
    centre = positions[np.linalg.norm(positions[:, :2], axis=1).argmin()]
    assert centre[2] == pytest.approx(0.05 - 0.03, abs=2e-4)  # 3 cm below the top
    assert positions[:, 2].min() == pytest.approx(0.008, abs=2e-4)  # beside it: 8 mm above the table
    assert {grasp.width for grasp in grasps} == {0.10}


def test_depth_rule_holds_under_another_stored_camera(make_box, at_rest):
    """The stored camera may be tilted; grasps follow the canonical view all the same."""
    asset = make_box()
    camera = load_camera("realsense").at(look_down(0.8, tilt=0.3))
    recipe = Recipe(name="t", grid=3, angles=1)
    views = []
    for chosen in (camera, canonical_camera()):
        scene = place_scene(asset, at_rest(asset), "b-0", recipe, chosen)
        depth, canonical = render_scene(scene)
        assert depth.camera is chosen
        views.append(grid_grasps(scene.objects[0], canonical, load_gripper(), recipe))
    assert views[0] == views[1]


def test_yaw_hangs_on_seed_and_name_alone(make_box, at_rest):
    asset = make_box()

    def pose(name, seed=0):
        scene = place_scene(asset, at_rest(asset), name, Recipe(name="t", seed=seed), canonical_camera())
        return scene.objects[0].world_from_object

    assert np.array_equal(pose("a"), pose("a"))
    assert not np.allclose(pose("a"), pose("b"))
    assert not np.allclose(pose("a"), pose("a", seed=1))
    assert np.allclose(pose("a")[:2, 3], 0)


def test_dataset_is_complete(tiny):
    path, summary, seen = tiny
    with DatasetStore.open(path, readonly=True) as store:
        scenes = store.scenes()
        assert {row.split for row in scenes} == {"train", "validation", "test"}
        assert len(scenes) == summary.scenes and summary.before == 0 and summary.refused == {}
        assert sum(summary.outcomes.values()) == len(scenes) * 18 * 2
        assert all(row.grasps == 18 for row in scenes)
        table = store.grasps(scenes[0].id)
        assert (table.attempts == 2).all()
        assert verify(store) == []
    assert seen[0].stage == "objects" and seen[-1] == Progress("scenes", len(scenes), len(scenes))


def test_stored_attempts_are_what_the_trial_gives_again(tiny):
    path, _, _ = tiny
    with DatasetStore.open(path, readonly=True) as store:
        row = store.scenes()[0]
        from grasp_core.simulation.physics import load_physics

        trial = GraspTrial(store.scene(row.id), load_gripper(), load_physics())
        table = store.grasps(row.id)
        for index in range(0, len(table), 5):
            for stored in store.attempts(int(table.id[index])):
                again = trial.attempt(table.grasp(index), stored.seed)
                assert again.outcome.value == stored.outcome
                assert (*again.executed.position, again.executed.angle) == stored.executed


def test_second_run_makes_nothing(tiny):
    path, first, _ = tiny
    before = digest(path)
    again = generate(TINY, path, Executor(workers=0))
    assert (again.scenes, again.before) == (0, first.scenes)
    assert digest(path) == before


def test_same_content_from_other_processes_and_another_order(tiny, tmp_path):
    path, _, _ = tiny
    generate(TINY, tmp_path / "two", Executor(workers=2))
    assert digest(tmp_path / "two") == digest(path)


def test_cancelled_run_goes_on(tiny, tmp_path):
    path, first, _ = tiny
    done: list[Progress] = []

    def enough() -> bool:
        return bool(done) and done[-1].stage == "scenes" and done[-1].done >= 2

    with pytest.raises(Cancelled, match="kept"):
        generate(TINY, tmp_path / "c", Executor(workers=0), progress=done.append, cancelled=enough)
    rest = generate(TINY, tmp_path / "c", Executor(workers=0))
    assert rest.before == 2 and rest.scenes == first.scenes - 2
    assert digest(tmp_path / "c") == digest(path)


def test_another_recipe_or_physics_is_refused(tiny):
    path, _, _ = tiny
    with pytest.raises(MismatchError, match=r"another recipe \(attempts"):
        generate(msgspec.structs.replace(TINY, attempts=3), path, Executor(workers=0))


def test_a_camera_without_a_pose_is_refused(tmp_path):
    with pytest.raises(ConfigError, match="world_from_camera"):
        generate(msgspec.structs.replace(TINY, camera="realsense"), tmp_path / "n", Executor(workers=0))


def test_unusable_object_is_remembered_and_stops_nothing(tmp_path, monkeypatch):
    from grasp_core.dataset import generate as module
    from grasp_core.errors import GraspError

    real = module.stable_poses

    def picky(asset, *rest, **options):
        if asset.name == "box_001":
            raise GraspError("it never comes to rest")
        return real(asset, *rest, **options)

    monkeypatch.setattr(module, "stable_poses", picky)
    summary = generate(TINY, tmp_path / "r", Executor(workers=0))
    assert summary.refused == {"box_001": "it never comes to rest"}
    assert summary.scenes > 0
    monkeypatch.undo()
    assert generate(TINY, tmp_path / "r", Executor(workers=0)).refused == summary.refused


def test_evidence_is_compact():
    text = evidence_json(Evidence(words="held", travel=(0.0123456789, 0.02)))
    assert text == '{"words":"held","lift":0.0,"travel":[0.012346,0.02]}'


DRIVER = """
import sys
from grasp_core.dataset.generate import generate
from grasp_core.dataset.recipe import load_recipe
from grasp_core.parallel import Executor
if __name__ == "__main__":
    say = lambda seen: print(seen.stage, seen.done, flush=True)
    generate(load_recipe(sys.argv[1]), sys.argv[2], Executor(workers=2), progress=say)
"""


def run_and_kill(script: Path, recipe: Path, path: Path, moment: float) -> tuple[bool, dict[str, int]]:
    """Run generation, kill it with SIGKILL `moment` seconds after its first word; was it killed, what it reported."""
    process = subprocess.Popen([sys.executable, str(script), str(recipe), str(path)], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    words = [process.stdout.readline()]
    timer = threading.Timer(moment, process.kill)
    timer.start()
    words += process.stdout.readlines()  # until its end
    timer.cancel()
    whole = [word.split() for word in words if word.endswith("\n")]
    return process.wait() == -signal.SIGKILL, {stage: int(done) for stage, done in whole}


@pytest.fixture
def tiny_file(tmp_path):
    file = tmp_path / "tiny.yaml"
    file.write_bytes(msgspec.yaml.encode(TINY))
    return file


def test_killed_run_ends_with_the_same_content(tiny, tiny_file, tmp_path):
    path, first, _ = tiny
    killed = tmp_path / "killed"
    command = [*CLI, "generate", "--recipe", str(tiny_file), "--out", str(killed)]
    process = subprocess.Popen([*command, "--workers", "1"], stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    images = killed / "depth"
    deadline = time.monotonic() + 120
    while process.poll() is None and not list(images.glob("*.png")) and time.monotonic() < deadline:
        time.sleep(0.005)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    with DatasetStore.open(killed) as store:
        stored = len(store.scenes())
    assert stored < first.scenes
    rest = generate(TINY, killed, Executor(workers=0))
    assert rest.before == stored
    assert digest(killed) == digest(path)
    with DatasetStore.open(killed, readonly=True) as store:
        assert verify(store) == []


@pytest.mark.slow
def test_killed_at_ten_random_moments_nothing_reported_is_lost(tiny, tiny_file, tmp_path):
    path, _, _ = tiny
    script, target = tmp_path / "driver.py", tmp_path / "k"
    script.write_text(DRIVER)
    start = time.monotonic()
    run_and_kill(script, tiny_file, tmp_path / "whole", 600)
    took = time.monotonic() - start
    rng = np.random.default_rng(0)
    kills, moments = 0, rng.uniform(0, took / 3, 60).tolist()
    while kills < 10 and moments:
        killed, reported = run_and_kill(script, tiny_file, target, moments.pop())
        kills += killed
        with DatasetStore.open(target, readonly=True) as store:
            assert len(store.objects()) >= reported.get("objects", 0)
            assert len(store.scenes()) >= reported.get("scenes", 0)
            assert all(row.grasps == 18 and store.depth(row.id).valid.any() for row in store.scenes())
        if not killed:  # it came to its end between two kills: begin another dataset
            assert digest(target) == digest(path)
            target = tmp_path / f"k{len(moments)}"
    assert kills == 10
    run_and_kill(script, tiny_file, target, 600)
    assert digest(target) == digest(path) == digest(tmp_path / "whole")
    with DatasetStore.open(target, readonly=True) as store:
        assert verify(store) == []
