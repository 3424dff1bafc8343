from dataclasses import replace

from grasp_core.gripper import load_gripper
from workbench.inspector.panels.images_panel import ImagesPanel


def test_pictures_are_sent_with_a_new_scene_only(bridge, client, state, shown, opened):
    panel = ImagesPanel(bridge, load_gripper())
    panel.update(None, state)
    assert "come with the first plan" in client.page()
    panel.update(state, shown)
    assert client.page().count("data:image/png") == 2
    handle = next(made for made in client.made if made.kind == "html" and "data:image/png" in made.content)
    handle.content = "untouched"
    panel.update(shown, replace(shown, selected=2))
    assert handle.content == "untouched"
    panel.update(shown, replace(shown, scene=replace(opened)))
    assert "data:image/png" in handle.content
