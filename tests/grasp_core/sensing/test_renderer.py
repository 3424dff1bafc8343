import math

import numpy as np
import pytest
import trimesh

from grasp_core.camera import Camera, CameraIntrinsics, canonical_camera, look_down
from grasp_core.errors import GraspError
from grasp_core.objects.asset import ObjectAsset, Part
from grasp_core.scene import PlacedObject, Scene, place
from grasp_core.sensing import renderer
from grasp_core.sensing.renderer import Renderer, embree_caster, make_caster, render, trimesh_caster


def asset_of(mesh: trimesh.Trimesh, name: str = "shape") -> ObjectAsset:
    vertices, faces = np.asarray(mesh.vertices, float), np.asarray(mesh.faces, np.int32)
    return ObjectAsset(name, "test", vertices, faces, (Part(vertices, faces),), mesh.volume, np.eye(3))


def box(x: float, y: float, z: float) -> ObjectAsset:
    return asset_of(trimesh.creation.box(extents=[x, y, z]))


def lifted(z: float) -> np.ndarray:
    pose = np.eye(4)
    pose[2, 3] = z
    return pose


def test_a_box_seen_from_above_has_exact_depths_and_edges():
    image = render(Scene.single(box(0.10, 0.06, 0.04), lifted(0.02)))
    top, table = image.depth[149:151, 149:151], image.depth[0, 0]
    assert np.allclose(top, 0.66, atol=1e-6)
    assert table == pytest.approx(0.70, abs=1e-6)
    half_u, half_v = 525 * 0.05 / 0.66, 525 * 0.03 / 0.66
    v, u = np.nonzero(image.depth < 0.69)
    assert abs(np.abs(u - 149.5).max() - half_u) <= 1
    assert abs(np.abs(v - 149.5).max() - half_v) <= 1
    assert image.valid.all() and image.depth.dtype == np.float32


def test_no_ray_slips_through_the_edges_between_faces():
    # every edge of this grid of faces lies exactly under a row or column of pixels
    grid = trimesh.creation.box(extents=[0.2, 0.2, 0.02]).subdivide().subdivide().subdivide()
    camera = Camera(CameraIntrinsics(500, 500, 150, 150, 301, 301), look_down(0.52))
    image = render(Scene.single(asset_of(grid), lifted(0.01)), camera)
    inside = image.depth[60:241, 60:241]
    assert np.allclose(inside, 0.50, atol=1e-6)


@pytest.mark.parametrize("tilt", [0.0, 0.3, 0.9])
def test_points_of_a_tilted_view_lie_on_the_surfaces(tilt):
    sphere = asset_of(trimesh.creation.icosphere(subdivisions=4, radius=0.05))
    camera = canonical_camera().at(look_down(0.6, 0.02, -0.03, tilt))
    image = render(Scene.single(sphere, lifted(0.05)), camera)
    points = image.points()[image.valid]
    above = points[:, 2] > 1e-4
    assert above.sum() > 1000
    assert np.allclose(np.linalg.norm(points[above] - [0, 0, 0.05], axis=1), 0.05, atol=2e-4)
    assert np.abs(points[~above, 2]).max() < 1e-4


def test_a_ray_above_the_horizon_sees_nothing():
    camera = canonical_camera().at(look_down(0.5, tilt=math.radians(89)))
    image = render(Scene((), camera))
    assert not image.valid[0, 150] and image.valid[-1, 150]
    assert image.depth[0, 150] == 0


def test_the_nearer_of_two_objects_hides_the_other_and_the_table_hides_what_is_sunk():
    low, high = box(0.1, 0.1, 0.02), box(0.04, 0.04, 0.02)
    scene = Scene((PlacedObject(low, lifted(0.01)), PlacedObject(high, lifted(0.05))), canonical_camera())
    image = render(scene)
    assert image.depth[150, 150] == pytest.approx(0.64, abs=1e-6)
    assert image.depth[150, 150 + 25] == pytest.approx(0.68, abs=1e-6)
    sunk = render(Scene.single(low, lifted(-0.02)))
    assert np.allclose(sunk.depth, 0.70, atol=1e-6)


def test_a_renderer_follows_new_poses_and_cameras_like_a_fresh_one():
    asset = box(0.12, 0.05, 0.03)
    scene = Scene.single(asset, lifted(0.015))
    kept = Renderer(scene)
    pose = place(lifted(0.015), 0.05, -0.04, 0.7)
    camera = canonical_camera(200).at(look_down(0.8, tilt=0.2))
    moved = kept.render(camera, [pose])
    assert np.array_equal(moved.depth, render(scene.moved(0, pose), camera).depth)
    assert not np.array_equal(moved.depth, kept.render(camera).depth)
    assert np.array_equal(kept.render().depth, render(scene).depth)


def test_distortion_bends_the_view():
    distortion = (0.1, -0.05, 0.001, 0.002, 0.0)
    camera = Camera(CameraIntrinsics(300, 300, 99.5, 99.5, 200, 200, distortion), look_down(0.5))
    image = render(Scene.single(box(0.08, 0.08, 0.05), lifted(0.025)), camera)
    points = image.points()
    top = points[:, :, 2] > 0.049
    assert np.abs(points[top][:, :2]).max() == pytest.approx(0.04, abs=0.002)
    assert np.allclose(points[~top][:, 2], 0, atol=0.0501)


def test_an_object_out_of_sight_changes_nothing():
    assert np.array_equal(
        render(Scene.single(box(0.05, 0.05, 0.05), place(lifted(0.025), 3.0, 0.0, 0.0))).depth,
        render(Scene((), canonical_camera())).depth,
    )


def test_a_camera_without_pose_is_refused():
    with pytest.raises(GraspError, match="no pose"):
        render(Scene((), Camera(canonical_camera().intrinsics)))


def test_the_fallback_agrees_with_embree(monkeypatch):
    pytest.importorskip("rtree", reason="trimesh's ray tracer needs rtree")
    pytest.importorskip("embreex", reason="no Embree on this machine")
    mesh = trimesh.creation.icosphere(subdivisions=2, radius=0.06)
    scene = Scene.single(asset_of(mesh), lifted(0.06), canonical_camera(60).at(look_down(0.3)))
    exact = render(scene)

    def missing(vertices, faces):
        raise ImportError

    monkeypatch.setattr(renderer, "embree_caster", missing)
    slow = render(scene)
    assert np.allclose(slow.depth, exact.depth, atol=1e-5)
    assert (exact.depth < 0.25).sum() > 100


def test_casters_report_misses_as_infinite():
    mesh = trimesh.creation.box(extents=[1, 1, 1])
    rays = np.array([[0, 0, -1], [0, 0, 1]], np.float32)
    for make in (embree_caster, trimesh_caster):
        pytest.importorskip("rtree" if make is trimesh_caster else "embreex")
        distances = make(mesh.vertices, mesh.faces)(np.array([0.1, 0.2, 2.0], np.float32), rays)
        assert distances[0] == pytest.approx(1.5, abs=1e-5) and np.isinf(distances[1])
    assert make_caster(box(1, 1, 1))(np.array([0.1, 0.2, 2.0], np.float32), rays)[0] == pytest.approx(1.5, abs=1e-5)
