import pickle

from workbench.inspector.orders import LAYERS, SceneRequest


def test_scenes_and_attempts_travel_between_processes(opened, attempt):
    copy = pickle.loads(pickle.dumps(opened))
    assert copy.request == opened.request
    assert (copy.image.depth == opened.image.depth).all()
    assert copy.plan.candidates == opened.plan.candidates
    back = pickle.loads(pickle.dumps(attempt(2)))
    assert back.number == 2 and (back.recording.poses == attempt(2).recording.poses).all()


def test_requests_are_keys():
    one = SceneRequest("mug", 3, 0, 1, "cascade")
    assert {one: 1}[SceneRequest("mug", 3, 0, 1, "cascade")] == 1


def test_layers_are_distinct():
    assert len(set(LAYERS)) == len(LAYERS) == 3
