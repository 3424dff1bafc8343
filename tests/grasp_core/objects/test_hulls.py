import numpy as np
import pytest
import trimesh

from grasp_core.errors import MeshError
from grasp_core.objects.hulls import convex_part, mass_properties


def test_part_of_a_cylinder_is_closed_and_exact():
    cylinder = trimesh.creation.cylinder(radius=0.03, height=0.1, sections=12)
    part = convex_part(cylinder.vertices)
    assert len(part.vertices) == 24
    assert part.mesh.is_watertight
    assert part.mesh.volume == pytest.approx(cylinder.volume, rel=1e-9)


def test_fewer_vertices_keep_extent_and_most_of_the_volume():
    ball = trimesh.creation.icosphere(subdivisions=3, radius=0.04)
    part = convex_part(ball.vertices, 24)
    assert len(part.vertices) <= 24
    assert 0.8 * ball.volume < part.mesh.volume <= 1.001 * ball.volume
    assert np.linalg.norm(part.vertices, axis=1).max() <= 0.04 * 1.05


def test_every_vertex_is_used_by_a_face():
    grid = np.stack(np.meshgrid(*[np.linspace(0, 0.1, 4)] * 3), -1).reshape(-1, 3)
    part = convex_part(grid)
    assert len(part.vertices) == 8
    assert part.mesh.volume == pytest.approx(1e-3, rel=1e-9)


@pytest.mark.parametrize("points", [np.zeros((5, 3)), [[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [1, 0, 0], [np.inf, 1, 0]]])
def test_impossible_points_are_refused(points):
    with pytest.raises(MeshError):
        convex_part(np.asarray(points, float))


def test_mass_properties_do_not_depend_on_where_the_body_is():
    part = convex_part(trimesh.creation.icosphere(subdivisions=1, radius=0.05).vertices, 64)
    far = convex_part(part.vertices + 5.0, 64)
    near = mass_properties([part])
    away = mass_properties([far])
    assert away.volume == pytest.approx(near.volume, rel=1e-6)
    assert np.allclose(away.inertia, near.inertia, rtol=1e-6, atol=1e-15)
    assert np.allclose(away.centre - near.centre, 5.0)
