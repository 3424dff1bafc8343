import msgspec
import pytest

from grasp_core.dataset.bulk import BulkPlan
from grasp_core.dataset.exchange import EventLine
from grasp_core.dataset.queries import Query
from grasp_core.dataset.review import Rule
from grasp_core.grasp import Grasp
from grasp_core.gripper import load_gripper
from workbench.curate import actions as a
from workbench.curate import effects as e
from workbench.curate.desk import PAGE, Desk
from workbench.curate.values import Decision


def test_pages_with_pictures(ask):
    (page,) = ask(e.LoadShelf(3, Query(), None, 0))
    assert (page.ticket, page.pick, page.shelf.total) == (3, 0, None) and len(page.shelf.thumbs) == PAGE
    assert all(thumb.picture.startswith("data:image/jpeg") for thumb in page.shelf.thumbs)
    assert len({thumb.picture for thumb in page.shelf.thumbs}) > 20
    (rest,) = ask(e.LoadShelf(4, Query(), page.shelf.after, 0))
    assert len(rest.shelf.thumbs) == 6 and rest.shelf.after is None
    (few,) = ask(e.LoadShelf(5, Query(quality=(1.0, 1.0)), None, 0))
    assert few.shelf.total == 3


def test_a_sample_with_all_that_is_known(ask, store):
    store.add_label(1, "bob", 0.25, note="rim")
    (shown,) = ask(e.LoadSample(1))
    sample = shown.sample
    assert (sample.object, sample.category, sample.split, sample.scene_name) == ("box_000", "box", "train", "box_000-0")
    assert len(sample.attempts) == 2 and sample.label.reason == "bob set 0.25" and sample.pooled.attempts == 2
    assert sample.seen == sample.history[-1].id and sample.crop.startswith("data:image")


def test_a_decision_is_on_disk_when_it_is_said(ask, store):
    (saved,) = ask(e.Save(Decision(4, 0.0, "rim", 0), "ann"))
    assert saved.row.label == 0.0 == store.grasp(4).label
    assert (store.history(4)[0].person, store.history(4)[0].note) == ("ann", "rim")


def test_conflicts_and_failures_keep_the_decision(ask, store):
    theirs = store.add_label(4, "bob", 1.0)
    decision = Decision(4, 0.0, "", 0)
    (conflict,) = ask(e.Save(decision, "ann"))
    assert isinstance(conflict, a.Conflicted) and conflict.events == (theirs,) and conflict.decision == decision
    (failed,) = ask(e.Save(Decision(999, 0.0), "ann"))
    assert isinstance(failed, a.NotSaved) and "no grasp" in failed.reason


def test_undo_redo_and_revert(ask, store):
    ask(e.Save(Decision(4, 0.0), "ann"))
    (undone,) = ask(e.StepBack("ann", redo=False))
    assert undone.grasp == 4 and undone.whole and store.grasp(4).label == 0.5
    (redone,) = ask(e.StepBack("ann", redo=True))
    assert "Redone" in redone.words and store.grasp(4).label == 0.0
    (nothing,) = ask(e.StepBack("eve", redo=False))
    assert "nothing of eve" in nothing.words and nothing.grasp is None
    (reverted,) = ask(e.Revert(store.history(4)[0].id, "bob"))
    assert reverted.grasp == 4


def test_bulk(ask, store):
    query = Query(quality=(0.5, 0.5))
    (counted,) = ask(e.Count(query, 0.0))
    assert counted.plan == BulkPlan(27, 27, 0)
    ended, done = ask(e.Relabel(query, 0.0, counted.plan, "ann"))
    assert ended == a.BulkMoved(27, 27) and "27 samples" in done.words and store.count(Query(label=(0.0, 0.0))) == 27
    (refused,) = ask(e.Relabel(query, 1.0, BulkPlan(1, 1, 0), "ann"))
    assert isinstance(refused, a.Failed) and refused.title == "Nothing was relabelled"


def test_a_bulk_decision_is_stopped_whole(ask, store):
    assert ask(e.StopRelabel("ann")) == []
    everything = Query()
    (counted,) = ask(e.Count(everything, 0.0))
    (stopped,) = ask(e.Relabel(everything, 0.0, counted.plan, "ann"))
    assert stopped == a.Failed("Nothing was relabelled", "cancelled; no label was changed")
    assert store.events() == []
    assert ask(e.Relabel(everything, 0.0, counted.plan, "ann"))[0] == a.BulkMoved(30, 30)  # the next one is its own


def test_a_review_from_start_to_end(ask, store):
    (shown,) = ask(e.MakeReview(Rule(choice="audit", size=2, hidden=0.0), "ann"))
    assert shown.review.items == 2 and shown.item.place == 0 and shown.sample.row.id == shown.item.grasp
    ask(e.Save(Decision(shown.item.grasp, 1.0, "", 0, shown.review.id, 0), "ann"))
    (second,) = ask(e.LoadNext(shown.review.id))
    assert second.item.place == 1 and second.review.done == 1
    (ended,) = ask(e.LoadNext(shown.review.id, second.item))
    assert isinstance(ended, a.ReviewEnded) and ended.review.done == 2


def test_edited_rectangles_become_grasps(ask, store):
    (changed,) = ask(e.StoreGrasp(2, Grasp((0.01, 0.01, 0.02), 0.2, 0.09), "ann", 0))
    assert store.grasp(changed.grasp).parent == 2
    _, verify = ask(e.StoreGrasp(2, Grasp((0.01, 0.02, 0.02), 0.2, 0.09), "ann", 5))
    assert verify == a.Verify(5, verify.grasp) and verify.grasp != changed.grasp


def test_facts_views_and_people(ask, store):
    store.add_label(1, "bob", 1.0)
    (shown,) = ask(e.KeepQuery("mine", Query(gap=(0.5, 1.0)), "ann"))
    assert shown.facts.views == {"mine": Query(gap=(0.5, 1.0))}
    assert (shown.facts.samples, shown.facts.categories, shown.facts.weights) == (30, ("box",), "")
    assert ask(e.KeepQuery("mine", None, "ann"))[0].facts.views == {}
    (person,) = ask(e.LoadPerson("bob"))
    assert [event.value for event in person.events] == [1.0] and not person.more and person.gone == frozenset()


def test_a_long_history_of_a_person_comes_in_parts(ask, store, monkeypatch):
    monkeypatch.setattr("workbench.curate.desk.EVENTS", 2)
    made = [store.add_label(grasp, "bob", 1.0) for grasp in (1, 2, 3)]
    store.revert(made[2].id, "ann")
    (newest,) = ask(e.LoadPerson("bob"))
    assert [event.id for event in newest.events] == [made[2].id, made[1].id]
    assert newest.more and newest.gone == {made[2].id}
    (rest,) = ask(e.LoadPerson("bob", made[1].id))
    assert [event.id for event in rest.events] == [made[0].id] and not rest.more and rest.before == made[1].id


def test_broken_views_are_left_out(ask, store):
    with store.transaction() as db:
        db.execute("INSERT INTO views (name, query, changed) VALUES ('broken', '{\"sort\":\"x\"}', 0)")
    assert ask(e.LoadFacts(""))[0].facts.views == {}


def test_label_events_go_out_and_come_in(ask, store):
    store.add_label(1, "bob", 1.0)
    (out,) = ask(e.Export())
    lines = out.file.content.splitlines()
    assert out.file.name == "small-labels.jsonl" and len(lines) == 1
    line = msgspec.structs.replace(msgspec.json.decode(lines[0], type=EventLine), uid="other", number=5)
    grasp = store.grasp(6).grasp
    line = msgspec.structs.replace(line, grasp=(*grasp.position, grasp.angle, grasp.width))
    (come,) = ask(e.Import(msgspec.json.encode(line) + b"\n"))
    assert "1 label events added" in come.words and store.grasp(6).source == "human"
    (refused,) = ask(e.Import(b"nonsense"))
    assert isinstance(refused, a.Failed) and "line 1" in refused.reason


def test_a_missing_dataset_is_one_failure(tmp_path):
    desk, answers = Desk(tmp_path / "none", load_gripper()), []
    assert desk.perform(answers.append, e.LoadFacts(""))
    desk.close()
    assert answers[0].title == "The dataset cannot be opened" and "holds no dataset" in answers[0].reason


@pytest.mark.parametrize("effect", [e.TryMore(1, 5, "ann"), e.ScoreMore()])
def test_what_belongs_to_the_worker_is_left(desk, effect):
    assert not desk.perform(lambda answer: None, effect)


def test_the_shipped_sample_is_opened_where_there_is_no_dataset(folder, tmp_path, monkeypatch):
    from workbench.curate import desk as module

    monkeypatch.setattr(module, "shipped_archives", lambda: {"default": tmp_path / "default.npz.xz"})
    monkeypatch.setattr(module, "sample_dataset", lambda: folder)
    for path, sample, opened in ((tmp_path / "none", True, folder), (folder, True, folder)):
        desk, answers = Desk(path, load_gripper(), sample=sample), []
        desk.perform(answers.append, e.LoadFacts(""))
        desk.close()
        assert desk.path == opened and answers[0].facts.samples == 30
    desk, answers = Desk(tmp_path / "none", load_gripper()), []
    desk.perform(answers.append, e.LoadFacts(""))
    desk.close()
    assert isinstance(answers[0], a.Failed)
