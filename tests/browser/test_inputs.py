"""Own files: meshes, depth images with their cameras, folders, and what is refused."""

import numpy as np
import pytest
import trimesh

from grasp_core.camera import Camera, load_camera, look_down
from grasp_core.objects.library import catalogue
from grasp_core.scene import Scene, place
from grasp_core.sensing.renderer import render


@pytest.fixture(scope="module")
def images(tmp_path_factory):
    """A folder with two depth images of a box, a bare table, and one that is broken."""
    folder = tmp_path_factory.mktemp("images")
    camera = Camera(load_camera("primesense").intrinsics, look_down(0.7, tilt=0.1))
    asset = catalogue("box_000")
    rest = np.eye(4)
    rest[2, 3] = -asset.vertices[:, 2].min()
    for number, x in enumerate((0.0, 0.08)):
        depth = render(Scene.single(asset, place(rest, x, 0.0, 0.4), camera)).depth
        np.save(folder / f"{number}_box.npy", depth)
    np.save(folder / "2_millimetres.npy", (depth * 1000).astype(np.uint16))
    return folder


def upload(page, button, path):
    with page.raw.expect_file_chooser() as chooser:
        page.raw.get_by_role("button", name=button).click()
    chooser.value.set_files(path)


def test_own_images_are_planned_on_stepped_through_and_refused_in_words(page, images):
    raw = page.raw
    page.tab("Inputs")
    upload(page, "Upload a depth image", images / "0_box.npy")
    page.until("document.querySelector('.gw-facts').innerText.includes('640 × 480 px')")
    page.settled()
    assert raw.locator("svg.gw-depth g[data-candidate]").count() >= 1
    field = page.row("Image folder").locator("input").first
    field.fill(str(images))
    field.press("Enter")
    page.until("document.querySelectorAll('.gw-items .gw-item').length >= 4")
    page.settled()
    for _ in range(2):
        page.button("next ›").click()
        raw.wait_for_timeout(400)
        page.settled()
    page.until("document.querySelector('.gw-facts .gw-error')?.innerText.includes('set the unit to mm')")
    page.choose("Depth unit", "millimetres")
    page.until("!document.querySelector('.gw-facts .gw-error')")
    page.choose("Its camera", "kinect")
    page.until("location.search.includes('camera_of_image=kinect')")
    typed = page.row("fx fy cx cy").locator("input").first
    typed.fill("525 525 319.5 239.5")
    typed.press("Enter")
    page.until("location.search.includes('typed=525')")
    page.settled()
    assert raw.locator(".gw-facts .gw-error").count() == 0
    (images / "half.yaml").write_text("fy: 525\ncx: 319.5\ncy: 239.5\nwidth: 640\nheight: 480\n")
    upload(page, "Upload a camera file", images / "half.yaml")
    page.until("document.querySelector('.gw-facts .gw-error')?.innerText.startsWith('half.yaml')")
    raw.reload()
    page.until("document.querySelector('.gw-facts .gw-error')?.innerText.startsWith('half.yaml')")
    page.tab("Inputs")
    page.choose("Its camera", "primesense")
    page.until("!document.querySelector('.gw-facts .gw-error')")


def test_an_own_mesh_is_settled_planned_on_and_tried_and_its_name_is_text(page, tmp_path):
    path = tmp_path / "<img src=x onerror=window.hacked=1>.stl"
    trimesh.creation.box((120, 40, 60)).export(tmp_path / "plain.stl")
    path.write_bytes((tmp_path / "plain.stl").read_bytes())
    page.tab("Inputs")
    page.choose("Mesh unit", "millimetres")
    upload(page, "Upload a mesh", path)
    page.until("document.querySelector('.gw-facts').innerText.includes('120 ×')")
    page.settled()
    assert page.raw.locator(".gw-item", has_text="onerror=window.hacked").count() == 1
    assert page.raw.evaluate("window.hacked") is None
    page.tab("Grasps")
    page.rows().first.click()
    page.tried()


def test_too_large_and_wrong_files_are_refused(page, tmp_path):
    large, wrong = tmp_path / "large.yaml", tmp_path / "wrong.npy"
    large.write_bytes(b"#" * 200_000)
    wrong.write_bytes(b"no array")
    page.tab("Inputs")
    upload(page, "Upload a camera file", large)
    page.raw.get_by_text("It is larger than 0.1 MB").first.wait_for()
    upload(page, "Upload a depth image", wrong)
    page.until("document.querySelector('.gw-facts .gw-error')?.innerText.includes('is not a NumPy array')")
