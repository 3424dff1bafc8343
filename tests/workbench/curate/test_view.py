from dataclasses import replace
from types import SimpleNamespace

import pytest

from grasp_core.dataset.queries import Query
from grasp_core.gripper import load_gripper
from workbench.actions import Notice
from workbench.curate import actions as a
from workbench.curate import effects as e
from workbench.curate import workshop
from workbench.curate.state import Conflict, Playing, State
from workbench.curate.values import Decision
from workbench.curate.view import Curation


@pytest.fixture
def jobs():
    return SimpleNamespace(asked=[], submit=lambda *args: jobs_asked.append(args))


jobs_asked: list = []


@pytest.fixture
def curation(jobs, folder):
    jobs_asked.clear()
    view = Curation(jobs, folder, load_gripper())
    yield view
    view.close()


def test_a_new_browser_reads_list_and_facts(curation):
    state, effects = curation.arrive(State(), {}, True)
    assert [type(effect) for effect in effects] == [e.LoadFacts, e.LoadShelf] and effects[1].pick == 0
    again, effects = curation.arrive(replace(state, shelf=object()), {}, False)
    assert effects == () and again.shelf is not None


def test_links_say_what_is_shown_and_bring_it_back(curation, state):
    query = Query(split="train", quality=(0.2, 0.8), flagged=True, sort="gap", descending=True)
    link = curation.link(replace(state, query=query))
    assert link == {
        "split": "train", "quality": "0.2..0.8", "flagged": "yes", "sort": "gap", "descending": "yes", "sample": "2",
    }  # fmt: skip
    there, effects = curation.arrive(State(), link, True)
    assert there.query == query and there.wanted == 2 and effects[-1] == e.LoadSample(2)
    assert curation.link(State()) == {}


@pytest.mark.parametrize("query", [{"split": "x"}, {"sample": "two"}, {"quality": "high"}])
def test_impossible_links_are_told(curation, query):
    state, effects = curation.arrive(State(), query, True)
    assert isinstance(effects[0], Notice) and state.query == State().query
    (word,) = query
    state, effects = curation.arrive(State(), {"object": "box_000", **query, "descending": "yes"}, True)
    assert state.query == Query(object="box_000", descending=True)
    assert effects[0].body.startswith(f"{word}: ")


def test_name_and_unsaved_decisions_outlive_the_server(curation):
    state = State(person="ann", unsaved=(Decision(3, 0.5, "x", 9),), pending=(Decision(4, "exclude"),))
    back = curation.first(curation.keep(state))
    assert back.person == "ann" and back.unsaved == (*state.unsaved, *state.pending)
    asked = replace(state, conflicts=(Conflict(Decision(5, 0.0), ()),))
    assert Decision(5, 0.0) in curation.first(curation.keep(asked)).unsaved
    for claimed in ({"unsaved": "x", "person": 7}, {"unsaved": [{"grasp": "x"}]}):
        assert curation.first(claimed) == State()


def test_physics_and_networks_go_to_the_worker(curation, folder):
    for effect, work in (
        (e.TryMore(1, 5, "ann"), workshop.verify),
        (e.PlayAttempt(1, 0), workshop.replay),
        (e.ScoreMore(), workshop.score),
    ):
        posted = []
        assert curation.perform(posted.append, effect)
        done, failed, asked, *args = jobs_asked[-1]
        assert asked is work and args[0] == folder
        failed("no")
        assert isinstance(posted[0], a.Failed) and posted[0].reason == "no"
    done((3, 3))
    assert posted[-1] == a.Scored(3, 3, "All 3 scenes have scores now.")


def test_time_is_wanted_while_a_replay_runs(curation, state, played):
    assert not curation.ticking(state)
    assert curation.ticking(replace(state, playing=Playing(2, played)))


def test_everything_is_shown(curation, curation_bridge, client, state):
    part = curation.show(curation_bridge, state)
    part.update(None, state)
    page = client.page()
    assert "data-sample=" in page and "data-decide=" in page and "History" in page and "Start a review" in page


def test_foreign_effects_are_left(curation):
    assert not curation.perform(lambda action: None, object())
