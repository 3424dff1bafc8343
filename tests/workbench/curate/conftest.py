"""A small dataset on disk, and states of the curation that show it."""

from __future__ import annotations

import time

import numpy as np
import pytest
import trimesh

from grasp_core.camera import DepthImage, canonical_camera
from grasp_core.config import Settings
from grasp_core.dataset.content import SceneRecord
from grasp_core.dataset.rows import AttemptRow, StoredPose
from grasp_core.dataset.store import DatasetStore
from grasp_core.grasp import Grasp
from grasp_core.gripper import load_gripper
from grasp_core.objects.asset import ObjectAsset, Part
from grasp_core.planning.crops import DepthRule
from grasp_core.scene import Scene, place
from grasp_core.simulation.physics import load_physics
from grasp_core.simulation.recording import Recording
from workbench.curate import organising  # noqa: F401 (registers its rules)
from workbench.curate.desk import Desk
from workbench.curate.state import State
from workbench.curate.trying import Rules
from workbench.curate.values import Facts, Played, Shelf, Thumb


class Made(Settings):
    by: str = "test"


def box() -> ObjectAsset:
    mesh = trimesh.creation.box((0.06, 0.04, 0.05))
    part = Part(np.array(mesh.vertices, float), np.array(mesh.faces, np.int32))
    inertia = np.array(mesh.moment_inertia)
    return ObjectAsset("box_000", "box", part.vertices, part.faces, (part,), float(mesh.volume), inertia)


@pytest.fixture
def folder(tmp_path):
    """30 grasps on a box, turned in steps; the first, across its short side, succeeds."""
    asset, camera = box(), canonical_camera()
    pose = np.eye(4)
    pose[2, 3] = 0.025
    depth = np.full((300, 300), 0.7, np.float32)
    depth[126:174, 132:168] = 0.65
    grasps = [Grasp((0.002 * (k % 6), 0.0, 0.02), 0.1 * k, 0.1) for k in range(30)]
    outcomes = [["SUCCESS", "SUCCESS" if k < 3 else "MISSED"] for k in range(30)]
    attempts = [
        [AttemptRow(name, number, (*grasp.position, grasp.angle)) for number, name in enumerate(names)]
        for grasp, names in zip(grasps, outcomes, strict=True)
    ]
    physics = load_physics()
    with DatasetStore.create(
        tmp_path / "data", name="small", gripper=load_gripper(), physics=physics, recipe=Made()
    ) as store:
        store.add_object(asset, "train", [StoredPose(tuple(pose.reshape(-1).tolist()), 1.0)])
        scene = Scene.single(asset, place(pose, 0.0, 0.0, 0.0), camera)
        store.add_scene(
            SceneRecord("box_000-0", "box_000", 0, 0, scene, DepthImage.from_array(depth, camera), grasps, attempts)
        )
    return tmp_path / "data"


@pytest.fixture
def store(folder):
    with DatasetStore.open(folder) as opened:
        yield opened


@pytest.fixture
def desk(folder):
    made = Desk(folder, load_gripper())
    yield made
    made.close()


@pytest.fixture
def ask(desk):
    """Does an effect at the desk and gives all answers, in order."""

    def ask(effect):
        answers = []
        assert desk.perform(answers.append, effect)
        ended = time.monotonic() + 20
        done = []
        desk._thread.submit(done.append, True)
        while not done and time.monotonic() < ended:
            time.sleep(0.005)
        assert done, "the desk did not answer"
        return answers

    return ask


@pytest.fixture
def rules():
    return Rules(load_gripper(), DepthRule())


@pytest.fixture
def facts():
    return Facts("small", 30, ("box",), ("ann", "bob"), {}, "", (), (), ())


@pytest.fixture
def state(desk, facts, store):
    """Ann looks at sample 2 on the first page of three."""
    thumbs = tuple(Thumb(store.grasp(k), "box_000", "data:,") for k in (1, 2, 3))
    shelf = Shelf(thumbs, (3.0, 3), 30)
    sample = desk.sample(2)
    return State(person="ann", shelf=shelf, sample=sample, wanted=2, facts=facts)


@pytest.fixture
def played():
    count = 11
    poses = np.zeros((count, 2, 7), np.float32)
    poses[:, :, 3] = 1
    poses[:, :, 2] = np.linspace(0, 0.2, count)[:, None]
    recording = Recording(
        names=("object_0", "rod"),
        times=np.linspace(0, 2, count),
        phases=np.zeros(count, np.int8),
        poses=poses,
        fingers=np.zeros((count, 2), np.float32),
        contact_frames=np.zeros(0, np.int32),
        contact_points=np.zeros((0, 3), np.float32),
        contact_forces=np.zeros((0, 3), np.float32),
        contact_fingers=np.zeros(0, np.int8),
        contact_objects=np.zeros(0, np.int16),
        outcome="SUCCESS",
        words="held",
    )
    return Played(1, True, "SUCCESS", "held to the end", recording)


@pytest.fixture
def curation_bridge(client, posted):
    from workbench.bridge import Bridge
    from workbench.curate.view import READERS

    return Bridge(client, posted.append, READERS)
