import numpy as np
import pytest

from workbench import colours
from workbench.tabletop import Shadows, box_corners, furnish, outline, strips


@pytest.fixture
def shadows(client, bridge):
    return Shadows(bridge), next(h for h in client.made if h.label == "/shadows")


def body(client, place, visible=True, wxyz=(1.0, 0.0, 0.0, 0.0)):
    handle = client.scene.add_box(f"/{place}", dimensions=(1, 1, 1), visible=visible)
    handle.position, handle.wxyz, handle.visible = np.array(place, float), np.array(wxyz), visible
    return handle, [box_corners((0.1, 0.04, 0.02))]


def area(mesh):
    corners = np.asarray(mesh.vertices)[np.asarray(mesh.faces)][..., :2]
    (ax, ay), (bx, by) = (
        np.moveaxis(corners[:, 1] - corners[:, 0], -1, 0),
        np.moveaxis(corners[:, 2] - corners[:, 0], -1, 0),
    )
    return (ax * by - ay * bx) / 2


def test_what_stands_in_a_scene_casts_and_takes_no_shadow_maps(client, bridge):
    with bridge.section("/part"):
        grid = furnish(bridge)
    assert grid.label == "/part/grid"
    made = {handle.label: handle for handle in client.made}
    assert {"/part/light/sun", "/part/light/all", "/part/light/sky", "/part/table"} <= set(made)
    assert not made["/part/light/sun"].cast_shadow and np.any(made["/part/light/sun"].position)


def test_table_grid_and_shadows_follow_the_theme(client, bridge, shadows):
    grid, (_, shade) = furnish(bridge), shadows
    table = next(h for h in client.made if h.label == "/table")
    assert (table.color, grid.color, shade.color) == (colours.TABLE.dark, colours.GRID.dark, colours.SHADE.dark)
    bridge.theme(False)
    assert (table.color, grid.color, shade.color) == (colours.TABLE.light, colours.GRID.light, colours.SHADE.light)


def test_the_grid_has_a_line_every_five_centimetres():
    vertices, faces = strips()
    assert len(vertices) == 4 * 34 and len(faces) == 2 * 34 and faces.max() == len(vertices) - 1
    middles = np.unique(vertices.reshape(-1, 4, 3)[:17, :, 0].mean(axis=1).round(4))
    assert np.diff(middles) == pytest.approx(0.05, abs=1e-6)


def test_a_shadow_lies_below_what_is_low_and_away_from_what_is_high():
    low = outline(box_corners((0.1, 0.04, 0.0)))
    assert np.ptp(low, axis=0) == pytest.approx([0.1, 0.04], abs=1e-6)
    high = outline(box_corners((0.1, 0.04, 0.0)) + np.array([0, 0, 0.2]))
    assert high.mean(axis=0) - low.mean(axis=0) == pytest.approx([0.084, 0.06], abs=1e-6)


def test_shadows_end_at_the_table():
    assert np.abs(outline(box_corners((0.1, 0.1, 0.1)) + np.array([0.43, 0, 0.3]))).max() == pytest.approx(0.45)


def test_visible_bodies_cast_shadows_that_face_up(shadows, client):
    made, mesh = shadows
    made.cast([body(client, (0, 0, 0.0)), body(client, (0.2, 0, 0.0)), body(client, (0.1, 0, 0), visible=False)])
    assert mesh.visible
    assert (area(mesh) > 0).all() and area(mesh).sum() > 2 * 0.1 * 0.04
    made.cast([body(client, (0.1, 0, 0), visible=False)])
    assert not mesh.visible


def test_a_turned_body_turns_its_shadow(shadows, client):
    made, mesh = shadows
    half = np.sqrt(0.5)
    made.cast([body(client, (0, 0, 0), wxyz=(half, 0, 0, half))])
    assert np.ptp(np.asarray(mesh.vertices), axis=0)[:2] == pytest.approx([0.04, 0.1], abs=0.01)


def test_nothing_is_sent_where_nothing_moved(shadows, client):
    made, mesh = shadows
    bodies = [body(client, (0, 0, 0.1))]
    made.cast(bodies)
    sent = mesh.vertices
    made.cast(bodies)
    assert mesh.vertices is sent
    bodies[0][0].position = np.array([0.01, 0, 0.1])
    made.cast(bodies)
    assert mesh.vertices is not sent
