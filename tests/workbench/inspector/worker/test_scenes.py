from pathlib import Path

import msgspec
import numpy as np
import pytest
import trimesh

from grasp_core.errors import GraspError
from workbench.inspector.orders import SceneRequest, Thing
from workbench.inspector.poses import matrix, vector
from workbench.inspector.setup import DEFAULT
from workbench.inspector.worker import scenes
from workbench.inspector.worker.scenes import camera_of, file_of, give_back, make_scene, settle_scene

CAN = SceneRequest((Thing("can_000"),), 3)


def test_a_scene_follows_from_its_request():
    request, scene, rests = make_scene(CAN, DEFAULT, {})
    again = make_scene(CAN, DEFAULT, {})[1]
    assert np.array_equal(scene.objects[0].world_from_object, again.objects[0].world_from_object)
    assert request == CAN and rests[0].pose == 0 and 0 < rests[0].poses[0][1] <= 1
    assert scene.objects[0].vertices[:, 2].min() == pytest.approx(0, abs=1e-3), "it stands on the table"


def test_poses_wrap_round():
    many = msgspec.structs.replace(CAN, things=(Thing("can_000", 1000),))
    request, _, rests = make_scene(many, DEFAULT, {})
    assert request.things[0].pose == 1000 % len(rests[0].poses)


def test_several_objects_stand_apart():
    request = SceneRequest((Thing("can_000"), Thing("box_000"), Thing("can_001")), 5)
    _, scene, _ = make_scene(request, DEFAULT, {})
    hulls = [trimesh.Trimesh(p.vertices, p.asset.faces).convex_hull for p in scene.objects]
    for i, one in enumerate(hulls):
        for other in hulls[:i]:
            low = np.maximum(one.bounds[0], other.bounds[0])[:2]
            high = np.minimum(one.bounds[1], other.bounds[1])[:2]
            assert (low >= high).any() or not other.contains(one.vertices).any()


def test_objects_stay_where_they_were_dragged():
    at = (0.05, 0.02, 0.2, 1.0, 0.0, 0.0, 0.0)
    _, scene, rests = make_scene(SceneRequest((Thing("can_000", 0, at),)), DEFAULT, {})
    assert scene.objects[0].world_from_object == pytest.approx(matrix(at))
    upright = rests[0].poses[rests[0].pose][0]
    assert upright[2, 2] == pytest.approx(1, abs=1e-3), "slid and turned, it is in the same stable pose"
    tipped = (0.05, 0.02, 0.2, 0.92388, 0.38268, 0.0, 0.0)
    _, _, rests = make_scene(SceneRequest((Thing("can_000", 0, tipped),)), DEFAULT, {})
    assert rests[0].pose is None


def test_the_camera_follows_the_settings():
    camera = camera_of(msgspec.structs.replace(DEFAULT, camera="kinect", height=0.9, tilt=20))
    assert camera.pose[2, 3] == pytest.approx(0.9) and camera.intrinsics.width == 640
    assert np.degrees(np.arccos(-camera.pose[2, 2])) == pytest.approx(20)


def test_a_lifted_object_settles_on_the_table():
    _, scene, _ = make_scene(CAN, DEFAULT, {})
    pose = scene.objects[0].world_from_object.copy()
    pose[2, 3] += 0.03
    lifted = CAN.moved(0, Thing("can_000", 0, vector(pose), True))
    rested = settle_scene(lifted, DEFAULT, {})
    assert not rested.things[0].loose
    _, scene, _ = make_scene(rested, DEFAULT, {})
    assert scene.objects[0].vertices[:, 2].min() == pytest.approx(0, abs=2e-3)


def test_an_own_mesh_is_read_in_its_unit(tmp_path):
    path = tmp_path / "0123456789ab--brick.stl"
    trimesh.creation.box((120, 40, 60)).export(path)
    key = "mesh-0123-mm"
    _, scene, _ = make_scene(SceneRequest((Thing(key),)), DEFAULT, {key: str(path)})
    assert scene.objects[0].asset.name == "brick", "uploads are kept under their digest"
    assert sorted(scene.objects[0].asset.extents) == pytest.approx([0.04, 0.06, 0.12], abs=1e-3)
    with pytest.raises(GraspError, match=r"^brick\.stl: .* set another mesh unit$"):
        make_scene(SceneRequest((Thing("mesh-0123-m"),)), DEFAULT, {"mesh-0123-m": str(path)})


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="this system does not tell its memory")
def test_freed_memory_goes_back_to_the_system():
    def resident():
        return int(Path("/proc/self/statm").read_text().split()[1]) * 4096

    many = [bytes([number % 256]) * 3000 for number in range(20_000)]
    last = many[-1]  # above the others: the heap does not shrink by itself
    del many
    held = resident()
    give_back()
    assert resident() < held - 30e6 and len(last) == 3000


@pytest.mark.parametrize("name", ["mesh-ffff-m", "wishful_000", "can", "../../etc/passwd"])
def test_what_is_not_there_is_told(name):
    with pytest.raises(GraspError):
        make_scene(SceneRequest((Thing(name),)), DEFAULT, {})
    with pytest.raises(GraspError, match="no longer has"):
        file_of(name, {name: "/nowhere/at/all"})


def test_three_large_objects_always_fit_and_stay_clear_of_each_other():
    for seed in range(200):
        rng = np.random.default_rng(seed)
        taken = []
        for radius in rng.uniform(0.06, 0.14, 3):
            x, y, _ = scenes._spot(rng, radius, taken, False)
            assert max(abs(x), abs(y)) + radius < 0.45, "on the table"
            assert all(np.hypot(x - u, y - v) > radius + other for u, v, other in taken)
            taken.append((x, y, radius))
