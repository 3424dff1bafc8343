"""A replay as one HTML file that opens anywhere: viser's own player with everything inside."""

from __future__ import annotations

import html
import re
from typing import Any

import numpy as np
from viser.transforms import SO3

from grasp_core.gripper import load_gripper
from grasp_core.scene import Scene
from workbench import colours
from workbench.casting import plain
from workbench.inspector.drawing import force_lines, shaded
from workbench.inspector.orders import Try
from workbench.inspector.setup import Setup
from workbench.serving import serve

RATE = 30
"""Frames a second."""


def replay_page(scene: Scene, setup: Setup, attempt: Try, title: str) -> bytes:
    """One recorded attempt as a page.

    Args:
        scene: that it was made in.
        setup: whose gripper made it.
        attempt: with its recording.
        title: of the page, for people.
    """
    recording = attempt.recording
    assert recording is not None
    gripper = load_gripper(setup.gripper)
    server, _ = serve(port=0)  # viser writes pages of what a server shows; nobody is told its address
    try:
        nodes: dict[str, Any] = {}
        stage = server.scene
        stage.set_up_direction("+z")
        stage.configure_default_lights(cast_shadow=False)
        stage.add_box("/table", color=colours.TABLE.dark, dimensions=(0.9, 0.9, 0.02), position=(0, 0, -0.0105))
        for number, placed in enumerate(scene.objects):
            vertices, faces = shaded(placed.asset.mesh)
            nodes[f"object_{number}"] = stage.add_mesh_simple(
                f"/object_{number}", vertices, faces, color=colours.OBJECT, side="double"
            )
        for name, (box, _) in gripper.boxes().items():
            colour = colours.FINGER if "finger" in name else colours.FRAME
            nodes[name] = stage.add_box(f"/{name}", color=colour, dimensions=plain(box.size))
        lines = stage.add_line_segments(
            "/forces", points=np.zeros((1, 2, 3), np.float32), colors=colours.FORCE, thickness=0.0016, visible=False
        )
        start = np.asarray(scene.objects[0].world_from_object[:3, 3], float)
        server.initial_camera.position = plain(tuple(start + np.array([0.35, -0.6, 0.45])))
        server.initial_camera.look_at = plain(tuple(start + np.array([0.0, 0.0, 0.12])))
        recorder = server.get_scene_serializer()
        times = np.asarray(recording.times, float) - float(recording.times[0])
        for now in np.arange(0.0, times[-1] + 1e-9, 1 / RATE):
            frame = int(np.clip(np.searchsorted(times, now), 0, len(times) - 1))
            for body, name in enumerate(recording.names):
                x, y, z, w, i, j, k = (float(value) for value in recording.poses[frame, body])
                nodes[name].position = (x, y, z)
                nodes[name].wxyz = plain(tuple(SO3(np.array([w, i, j, k])).normalize().wxyz))
            points = force_lines(recording, frame)
            lines.visible = points is not None
            if points is not None:
                lines.points = points
            recorder.insert_sleep(1 / RATE)
        page = recorder.as_html(dark_mode=True)
    finally:
        server.stop()
    return _captioned(page, title, attempt).encode()


def _captioned(page: str, title: str, attempt: Try) -> str:
    said = html.escape(f"{attempt.outcome}: {attempt.words}")
    name = html.escape(title)
    colour = colours.css(colours.OUTCOMES.get(attempt.outcome, (150, 150, 150)))
    caption = (
        f'<div style="position:fixed;left:12px;top:12px;z-index:1000;max-width:46ch;padding:8px 12px;color:#dfe6ee;'
        f"background:rgba(20,24,28,.85);border-left:4px solid {colour};border-radius:4px;"
        f'font:14px/1.4 system-ui,sans-serif"><b>{name}</b><br>{said}</div>'
    )
    head, _, body = page.partition("<body>")
    head = re.sub(r"<title>.*?</title>", "", head, flags=re.DOTALL)
    return f"{head}<title>{name}</title><body>{caption}{body}" if body else page + caption
