import numpy as np
import pytest
import trimesh
import viser
import yourdfpy
from viser.extras import ViserUrdf

from grasp_core.errors import MeshError
from grasp_core.objects.library import load_object
from grasp_core.objects.parametric import make
from grasp_core.objects.urdf import read_urdf, write_urdf


def urdf(folder, links, joints=""):
    file = folder / "thing.urdf"
    file.write_text(f"<robot name='thing'>{links}{joints}</robot>")
    return file


BOX = "<link name='a'><collision><geometry><box size='0.1 0.02 0.02'/></geometry></collision></link>"


def test_export_opens_in_yourdfpy_with_parts_mass_and_inertia(tmp_path):
    asset = make("mug", 2)
    file = str(write_urdf(asset, tmp_path))
    robot = yourdfpy.URDF.load(file, load_collision_meshes=True, build_collision_scene_graph=True)
    link = robot.link_map["mug_002"]
    assert len(link.collisions) == len(asset.parts)
    loaded = sum(len(one.faces) for one in robot.collision_scene.geometry.values())
    assert loaded == sum(len(part.faces) for part in asset.parts)
    mass = link.inertial.mass
    assert mass == pytest.approx(asset.volume * 500)
    assert np.allclose(link.inertial.inertia, asset.unit_inertia * 500, rtol=1e-6)
    assert np.allclose(robot.scene.extents, asset.extents, atol=1e-6)


def test_export_opens_in_viser(tmp_path):
    asset = make("cup", 0)
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    try:
        shown = ViserUrdf(server, write_urdf(asset, tmp_path), load_collision_meshes=True)
        shown.show_collision = True
        assert shown.get_actuated_joint_limits() == {}
        assert [mesh.name.split("/")[1] for mesh in shown._meshes] == ["visual", "collision"]
    finally:
        server.stop()


def test_import_of_an_export_is_the_same_object(tmp_path):
    asset = make("banana", 1)
    again = load_object(write_urdf(asset, tmp_path, mass=0.123))
    assert again.mass == pytest.approx(0.123)
    assert len(again.parts) == len(asset.parts)
    assert again.volume == pytest.approx(asset.volume, rel=1e-4)
    assert np.allclose(again.unit_inertia, asset.unit_inertia, rtol=1e-3, atol=1e-12)
    assert again.decomposition.startswith("exact")


def test_scale_origin_and_joints_are_applied(tmp_path):
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "unit.obj")
    links = BOX + (
        "<link name='b'><inertial><mass value='0.2'/></inertial><collision><origin xyz='0 0 0.01'/>"
        "<geometry><mesh filename='unit.obj' scale='0.02 0.02 0.06'/></geometry></collision></link>"
    )
    joint = (
        "<joint name='j' type='revolute'><parent link='a'/><child link='b'/>"
        "<origin xyz='0.04 0 0.03' rpy='0 0 1.5708'/></joint>"
    )
    found = read_urdf(urdf(tmp_path, links, joint))
    assert np.allclose(found.mesh.bounds, [[-0.05, -0.01, -0.01], [0.05, 0.01, 0.07]], atol=1e-5)
    assert found.mass == 0.2 and len(found.parts) == 2
    assert found.notes == "movable joints frozen at zero: j"


def test_spheres_cylinders_and_packages(tmp_path):
    (tmp_path / "pkg" / "meshes").mkdir(parents=True)
    (tmp_path / "pkg" / "urdf").mkdir()
    trimesh.creation.box((0.1, 0.1, 0.1)).export(tmp_path / "pkg" / "meshes" / "b.stl")
    shapes = ["<sphere radius='0.05'/>", "<cylinder radius='0.02' length='0.2'/>"]
    shapes.append("<mesh filename='package://pkg/meshes/b.stl'/>")
    inside = "".join(f"<collision><geometry>{shape}</geometry></collision>" for shape in shapes)
    found = read_urdf(urdf(tmp_path / "pkg" / "urdf", f"<link name='a'>{inside}</link>"))
    assert len(found.parts) == 3
    assert np.allclose(found.mesh.extents, [0.1, 0.1, 0.2], atol=1e-6)


@pytest.mark.parametrize(
    ("links", "joints", "says"),
    [
        ("<link name='a'/>", "", "neither visual nor collision"),
        ("", "", "at least one <link>"),
        (BOX.replace("0.1 0.02 0.02", "0.1 0.02"), "", "box size must be 3 number"),
        (BOX.replace("<box size='0.1 0.02 0.02'/>", "<mesh filename='no.obj'/>"), "", "'no.obj' is not there"),
        (BOX.replace("box", "capsule"), "", "has no mesh, box, cylinder or sphere"),
        (BOX, "<joint name='j' type='fixed'><parent link='b'/><child link='a'/></joint>", "leads? to link 'b'"),
        (BOX.replace("<collision>", "<inertial><mass value='-1'/></inertial><collision>"), "", "above 0"),
    ],
)
def test_bad_urdfs_are_refused_by_name(tmp_path, links, joints, says):
    file = urdf(tmp_path, links, joints)
    with pytest.raises(MeshError, match=says) as caught:
        read_urdf(file)
    assert "thing.urdf" in str(caught.value)


def test_broken_xml_is_refused(tmp_path):
    (tmp_path / "x.urdf").write_text("<robot><link></robot>")
    with pytest.raises(MeshError, match="is no XML"):
        read_urdf(tmp_path / "x.urdf")
