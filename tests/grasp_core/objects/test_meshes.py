import numpy as np
import pytest
import trimesh

from grasp_core.errors import MeshError
from grasp_core.objects.meshes import outward, read_mesh, thinned, united


@pytest.mark.parametrize("ending", ["off", "obj", "stl", "ply", "glb", "gltf"])
def test_every_format_reads_the_same_box(tmp_path, ending):
    file = tmp_path / f"box.{ending}"
    trimesh.creation.box((0.1, 0.05, 0.02)).export(file)
    if ending == "gltf":
        file = next(tmp_path.glob("*.gltf"))
    mesh = read_mesh(file)
    assert np.allclose(mesh.extents, [0.1, 0.05, 0.02])
    assert len(mesh.vertices) == 8 and mesh.is_watertight
    assert mesh.volume == pytest.approx(1e-4)


def test_scenes_of_several_moved_meshes_become_one(tmp_path):
    scene = trimesh.Scene()
    scene.add_geometry(trimesh.creation.box((1, 1, 1)))
    scene.add_geometry(trimesh.creation.box((1, 1, 1)), transform=trimesh.transformations.translation_matrix((3, 0, 0)))
    scene.export(tmp_path / "two.glb")
    assert np.allclose(read_mesh(tmp_path / "two.glb").extents, [4, 1, 1])


def test_inside_out_bodies_are_turned():
    mesh = trimesh.creation.box((1, 1, 1))
    mesh.invert()
    other = trimesh.creation.box((1, 1, 1)).apply_translation((3, 0, 0))
    assert outward(trimesh.util.concatenate([mesh, other])).volume == pytest.approx(2)


def test_huge_meshes_are_thinned_but_keep_their_shape():
    ball = trimesh.creation.icosphere(subdivisions=5)
    thin = thinned(ball, 3000)
    assert 500 < len(thin.faces) <= 3000
    assert np.allclose(thin.extents, 2, atol=0.06)


def test_overlapping_bodies_unite_and_open_ones_stay():
    a, b = trimesh.creation.box((1, 1, 1)), trimesh.creation.box((1, 1, 1)).apply_translation((0.5, 0.2, 0.1))
    both = trimesh.util.concatenate([a, b])
    one = united(both)
    assert one.is_watertight and one.volume == pytest.approx(2 - 0.5 * 0.8 * 0.9)
    both.update_faces(np.arange(len(both.faces)) > 6)
    assert united(both) is both


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("a.xyz", "0 0 0", "meshes are read from .off"),
        ("a.obj", "", "is empty"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "no triangles|no readable"),
        ("a.glb", "not a glb at all", "no readable GLB"),
        ("a.ply", "ply\nformat ascii 1.0\nelement vertex 5\n", "no readable PLY"),
        ("a.stl", "solid a\nfacet", "no readable STL|no triangles"),
        ("a.off", "OFF\n3 1 0\n0 0 0\n0 0 0\n0 0 0\n3 0 1 2\n", "degenerate"),
    ],
)
def test_bad_files_are_refused_by_name(tmp_path, name, content, says):
    (tmp_path / name).write_text(content)
    with pytest.raises(MeshError, match=says) as caught:
        read_mesh(tmp_path / name)
    assert str(tmp_path / name) in str(caught.value)


def test_missing_file_is_named(tmp_path):
    with pytest.raises(MeshError, match=r"nothing\.obj: no such file"):
        read_mesh(tmp_path / "nothing.obj")
