import numpy as np
import pytest

from workbench.inspector.scene3d import Scene3d


@pytest.fixture
def nodes(bridge, client, shown):
    with bridge.section("/inspect"):
        scene = Scene3d(bridge)
    scene.update(None, shown)
    return {handle.label: handle for handle in client.made if str(handle.label).startswith("/inspect")}


def test_all_nodes_hang_from_the_section(nodes):
    for name in ("/table", "/grid", "/camera", "/objects/0", "/gripper/rod", "/candidates", "/gizmo", "/contacts"):
        assert f"/inspect{name}" in nodes


def test_the_object_stands_where_the_scene_has_it(nodes, shown):
    place = shown.scene.scene.objects[0].world_from_object[:3, 3]
    assert np.allclose(nodes["/inspect/objects/0"].position, place) and nodes["/inspect/objects/0"].visible
    assert not nodes["/inspect/objects/1"].visible and not nodes["/inspect/compared/objects/0"].visible
