import numpy as np
import pytest
import trimesh

from grasp_core.objects.decomposition import build_asset
from grasp_core.simulation.object_body import ObjectBody, support_points


@pytest.fixture(scope="module")
def ball():
    mesh = trimesh.creation.icosphere(3, 0.03)
    return build_asset("ball", "ball", mesh, parts=[np.asarray(mesh.vertices)], max_vertices=400)


def test_small_hulls_keep_every_vertex(shapes):
    box = shapes.box(0.04, 0.06, 0.08)
    assert len(support_points(box, 40)) == 8


def test_points_span_the_hull(ball):
    points = support_points(ball, 40)
    directions = np.random.default_rng(0).normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    missing = (ball.hull.vertices @ directions.T).max(axis=0) - (points @ directions.T).max(axis=0)
    assert len(points) <= 40
    assert missing.max() < 0.003


def test_a_pose_stands_on_its_own_vertices(shapes):
    can = shapes.can()
    pose = shapes.standing(can)
    points = support_points(can, 20, pose)
    heights = points @ pose[2, :3] + pose[2, 3]
    soles = points[heights < 1e-6]
    assert len(points) <= 20
    assert len(soles) == 8
    # The eight stand all around the rim: the support polygon loses little.
    angles = np.sort(np.arctan2(soles[:, 1], soles[:, 0]))
    assert np.diff(np.append(angles, angles[0] + 2 * np.pi)).max() < np.radians(65)


def test_body_has_the_assets_mass_and_inertia(physics, shapes):
    asset = shapes.mug()
    body = ObjectBody(asset, 3, physics, support_points(asset, 10), parts=True)
    assert body.body.getNumShapeNodes() == len(asset.parts)
    assert body.feet.getNumShapeNodes() == 10
    assert body.body.getMass() == pytest.approx(physics.mass(asset))
    inertia = np.array(body.body.getInertia().getMoment())
    assert np.allclose(inertia, asset.unit_inertia * physics.mass(asset) / asset.volume, rtol=1e-9)


def test_place_and_pose_round_trip(physics, shapes):
    asset = shapes.box(0.04, 0.06, 0.08)
    body = ObjectBody(asset, 0, physics, support_points(asset, 8), parts=False)
    pose = np.eye(4)
    pose[:3, :3] = trimesh.transformations.euler_matrix(2.9, -0.4, 1.2)[:3, :3]
    pose[:3, 3] = [0.1, -0.2, 0.3]
    body.place(pose)
    assert np.allclose(body.pose, pose, atol=1e-12)
    assert body.speed == (0.0, 0.0)
