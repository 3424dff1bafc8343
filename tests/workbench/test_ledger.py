import getpass
from dataclasses import replace

import msgspec
import numpy as np
import platformdirs
import pytest

from grasp_core.dataset.store import DatasetStore
from grasp_core.errors import GraspError, MismatchError
from grasp_core.gripper import load_gripper
from grasp_core.sensing.renderer import Renderer
from grasp_core.simulation.physics import load_physics
from workbench.inspector.orders import Choice, SceneRequest, Thing
from workbench.inspector.poses import vector
from workbench.inspector.setup import DEFAULT
from workbench.ledger import Ledger, default_dataset, person, scene_name


@pytest.fixture
def ledger(tmp_path):
    return Ledger(tmp_path / "verdicts", load_gripper(), load_physics())


def test_a_verdict_is_stored_with_scene_grasp_and_attempts(ledger, opened, attempt):
    ledger.check()
    assert not ledger.path.exists(), "nothing is made before the first verdict"
    event = ledger.record(opened, Choice(0, 1), "good", [attempt(n, recorded=False) for n in range(5)])
    with DatasetStore.open(ledger.path) as store:
        row = store.grasp(event.grasp)
        assert row.grasp == opened.candidates(0)[1].grasp
        assert (row.origin, row.label, row.source, row.attempts, row.successes) == ("planner", 1.0, "human", 5, 5)
        stored = store.history(event.grasp)[-1]
        assert stored.kind == "value" and stored.value == 1.0 and stored.person == person()
        assert stored.details["planner"] == "cascade" and stored.details["score"] == pytest.approx(0.6)
        assert np.abs(store.depth(row.scene).depth - Renderer(opened.scene).render().depth).max() < 1e-4
        assert store.scene(row.scene).objects[0].asset.name == "box_003"


def test_a_second_verdict_adds_an_event_and_no_attempt_twice(ledger, opened, attempt):
    tried = [attempt(n, recorded=False) for n in range(5)]
    first = ledger.record(opened, Choice(0, 0), "good", tried)
    second = ledger.record(opened, Choice(0, 0), "bad", tried)
    assert first.grasp == second.grasp and first.id < second.id
    with DatasetStore.open(ledger.path) as store:
        assert len(store.attempts(first.grasp)) == 5
        assert store.current(first.grasp).value == 0.0
        assert len(store.scenes()) == 1


def test_a_grasp_that_was_not_tried_can_be_judged(ledger, opened):
    event = ledger.record(opened, Choice(0, 2), "bad", [])
    with DatasetStore.open(ledger.path) as store:
        assert store.grasp(event.grasp).label == 0.0 and store.attempts(event.grasp) == []


def test_a_dataset_of_another_gripper_is_refused(ledger, opened):
    ledger.record(opened, Choice(0, 0), "good", [])
    other = msgspec.structs.replace(load_gripper(), force=99.0)
    with pytest.raises(MismatchError):
        Ledger(ledger.path, other, load_physics()).check()
    ledger.check()


def test_what_is_no_dataset_is_refused(tmp_path):
    (tmp_path / "dataset.sqlite").write_text("hello")
    with pytest.raises(GraspError):
        Ledger(tmp_path, load_gripper(), load_physics()).check()


def test_the_user_s_own_dataset_is_in_their_data_folder(monkeypatch, tmp_path, opened):
    monkeypatch.setattr(platformdirs, "user_data_dir", lambda name: str(tmp_path / name))
    gripper, physics = load_gripper(), load_physics()
    path = default_dataset(gripper, physics)
    assert path == tmp_path / "grasp-workbench" / "workbench"
    Ledger(path, gripper, physics).record(opened, Choice(0, 0), "good", [])
    assert default_dataset(gripper, physics) == path
    other = msgspec.structs.replace(gripper, force=99.0)
    assert default_dataset(other, physics).name == "workbench-2", "an update leaves the old one alone"


def test_there_is_always_a_name(monkeypatch):
    monkeypatch.setattr(getpass, "getuser", lambda: (_ for _ in ()).throw(OSError()))
    assert person() == "somebody"


def test_attempts_with_another_noise_are_not_pooled(ledger, make_scene, attempt):
    noisy = make_scene(setup=msgspec.structs.replace(DEFAULT, sigma_p=0.01))
    event = ledger.record(noisy, Choice(0, 0), "good", [attempt(0, recorded=False)])
    with DatasetStore.open(ledger.path) as store:
        assert store.attempts(event.grasp) == []


def test_grasps_of_another_gripper_are_refused(ledger, opened):
    with pytest.raises(MismatchError, match="gripper"):
        ledger.record(replace(opened, gripper=load_gripper("compact")), Choice(0, 0), "good", [])


def test_scenes_that_differ_have_names_of_their_own(opened):
    at = vector(opened.scene.objects[0].world_from_object)
    dragged = replace(opened, request=SceneRequest((Thing("box_003", 0, at),), 1))
    tilted = replace(opened, setup=msgspec.structs.replace(DEFAULT, tilt=10.0))
    names = [scene_name(scene) for scene in (opened, dragged, tilted)]
    assert names[0] == "workbench_box_003_0_1" and len(set(names)) == 3
    assert scene_name(dragged) == names[1]
