from dataclasses import replace

from grasp_core.dataset.queries import Query
from grasp_core.dataset.review import Review, Rule
from workbench.actions import Download, Notice
from workbench.curate import actions as a
from workbench.curate import effects as e
from workbench.curate.organising import RELABELLING, SCORING


def test_lists_are_kept_under_tidy_names(rules, state):
    listed = replace(state, query=Query(split="test"))
    assert rules.reduce(listed, a.KeepView("  my  list "))[1] == (e.KeepQuery("my list", listed.query, "ann"),)
    assert rules.reduce(listed, a.KeepView("my list", forget=True))[1] == (e.KeepQuery("my list", None, "ann"),)
    assert rules.reduce(listed, a.KeepView("  ")) == (listed, ())


def test_reviews_begin_go_on_and_end(rules, state):
    assert rules.reduce(state, a.StartReview(Rule()))[1] == (e.MakeReview(Rule(), "ann"),)
    assert rules.reduce(state, a.ResumeReview(3))[1] == (e.LoadNext(3),)
    reviewing = replace(state, review=Review(3, "ann", Rule(), 5, 5))
    ended, effects = rules.reduce(reviewing, a.ReviewEnded(reviewing.review))
    assert ended.review is None and ended.sample is None
    assert [type(effect) for effect in effects] == [Notice, e.LoadShelf, e.LoadFacts]


def test_scoring_goes_on_until_done_or_stopped(rules, state):
    started, effects = rules.reduce(state, a.ScoreAll())
    assert effects == (e.ScoreMore(),)
    on, effects = rules.reduce(started, a.Scored(2, 5))
    assert on.scoring == (2, 5) and effects == (e.ScoreMore(),)
    done, effects = rules.reduce(on, a.Scored(5, 5, "all"))
    assert done.scoring is None and any(isinstance(effect, e.LoadShelf) for effect in effects)
    stopped, effects = rules.reduce(on, a.ScoreAll())
    assert stopped.scoring is None and effects == ()
    assert rules.reduce(stopped, a.Scored(3, 5)) == (stopped, ())
    failed, (told,) = rules.reduce(on, a.Failed(SCORING, "no"))
    assert failed.scoring is None and told.tone == "error"


def test_a_bulk_decision_moves_and_is_stopped(rules, state):
    moving, _ = rules.reduce(state, a.BulkMoved(100, 300))
    assert moving.relabelling == (100, 300) and rules.reduce(state, a.StopBulk())[1] == ()
    assert rules.reduce(moving, a.StopBulk())[1] == (e.StopRelabel("ann"),)
    assert rules.reduce(moving, a.Failed(RELABELLING, "cancelled"))[0].relabelling is None
    assert rules.reduce(moving, a.Failed(SCORING, "no"))[0].relabelling == (100, 300)
    assert rules.reduce(moving, a.BulkMoved(300, 300))[0].relabelling is None


def test_a_dataset_that_cannot_be_opened_is_told_in_its_place(rules, state):
    closed = replace(state, facts=None, loading=True)
    failed, effects = rules.reduce(closed, a.Failed("x", "it is damaged"))
    assert failed.failure == "it is damaged" and effects == () and not failed.loading
    again, effects = rules.reduce(failed, a.Reload())
    assert again.failure == "" and [type(effect) for effect in effects] == [e.LoadFacts, e.LoadShelf]


def test_people_exchange_and_facts(rules, state, facts, store):
    event = store.add_label(1, "bob", 1.0)
    about, effects = rules.reduce(state, a.ShowPerson("bob"))
    assert effects == (e.LoadPerson("bob"),)
    assert rules.reduce(about, a.PersonShown("bob", (event,)))[0].events == (event,)
    assert rules.reduce(about, a.PersonShown("eve", (event,)))[0].events == ()
    part, _ = rules.reduce(about, a.PersonShown("bob", (event,), more=True))
    assert rules.reduce(part, a.OlderEvents())[1] == (e.LoadPerson("bob", event.id),)
    older = store.add_label(2, "bob", 0.0)
    whole, _ = rules.reduce(part, a.PersonShown("bob", (older,), frozenset({older.id}), before=event.id))
    assert whole.events == (event, older) and whole.gone == {older.id} and not whole.older
    assert rules.reduce(whole, a.OlderEvents())[1] == ()
    assert rules.reduce(whole, a.PersonShown("bob", (older,), before=event.id))[0] == whole  # it came twice
    assert rules.reduce(state, a.ExportEvents())[1] == (e.Export(),)
    assert rules.reduce(state, a.ImportEvents(b"x"))[1] == (e.Import(b"x"),)
    file = Download("x.jsonl", b"")
    assert rules.reduce(state, a.Exported(file))[1] == (file,)
    assert rules.reduce(replace(state, facts=None), a.FactsShown(facts))[0].facts is facts
