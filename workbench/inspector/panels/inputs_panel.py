"""The panel of own inputs: meshes, depth images and their cameras, folders."""

from __future__ import annotations

from grasp_core.errors import GraspError
from workbench.bridge import Bridge, Reader
from workbench.casting import put, text
from workbench.inspector import actions as a
from workbench.inspector.orders import Catalogue, Item, SceneRequest
from workbench.inspector.rules.files import photos
from workbench.inspector.setup import FIELDS, Choice
from workbench.inspector.shelf import KINDS, MOST
from workbench.inspector.state import State

MESH_UNITS = {"metres": "m", "millimetres": "mm", "centimetres": "cm", "any: longest side 10-20 cm": "paper"}
DEPTH_UNITS = {"metres (npy, float tiff)": 0.0, "millimetres": 0.001, "0.1 mm": 0.0001, "0.25 mm": 0.00025}
TYPED = "typed below"
_MOST_LISTED = 60


def _key(argument: str) -> str:
    if not 0 < len(argument) <= 60:
        raise ValueError(argument)
    return argument


READERS: dict[str, Reader] = {
    "file": lambda argument: a.UseFile(_key(argument)),
    "photo": lambda argument: a.NextPhoto(max(-1, min(1, int(argument)))),
}


def typed_intrinsics(words: str) -> tuple[float, float, float, float] | None:
    """`fx fy cx cy` as typed, or None where it is not that."""
    try:
        values = tuple(float(word) for word in words.replace(",", " ").split())
    except ValueError:
        return None
    if len(values) != 4 or not all(0 < value < 1e5 for value in values):
        return None
    return values


class InputsPanel:
    """Uploads, folders, and the list of what was opened."""

    def __init__(self, bridge: Bridge, catalogue: Catalogue, state: State) -> None:
        self._bridge = bridge
        self._shipped = FIELDS["camera"].options if isinstance(FIELDS["camera"], Choice) else ()
        self._items: tuple[Item, ...] = ()
        where = "Folders are read on the machine that runs the workbench." if catalogue.folders else "Folders are off."
        bridge.html('<div class="gw"><h3>Own object</h3></div>')
        self._unit = bridge.dropdown(
            "Mesh unit", tuple(MESH_UNITS), "metres", lambda label: a.MeshUnit(MESH_UNITS[label]), "What a number means"
        )
        bridge.upload(
            "Upload a mesh", KINDS["mesh"], MOST["mesh"],
            lambda name, content: a.OpenFile("mesh", name, content), ", ".join(KINDS["mesh"]),
        )  # fmt: skip
        bridge.field("Mesh folder", "", lambda folder: a.OpenFolder("mesh", folder), where)
        bridge.html('<div class="gw"><h3>Own depth image</h3></div>')
        self._scale = bridge.dropdown(
            "Depth unit",
            tuple(DEPTH_UNITS),
            next(iter(DEPTH_UNITS)),
            self._depth_unit,
            "What a number in the file means",
        )
        self._camera = bridge.dropdown(
            "Its camera",
            (*self._shipped, TYPED),
            state.photo.camera if state.photo.camera in self._shipped else TYPED,
            self._use_camera,
            "Intrinsics of the image",
        )
        self._typed = bridge.field(
            "fx fy cx cy", "", self._type, "Intrinsics in pixels, for example 525 525 319.5 239.5; then press Enter"
        )
        bridge.upload(
            "Upload a camera file", KINDS["camera"], MOST["camera"],
            lambda name, content: a.OpenFile("camera", name, content), "YAML: fx fy cx cy width height",
        )  # fmt: skip
        bridge.upload(
            "Upload a depth image", KINDS["image"], MOST["image"],
            lambda name, content: a.OpenFile("image", name, content), ", ".join(KINDS["image"]),
        )  # fmt: skip
        bridge.field("Image folder", "", lambda folder: a.OpenFolder("image", folder), where)
        self._list = bridge.html()
        self._photo = state.photo
        bridge.command("Next own image", "I", lambda: a.NextPhoto(1), "Of those that are open")
        bridge.command("Previous own image", "U", lambda: a.NextPhoto(-1), "Of those that are open")

    def _depth_unit(self, label: str) -> a.InspectorAction:
        return a.ReadPhotosWith(self._photo.camera, self._photo.typed, DEPTH_UNITS[label])

    def _use_camera(self, label: str) -> a.InspectorAction:
        if label == TYPED:
            return a.ReadPhotosWith("", typed_intrinsics(self._typed.value), self._photo.scale)
        key = next((item.key for item in self._items if item.kind == "camera" and item.name == label), label)
        return a.ReadPhotosWith(key, None, self._photo.scale)

    def _type(self, words: str) -> a.InspectorAction:
        values = typed_intrinsics(words)
        if values is None:
            raise GraspError(f"'{words[:40]}' is not fx fy cx cy: four numbers above 0, in pixels")
        return a.ReadPhotosWith("", values, self._photo.scale)

    def update(self, old: State | None, new: State) -> None:
        """Show `new`."""
        self._photo, self._items = new.photo, new.items
        put(self._unit, value=next(label for label, unit in MESH_UNITS.items() if unit == new.mesh_unit))
        cameras = tuple(dict.fromkeys(item.name for item in new.items if item.kind == "camera"))
        options = (*self._shipped, *cameras, TYPED)
        put(self._camera, options=options)
        own = next((item.name for item in new.items if item.key == new.photo.camera), new.photo.camera)
        put(self._camera, value=TYPED if new.photo.typed or own not in options else own)
        put(self._list, content=f'<div class="gw">{opened(new, self._bridge)}</div>')


def _keys(request: SceneRequest) -> set[str]:
    """The own files, and the catalogue's objects, of a scene."""
    return {request.photo.key if request.photo else "", *(thing.name for thing in request.things)}


def opened(state: State, bridge: Bridge) -> str:
    """Own files that can be shown, and stepping through images; HTML."""
    if not state.items:
        return '<div class="gw-empty">What you open is listed here. Nothing leaves this machine.</div>'
    wanted, shown = _keys(state.request), _keys(state.request)
    if state.failure is not None:
        shown = set() if state.scene is None else _keys(state.scene.request)
    rows = "".join(
        f'<div class="gw-item{" gw-held" if item.key in shown else ""}" title="{text(item.name)}" '
        f"{bridge.onclick(f'file:{item.key}')}><small>{item.kind}</small> {text(item.name)}"
        f"{'' if item.key not in wanted - shown else ' <small>· could not be used</small>'}</div>"
        for item in state.items[-_MOST_LISTED:]
        if item.kind != "camera"
    )
    images = photos(state)
    steps = ""
    if len(images) > 1:
        now = next((i + 1 for i, item in enumerate(images) if item.key == state.photo.key), 0)
        steps = (
            f'<div class="gw-bar gw-small">{bridge.button("‹ previous", "photo:-1", hint="previous image (U)")}'
            f'<small class="gw-grow">image {now} of {len(images)}</small>'
            f"{bridge.button('next ›', 'photo:1', hint='next image (I)')}</div>"
        )
    return f'<h3>Opened</h3>{steps}<div class="gw-items">{rows}</div>'
