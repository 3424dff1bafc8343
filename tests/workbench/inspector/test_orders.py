import pickle

import msgspec
import numpy as np

from workbench.inspector.orders import Choice, Photo, SceneRequest, Thing


def test_requests_are_hashable_values():
    one = SceneRequest((Thing("mug_003", 1), Thing("pen_000")), 7)
    same = msgspec.json.decode(msgspec.json.encode(one), type=SceneRequest)
    assert one == same and hash(one) == hash(same)
    assert one != msgspec.structs.replace(one, photo=Photo("image-1"))
    assert one.moved(1, Thing("box_001")).things == (Thing("mug_003", 1), Thing("box_001"))


def test_what_travels_between_processes_can_be_pickled(opened, attempt):
    again = pickle.loads(pickle.dumps(opened))
    assert again.request == opened.request and again.candidates(0) == opened.candidates(0)
    assert np.array_equal(again.sight.image.depth, opened.sight.image.depth)
    assert pickle.loads(pickle.dumps(attempt())).words == attempt().words


def test_candidates_of_a_plan_that_is_not_there_are_none(opened, make_scene):
    assert opened.candidates(1) == () and len(opened.candidates(0)) == 3
    assert opened.grasp(Choice(0, 2)) == opened.candidates(0)[2].grasp
