import numpy as np
import pytest

from grasp_core.config import convert
from grasp_core.errors import ConfigError, ImageError
from grasp_core.planning.crops import surface_map
from grasp_core.planning.view import TableView, ViewSettings, look

SETTINGS = ViewSettings()


def places(view: TableView) -> np.ndarray:
    """Places on the whole canvas."""
    whole = np.zeros(view.rectified.seen.shape, bool)
    whole[view.rows, view.columns] = view.places
    return whole


def test_places_are_what_stands_above_the_table(photo, make_box):
    _, view = look(photo(make_box(0.05, -0.04)), None, SETTINGS)
    assert isinstance(view, TableView)
    raised = view.rectified.image.depth < 0.692
    assert np.array_equal(places(view), raised)
    points = view.rectified.image.points()[places(view)]
    assert np.allclose(points.mean(axis=0), [0.05, -0.04, 0.05], atol=0.003)


def test_the_window_holds_all_places_with_a_margin_and_its_camera_fits(photo, make_box):
    _, view = look(photo(make_box(0.05, -0.04), make_box(-0.15, 0.1)), None, SETTINGS)
    assert places(view).sum() == view.places.sum()
    rows, columns = np.nonzero(view.places)
    height, width = view.places.shape
    assert rows.min() >= 90 and columns.min() >= 90 and rows.max() < height - 90 and columns.max() < width - 90
    u, v = columns[7], rows[7]
    whole = view.rectified.image.camera.deproject([u + view.columns.start, v + view.rows.start], 0.6)
    assert np.allclose(view.camera.deproject([u, v], 0.6), whole)
    assert np.array_equal(view.surface, surface_map(view.depth))


def test_the_core_holds_the_places_with_what_the_network_sees_around_them(photo, make_box):
    _, view = look(photo(make_box(0.05, -0.04)), None, SETTINGS)
    rows, columns = view.core
    inside = view.places[rows, columns]
    assert inside.sum() == view.places.sum() and inside.shape < view.places.shape
    assert inside.shape[0] % 36 == 0 and inside.shape[1] % 36 == 0
    v, u = np.nonzero(inside)
    assert min(v.min(), u.min(), inside.shape[0] - 1 - v.max(), inside.shape[1] - 1 - u.max()) >= 47


def test_a_small_thing_gets_a_window_of_the_training_size(photo, make_box):
    _, view = look(photo(make_box(0.0, 0.0, (0.03, 0.03, 0.03))), None, SETTINGS)
    assert view.places.shape == (300, 300)


@pytest.mark.parametrize("masked", [False, True])
def test_the_canonical_camera_stands_over_what_can_be_grasped(photo, make_box, masked):
    here, there = make_box(0.15, 0.1, (0.06, 0.06, 0.10)), make_box(-0.15, 0.1, (0.06, 0.06, 0.04))
    image = photo(here, there)
    mask = None
    if masked:
        mask = image.points()[..., 0] > 0
    _, view = look(image, mask, ViewSettings())
    assert view.camera.pose[:2, 3] == pytest.approx([0.15 if masked else 0.0, 0.1], abs=0.004)


def test_an_empty_table_has_a_reason(photo):
    rectified, reason = look(photo(), None, SETTINGS)
    assert reason == "no object above the table: nothing seen stands more than 8 mm above it"
    assert rectified.seen.all()


def test_a_flat_thing_is_nothing_to_grasp_unless_the_settings_say_so(photo, make_box):
    image = photo(make_box(0, 0, (0.1, 0.05, 0.006)))
    assert isinstance(look(image, None, SETTINGS)[1], str)
    assert isinstance(look(image, None, ViewSettings(least_height=0.004))[1], TableView)


def test_things_that_the_image_cuts_off_are_left_out_unless_there_is_nothing_else(photo, make_box):
    cut, whole = make_box(-0.42, 0.0, (0.1, 0.1, 0.06)), make_box(0.1, 0.05)
    _, view = look(photo(cut, whole), None, SETTINGS)
    assert view.rectified.image.points()[places(view)][:, 0].min() > 0
    _, alone = look(photo(cut), None, SETTINGS)
    assert view.rectified.image.points()[places(alone)][:, 0].max() < -0.3


def test_a_thing_that_touches_a_cut_off_one_stays_where_a_step_parts_them(photo, make_box):
    cut = make_box(0.0, -0.33, (0.1, 0.1, 0.09), 0.0)  # in the foreground, hides its own far side
    behind = make_box(0.0, -0.25, (0.1, 0.06, 0.05), 0.0)
    _, view = look(photo(cut, behind, tilt=0.5), None, SETTINGS)
    points = view.rectified.image.points()[places(view)]
    assert points[:, 2].max() < 0.06 and points[:, 1].min() > -0.285 and len(points) > 1000


def test_specks_are_noise(photo, make_box):
    image = photo(make_box(0.1, 0.0), make_box(-0.1, 0.0, (0.006, 0.006, 0.03), 0.0))
    _, view = look(image, None, SETTINGS)
    assert view.rectified.image.points()[places(view)][:, 0].min() > 0
    _, fine = look(image, None, ViewSettings(least_area=5))
    assert view.rectified.image.points()[places(fine)][:, 0].min() < 0


def test_a_mask_chooses_the_thing(photo, make_box):
    image = photo(make_box(0.1, 0.0), make_box(-0.1, 0.0), tilt=0.3)
    mask = np.zeros(image.depth.shape, bool)
    mask[:, :320] = True
    _, view = look(image, mask, SETTINGS)
    assert view.rectified.image.points()[places(view)][:, 0].max() < 0
    _, reason = look(image, np.zeros_like(mask), SETTINGS)
    assert "the mask is empty" in reason
    with pytest.raises(ImageError, match="mask"):
        look(image, mask[:100], SETTINGS)


def test_impossible_settings_are_refused():
    with pytest.raises(ConfigError, match="least_height"):
        convert({"least_height": 0.0}, ViewSettings, "view.yaml")
