import numpy as np
import trimesh

from grasp_core.objects.voxels import voxelize


def solid_at(voxels, *point):
    return bool(voxels.solid[tuple(((np.array(point) - voxels.origin) / voxels.cell).astype(int))])


def tube() -> trimesh.Trimesh:
    """An open side of a cylinder without thickness, radius 0.3 and height 1."""
    whole = trimesh.creation.cylinder(radius=0.3, height=1.0, sections=32)
    whole.update_faces(np.abs(whole.face_normals[:, 2]) < 0.5)
    return whole


def test_open_tube_is_hollow_and_its_sheet_solid():
    voxels = voxelize(tube(), 48)
    assert solid_at(voxels, 0.2999, 0, 0)
    assert not solid_at(voxels, 0, 0, 0) and not solid_at(voxels, 0, 0, 0.45)
    assert voxels.visible.all()


def test_closed_mesh_is_solid_whatever_its_winding_and_with_a_crack():
    box = trimesh.creation.box((1.0, 0.5, 0.4))
    box.faces[::2] = box.faces[::2, ::-1]
    assert solid_at(voxelize(box, 48), 0, 0, 0)
    low, high = np.array([-0.5, -0.25, 0.2]), np.array([0.5, 0.25, 0.2])
    opened = trimesh.creation.box((1.0, 0.5, 0.4))
    opened.update_faces(opened.face_normals[:, 2] < 0.5)
    lid = trimesh.Trimesh([low, [0.49, -0.25, 0.2], [0.49, 0.25, 0.2], [-0.5, high[1], 0.2]], [[0, 1, 2], [0, 2, 3]])
    assert solid_at(voxelize(trimesh.util.concatenate([opened, lid]), 48), 0, 0, 0)
    assert not solid_at(voxelize(opened, 48), 0, 0, 0)


def test_what_lies_inside_is_not_visible():
    shell = trimesh.creation.box((1.0, 1.0, 1.0))
    core = trimesh.creation.box((0.4, 0.4, 0.4))
    voxels = voxelize(trimesh.util.concatenate([shell, core]), 48)
    inner = np.abs(voxels.points).max(axis=1) < 0.21
    assert inner.any() and not voxels.visible[inner].any() and voxels.visible[~inner].all()


def test_same_mesh_gives_the_same_cells():
    first, second = voxelize(tube(), 32), voxelize(tube(), 32)
    assert np.array_equal(first.points, second.points) and np.array_equal(first.solid, second.solid)
