from dataclasses import replace

import numpy as np
import pytest

from workbench.inspector.orders import Photo, SceneRequest
from workbench.inspector.scene3d.stage import Stage


@pytest.fixture
def stage(bridge, client):
    made = Stage(bridge)
    return made, {handle.label: handle for handle in client.made}


def test_layers_are_switched(stage, shown):
    part, nodes = stage
    part.update(None, shown)
    assert nodes["/grid"].visible and nodes["/camera"].visible
    assert not nodes["/frames/world"].visible and not nodes["/points"].visible
    part.update(shown, replace(shown, shown=frozenset({"frames"})))
    assert nodes["/frames/world"].visible and not nodes["/grid"].visible


def test_points_are_where_the_camera_measured(stage, shown):
    part, nodes = stage
    part.update(None, replace(shown, shown=frozenset({"points"})))
    points = nodes["/points"].points
    assert points.dtype == np.float32 and points[:, 2].max() == pytest.approx(0.06, abs=1e-3)


def test_an_own_image_shows_its_points_without_being_asked(stage, shown):
    part, nodes = stage
    part.update(None, replace(shown, shown=frozenset(), request=SceneRequest((), 1, Photo("image-1"))))
    assert nodes["/points"].visible and len(nodes["/points"].points) > 1000


def test_nothing_is_seen_before_the_first_plan(stage, state):
    part, nodes = stage
    part.update(None, state)
    assert not nodes["/camera"].visible
