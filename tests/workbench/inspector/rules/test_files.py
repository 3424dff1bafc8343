from dataclasses import replace

from workbench.inspector import actions as a
from workbench.inspector import answers as r
from workbench.inspector import effects as e
from workbench.inspector.orders import Item, Photo, SceneRequest, Thing
from workbench.inspector.rules import reduce
from workbench.inspector.rules.files import MOST_ITEMS, photos


def run(state, *steps):
    effects = []
    for step in steps:
        state, more = reduce(state, step)
        effects += more
    return state, effects


def image(number):
    return Item(f"image-{number}", f"{number}.npy", "image", "")


def test_uploads_and_folders_are_work_for_others(shown):
    _, effects = run(shown, a.MeshUnit("mm"), a.OpenFile("mesh", "a.stl", b"x"), a.OpenFolder("image", "/data"))
    assert effects == [e.KeepFile("mesh", "a.stl", b"x", "mm"), e.ReadFolder("image", "/data", "mm")]
    assert run(shown, a.OpenFolder("image", "")) == (shown, [])


def test_folders_are_off_where_others_can_connect(shown):
    shared = replace(shown, catalogue=replace(shown.catalogue, folders=False))
    _, effects = run(shared, a.OpenFolder("image", "/data"))
    assert effects[0].title == "Folders are off"


def test_an_own_mesh_is_shown(shown):
    state, effects = run(shown, r.FilesKept((Item("mesh-1-m", "a.stl", "mesh", ""),)))
    assert state.request.things == (Thing("mesh-1-m"),) and isinstance(effects[0], e.OpenScene)


def test_own_images_are_shown_and_stepped_through(shown):
    state, _ = run(shown, r.FilesKept((image(1), image(2), image(3))))
    assert state.request.photo == Photo("image-1", "primesense") and next(i.name for i in photos(state)) == "1.npy"
    keys = []
    for by in (1, 1, 1, -1):
        state, _ = run(state, a.NextPhoto(by))
        keys.append(state.request.photo.key)
    assert keys == ["image-2", "image-3", "image-1", "image-3"]
    assert run(shown, a.NextPhoto(1))[1][0].title == "No own images"


def test_cameras_and_units_apply_to_the_image_that_is_shown(shown):
    state, _ = run(shown, a.ReadPhotosWith("kinect", None, 0.001))
    assert state.photo == Photo("", "kinect", None, 0.001) and state.request == shown.request
    state, _ = run(state, r.FilesKept((image(1),)), a.ReadPhotosWith("", (500.0, 500.0, 320.0, 240.0), 0.0))
    assert state.request.photo == Photo("image-1", "", (500.0, 500.0, 320.0, 240.0))
    kept = r.FilesKept((Item("camera-1", "cam.yaml", "camera", ""),))
    assert run(shown, kept)[1] == [e.CheckCamera("camera-1")], "no image needs it yet: it is read nevertheless"
    state, _ = run(state, kept)
    assert state.request.photo == Photo("image-1", "camera-1")


def test_the_list_of_files_is_bounded_and_unknown_keys_are_ignored(shown):
    state, _ = run(shown, r.FilesKept(tuple(image(n) for n in range(MOST_ITEMS + 10))))
    assert len(state.items) == MOST_ITEMS
    assert run(shown, a.UseFile("image-7")) == (shown, [])
    assert run(state, a.UseFile("image-700"))[0].request == SceneRequest((), 1, Photo("image-700", "primesense"))
