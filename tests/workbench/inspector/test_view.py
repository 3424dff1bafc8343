from workbench.actions import Effect
from workbench.inspector import actions as a
from workbench.inspector.view import Inspector


class Jobs:
    """Remembers what it was asked for."""

    def __init__(self):
        self.asked = []

    def submit(self, done, failed, work, *args):
        self.asked.append((work.__name__, done, failed, args))


def test_a_new_page_opens_the_first_scene_once(catalogue, state, opened):
    jobs, posted = Jobs(), []
    inspector = Inspector(jobs, None, catalogue, state.request)
    _, effects = inspector.arrive(inspector.first({}), {}, True)
    assert [type(effect) for effect in effects] == [a.OpenScene]
    assert inspector.perform(posted.append, effects[0])
    assert [name for name, *_ in jobs.asked] == ["open_scene"], "it was under way before the page came"
    jobs.asked[0][1](opened)
    assert posted == [a.Opened(0, opened)]


def test_effects_of_others_are_left_alone(catalogue, state):
    assert not Inspector(Jobs(), None, catalogue, state.request).perform(print, Effect())
