"""Rules of own files: meshes, depth images and their cameras."""

from __future__ import annotations

from dataclasses import replace

import msgspec

from workbench.actions import Notice
from workbench.inspector import actions as a
from workbench.inspector import answers as r
from workbench.inspector import effects as e
from workbench.inspector.orders import Item, Photo, SceneRequest, Thing
from workbench.inspector.rules.registry import Result, rule
from workbench.inspector.rules.scene import want
from workbench.inspector.state import State

MOST_ITEMS = 1000
"""Own files that one browser keeps in sight."""


@rule(a.OpenFile)
def _open_file(action: a.OpenFile, state: State) -> Result:
    return state, (e.KeepFile(action.kind, action.name, action.content, state.mesh_unit),)


@rule(a.OpenFolder)
def _open_folder(action: a.OpenFolder, state: State) -> Result:
    if not action.folder:
        return state, ()
    if not state.catalogue.folders:
        why = "Folders can be named only where browser and workbench run on one machine (127.0.0.1). Upload files."
        return state, (Notice("warning", "Folders are off", why),)
    return state, (e.ReadFolder(action.kind, action.folder, state.mesh_unit),)


@rule(a.MeshUnit)
def _mesh_unit(action: a.MeshUnit, state: State) -> Result:
    return replace(state, mesh_unit=action.unit), ()


@rule(r.FilesKept)
def _kept(action: r.FilesKept, state: State) -> Result:
    new = {item.key: item for item in (*state.items, *action.items)}
    state = replace(state, items=tuple(new.values())[-MOST_ITEMS:])
    return use(state, action.items[0]) if action.items else (state, ())


@rule(a.UseFile)
def _use_file(action: a.UseFile, state: State) -> Result:
    found = next((item for item in state.items if item.key == action.key), None)
    return (state, ()) if found is None else use(state, found)


def use(state: State, item: Item) -> Result:
    """Show an own mesh or image, or read images with an own camera."""
    if item.kind == "mesh":
        return want(replace(state, grabbed=0), SceneRequest((Thing(item.key),), state.request.place))
    if item.kind == "camera":
        state, effects = _with(state, msgspec.structs.replace(state.photo, camera=item.key, typed=None))
        return state, effects or (e.CheckCamera(item.key),)
    photo = msgspec.structs.replace(state.photo, key=item.key)
    return want(replace(state, photo=photo, grabbed=0), SceneRequest((), state.request.place, photo))


def photos(state: State) -> tuple[Item, ...]:
    """Own images that are open."""
    return tuple(item for item in state.items if item.kind == "image")


@rule(a.NextPhoto)
def _next_photo(action: a.NextPhoto, state: State) -> Result:
    open_ones = photos(state)
    if not open_ones:
        return state, (Notice("info", "No own images", "Upload one or open a folder under Inputs."),)
    keys = [item.key for item in open_ones]
    now = keys.index(state.photo.key) if state.photo.key in keys else -1
    return use(state, open_ones[(now + action.by) % len(open_ones)])


@rule(a.ReadPhotosWith)
def _read_with(action: a.ReadPhotosWith, state: State) -> Result:
    photo = Photo(state.photo.key, action.camera, action.typed, action.scale)
    return _with(state, photo)


def _with(state: State, photo: Photo) -> Result:
    state = replace(state, photo=photo)
    if state.request.photo is None:
        return state, ()
    return want(state, SceneRequest((), state.request.place, photo))
