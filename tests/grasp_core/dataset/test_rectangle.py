import numpy as np
import pytest

from grasp_core.camera import DepthImage, canonical_camera, look_down
from grasp_core.dataset.rectangle import LEAST_WIDTH, add_edited, depth_rule, edited
from grasp_core.errors import GraspError
from grasp_core.grasp import Grasp, to_image
from grasp_core.planning.crops import DepthRule

GRASP = Grasp((0.0, 0.0, 0.03), 0.3, 0.08)
RULE = DepthRule()


@pytest.fixture
def image():
    depth = np.full((300, 300), 0.7, np.float32)
    depth[120:180, 120:180] = 0.64  # a block 6 cm high
    return DepthImage.from_array(depth, canonical_camera())


def edit(image, grasp=GRASP, **changes):
    return edited(image, grasp, opening=0.1, rule=RULE, **changes)


def test_moving_by_pixels_moves_the_rectangle_by_as_much(image):
    before = to_image(GRASP, image.camera)
    after = to_image(Grasp((*edit(image, right=7, down=-4).position[:2], 0.03), 0.3, 0.08), image.camera)
    assert (after.u - before.u, after.v - before.v) == pytest.approx((7, -4), abs=1e-6)


def test_height_follows_the_depth_rule_at_the_new_place(image):
    assert edit(image, right=5).position[2] == pytest.approx(0.03)  # 6 cm surface less 3 cm
    assert edit(image, right=60).position[2] == pytest.approx(0.008)  # bare table: tips stay 8 mm above it


def test_turning_and_widening(image):
    turned = edit(image, turn=0.2)
    assert turned.angle == pytest.approx(0.5) and turned.position[:2] == pytest.approx((0, 0), abs=1e-9)
    assert edit(image, widen=1.1).width == pytest.approx(0.088)
    assert edit(image, widen=9).width == 0.1
    assert edit(image, widen=0.001).width == LEAST_WIDTH


def test_tilted_cameras_keep_the_height(image):
    camera = image.camera.at(look_down(0.7, tilt=0.4))
    tilted = DepthImage(image.depth, camera, image.valid)
    before, moved = to_image(GRASP, camera), edit(tilted, right=6, down=3, turn=0.1)
    after = to_image(moved, camera)
    assert moved.position[2] == pytest.approx(0.03)
    assert (after.u - before.u, after.v - before.v) == pytest.approx((6, 3), abs=1e-6)
    assert after.angle - before.angle == pytest.approx(0.1, abs=1e-6)


def test_leaving_the_image_is_refused(image):
    with pytest.raises(GraspError, match="leave the image"):
        edit(image, right=500)


def test_an_edited_grasp_knows_its_parent_and_maker(store):
    row = store.grasp(2)
    new = add_edited(store, 2, Grasp((0.02, 0.0, 0.02), 0.3, 0.09), "ann")
    made = store.grasp(new)
    assert (made.parent, made.person, made.origin, made.scene) == (2, "ann", "person", row.scene)
    assert made.label is None and store.grasp(2) == row
    with pytest.raises(GraspError, match="as it was"):
        add_edited(store, 2, row.grasp, "ann")


def test_the_rule_is_the_recipes(store):
    assert depth_rule(store) == DepthRule()
    with store.transaction() as db:
        db.execute("UPDATE meta SET value = '{\"depth_rule\":{\"offset\":0.02}}' WHERE key = 'recipe'")
    assert depth_rule(store).offset == 0.02
