import numpy as np
import pytest

from grasp_core.camera import Camera
from grasp_core.errors import ImageError
from grasp_core.planning.planner import Plan
from grasp_core.planning.result import begin, finish
from grasp_core.planning.stages import Stages
from grasp_core.planning.view import TableView, ViewSettings


def test_begin_gives_a_view_or_an_empty_plan_with_the_reason(photo, make_box):
    stages = Stages()
    assert isinstance(begin(photo(make_box(0, 0)), None, ViewSettings(), stages), TableView)
    assert list(stages.ms) == ["rectify"]
    empty = begin(photo(), None, ViewSettings(), Stages(), "w 1")
    assert isinstance(empty, Plan) and empty.reason.startswith("no object above the table")
    assert empty.weights == "w 1" and not empty.quality_map.any() and empty.candidates == empty.scored == ()
    image = photo()
    away = image.with_camera(Camera(image.camera.intrinsics, np.diag([1.0, 1.0, 1.0, 1.0])))
    assert begin(away, None, ViewSettings(), Stages()).reason.startswith("image invalid: the camera does not look down")


def test_masks_that_do_not_fit_are_errors_not_plans(photo):
    for mask in (np.ones((480, 640), np.uint8), np.ones((480, 639), bool)):
        with pytest.raises(ImageError, match="mask"):
            begin(photo(), mask, ViewSettings(), Stages())


def test_finish_moves_the_window_onto_the_canvas(photo, make_box):
    view = begin(photo(make_box(0.1, 0.05, (0.03, 0.03, 0.03))), None, ViewSettings(), Stages())
    heat = np.zeros(view.places.shape, np.float32)
    heat[20, 30] = 1.5
    plan = finish(view, heat, (30, 20, 25.0), np.array([[30.0, 20.0]]), (), (), "none", Stages())
    u, v, radius = plan.region
    assert plan.quality_map[int(v), int(u)] == 1.5 and plan.quality_map.sum() == 1.5 and radius == 25
    assert plan.sampled.tolist() == [[u, v]]
    assert (u, v) == (30 + view.columns.start, 20 + view.rows.start) and u > 30
    bare = finish(view, None, None, np.zeros((0, 2)), (), (), "none", Stages())
    assert bare.sampled.shape == (0, 2) and bare.region is None and not bare.quality_map.any()
