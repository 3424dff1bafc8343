import cv2
import numpy as np
import pytest

from grasp_core.camera import Camera, CameraIntrinsics, DepthImage, look_down
from grasp_core.errors import ImageError
from grasp_core.evaluation.gallery import (
    around_objects,
    contact_sheet,
    depth_picture,
    draw_failure,
    failures,
    heat_picture,
)
from grasp_core.evaluation.records import CandidateRecord, PlanRecord
from grasp_core.grasp import Grasp
from grasp_core.planning.planner import Plan

CAMERA = Camera(CameraIntrinsics(250, 250, 159.5, 119.5, 320, 240), look_down(0.7))


def image() -> DepthImage:
    depth = np.full((240, 320), 0.7)
    depth[100:140, 120:200] = 0.66
    depth[:40] = np.nan
    return DepthImage.from_array(depth, CAMERA)


def record(*outcomes: tuple[str, ...]) -> PlanRecord:
    candidates = tuple(
        CandidateRecord(Grasp((0.02 * k, 0.0, 0.02), 0.4, 0.1), 0.9, words, (1,) * len(words), (0,) * len(words))
        for k, words in enumerate(outcomes)
    )
    return PlanRecord("mug-0-p0", "cascade", 12.0, None if candidates else "all below t — 0.5", candidates)


def has(picture: np.ndarray, colour: tuple[int, int, int]) -> bool:
    return bool((np.abs(picture.astype(int) - colour).max(axis=2) < 60).any())  # thin lines are smoothed


def test_a_failure_shows_its_grasps_coloured_by_how_they_went(tmp_path):
    path = tmp_path / "deep" / "one.png"
    draw_failure(path, image(), None, record(("COLLISION", "MISSED"), ("SUCCESS", "SUCCESS"), ("SUCCESS", "SLIPPED")))
    picture = cv2.imread(str(path))
    rows, columns = around_objects(image())
    tall, wide = 3 * (rows.stop - rows.start), 3 * (columns.stop - columns.start)
    assert picture.shape[0] > tall and picture.shape[1] == wide  # zoomed, and the caption stands below
    for colour in ((60, 60, 230), (80, 200, 60), (40, 170, 240)):
        assert has(picture[:tall], colour)


def test_the_quality_map_stands_beside_the_depth(tmp_path):
    quality = np.linspace(-1, 2, 300 * 400, dtype=np.float32).reshape(300, 400)
    draw_failure(tmp_path / "alone.png", image(), None, record(("MISSED",)))
    plan = Plan((), None, image(), quality, None, np.zeros((0, 2)), (), {}, CAMERA, "", 0.0)
    draw_failure(tmp_path / "one.png", image(), plan, record(("MISSED",)))
    picture = cv2.imread(str(tmp_path / "one.png"))
    alone = cv2.imread(str(tmp_path / "alone.png"))
    rows, _ = around_objects(image())
    tall = 3 * (rows.stop - rows.start)
    assert picture.shape[1] == alone.shape[1] + round(400 * tall / 300)  # fitted to the height of the depth


def test_pictures_show_what_stands_on_the_table():
    rows, columns = around_objects(image())
    assert rows.start < 100 - 60 and rows.stop > 140 + 60 and columns.start < 120 - 60 and columns.stop > 200 + 60
    assert columns.start > 0 and columns.stop < 320
    bare = DepthImage.from_array(np.full((240, 320), 0.7), CAMERA)
    assert around_objects(bare) == (slice(0, 240), slice(0, 320))


def test_an_empty_plan_is_drawn_with_its_reason(tmp_path):
    draw_failure(tmp_path / "one.png", image(), None, record())
    picture = cv2.imread(str(tmp_path / "one.png"))
    assert (picture[-40:] < 100).any()


def test_holes_and_heights_can_be_told_apart():
    picture = depth_picture(image())
    assert (picture[5, 5] != picture[50, 50]).any()
    assert picture[120, 160].sum() > picture[50, 50].sum()  # nearer is brighter


def test_a_quality_map_is_clipped_for_display_only():
    quality = np.array([[-5, 0, 1, 9]], np.float32)
    picture = heat_picture(quality)
    assert (picture[0, 0] == picture[0, 1]).all() and (picture[0, 2] == picture[0, 3]).all()
    assert quality.tolist() == [[-5, 0, 1, 9]]


@pytest.mark.parametrize(("count", "rows"), [(1, 1), (3, 1), (4, 2)])
def test_a_contact_sheet_joins_the_pictures_of_a_folder(tmp_path, count, rows):
    for number in range(count):
        draw_failure(tmp_path / f"{number}.png", image(), None, record(("MISSED",) * (number + 1)))
    sheet = contact_sheet(tmp_path)
    assert sheet == tmp_path / "sheet.png"
    first = cv2.imread(str(sheet))
    assert first.shape[1] == 3 * 484 and first.shape[0] % rows == 0
    assert contact_sheet(tmp_path) == sheet  # the sheet is no picture of itself
    assert cv2.imread(str(sheet)).shape == first.shape


def test_a_sheet_says_how_many_more_pictures_there_are(tmp_path):
    for number in range(3):
        draw_failure(tmp_path / f"{number}.png", image(), None, record(("MISSED",)))
    whole = cv2.imread(str(contact_sheet(tmp_path)))
    part = cv2.imread(str(contact_sheet(tmp_path, most=2)))
    assert part.shape[0] == whole.shape[0] + 26  # the line below
    assert (part[-26:] < 200).any() and [path.name for path in failures(tmp_path)] == ["0.png", "1.png", "2.png"]


def test_pictures_that_cannot_be_written_are_not_lost_in_silence(tmp_path):
    (tmp_path / "0.png").mkdir()
    with pytest.raises(ImageError, match=r"0\.png: cannot be written"):
        draw_failure(tmp_path / "0.png", image(), None, record(("MISSED",)))


def test_no_failures_make_no_sheet(tmp_path):
    assert contact_sheet(tmp_path) is None
