from dataclasses import replace

import pytest

from grasp_core.dataset.bulk import BulkPlan
from grasp_core.dataset.review import Item, Review, Rule
from workbench.actions import Notice
from workbench.curate import actions as a
from workbench.curate import effects as e
from workbench.curate.values import Decision


def test_a_decision_is_saved_and_the_next_sample_comes(rules, state):
    new, (save, load) = rules.reduce(replace(state, note="rim"), a.Decide(1.0))
    assert save == e.Save(Decision(2, 1.0, "rim", 0), "ann") and load == e.LoadSample(3)
    assert new.pending == (save.decision,) and new.note == "" and new.saved == 0
    assert rules.reduce(new, a.Decide(1.0)) == (new, ())  # the key is held: the next sample is not there yet


def test_flags_and_notes_stay_on_the_sample(rules, state):
    new, effects = rules.reduce(state, a.Decide("flag"))
    assert len(effects) == 1 and new.wanted == 2
    assert rules.reduce(replace(state, note="x"), a.AddNote())[1][0].decision.decision == "note"
    assert isinstance(rules.reduce(state, a.AddNote())[1][0], Notice)


def test_nobody_decides_without_a_name(rules, state):
    nameless = replace(state, person="")
    for action in (a.Decide(1.0), a.TakeBack(False), a.RevertEvent(1), a.Verify(5), a.CountBulk(0.0)):
        new, (told,) = rules.reduce(nameless, action)
        assert new is nameless and told.title == "Who are you?"


@pytest.mark.parametrize(("by", "value"), [(0.1, 1.0), (-0.1, 0.9)])
def test_values_go_in_steps_and_stay_in_range(rules, state, by, value):
    assert state.sample.row.label == 1.0
    new, effects = rules.reduce(state, a.Nudge(by))
    assert [effect.decision.decision for effect in effects] == [value] and new.wanted == 2
    assert rules.reduce(new, a.Nudge(by)) == (new, ())  # the first step is still on its way


def test_saved_is_said_when_it_is_on_disk_only(rules, state):
    asked, (save, _) = rules.reduce(state, a.Decide(0.0))
    row = replace_row(state, label=0.0, source="human")
    new, effects = rules.reduce(asked, a.Saved(save.decision, row))
    assert new.pending == () and new.saved == 1 and effects == ()
    assert new.shelf.thumbs[1].row.label == 0.0
    flagged, (save,) = rules.reduce(state, a.Decide("flag"))
    assert rules.reduce(flagged, a.Saved(save.decision, row))[1] == (e.LoadSample(2),)


def replace_row(state, **changes):
    import msgspec

    return msgspec.structs.replace(state.sample.row, **changes)


def test_what_cannot_be_saved_is_kept_and_tried_again(rules, state):
    asked, (save, _) = rules.reduce(state, a.Decide(0.0))
    failed, (told,) = rules.reduce(asked, a.NotSaved(save.decision, "the disk is full."))
    assert failed.unsaved == (save.decision,) and failed.pending == () and "disk is full" in told.body
    again, effects = rules.reduce(failed, a.Retry())
    assert effects == (save,) and again.pending == (save.decision,) and again.unsaved == ()
    saved, _ = rules.reduce(again, a.Saved(save.decision, state.sample.row))
    assert saved.pending == saved.unsaved == () and saved.trouble == ""


def test_a_conflict_shows_both_and_asks(rules, state, store):
    theirs = store.add_label(2, "bob", 0.5)
    asked, (save, _) = rules.reduce(state, a.Decide(0.0))
    conflict, effects = rules.reduce(asked, a.Conflicted(save.decision, (theirs,)))
    assert effects == (e.LoadSample(2),) and conflict.pending == ()
    assert rules.reduce(conflict, a.Decide(1.0))[1] == ()
    mine, (again, *_) = rules.reduce(conflict, a.Resolve(True))
    assert again.decision.seen == theirs.id and mine.conflicts == ()
    left, effects = rules.reduce(conflict, a.Resolve(False))
    assert effects == (e.LoadSample(2),) and left.conflicts == ()
    assert rules.reduce(state, a.Resolve(True)) == (state, ())


def test_conflicts_wait_for_each_other(rules, state, store):
    theirs = store.add_label(2, "bob", 0.5), store.add_label(3, "bob", 0.5)
    mine = Decision(2, 0.0), Decision(3, "unsure")
    for decision, event in zip(mine, theirs, strict=True):
        state, effects = rules.reduce(state, a.Conflicted(decision, (event,)))
        assert effects == (e.LoadSample(2),)
    assert [conflict.decision for conflict in state.conflicts] == list(mine)
    state, (save, load) = rules.reduce(state, a.Resolve(True))
    assert save.decision == replace(mine[0], seen=theirs[0].id) and load == e.LoadSample(3)
    state, effects = rules.reduce(state, a.Resolve(False))
    assert state.conflicts == () and state.pending == (save.decision,) and effects == (e.LoadSample(3),)


def test_a_review_goes_on_after_a_conflict(rules, state, store):
    theirs = store.add_label(2, "bob", 0.5)
    reviewing = replace(state, review=Review(4, "ann", Rule(), 10, 2), item=Item(4, 2, 2, False))
    new, (save, _) = rules.reduce(reviewing, a.Decide("unsure"))
    met, _ = rules.reduce(new, a.Conflicted(save.decision, (theirs,)))
    _, (again, load) = rules.reduce(met, a.Resolve(True))
    assert again.decision.place == 2 and load == e.LoadNext(4)
    left, (load,) = rules.reduce(met, a.Resolve(False))
    assert load == e.LoadNext(4, Item(4, 2, 2, False)) and left.wanted is None


def test_undo_revert_and_what_changed(rules, state):
    assert rules.reduce(state, a.TakeBack(True))[1] == (e.StepBack("ann", True),)
    assert rules.reduce(state, a.RevertEvent(7))[1] == (e.Revert(7, "ann"),)
    new, effects = rules.reduce(replace(state, about="bob"), a.Changed("Undone.", 3, whole=True))
    kinds = [type(effect) for effect in effects]
    assert kinds == [Notice, e.LoadSample, e.LoadShelf, e.LoadFacts, e.LoadPerson] and new.wanted == 3


def test_bulk_is_counted_then_asked_then_done(rules, state):
    assert rules.reduce(state, a.CountBulk(0.0))[1] == (e.Count(state.query, 0.0),)
    plan = BulkPlan(30, 20, 1)
    counted, _ = rules.reduce(state, a.BulkCounted(state.query, 0.0, plan))
    assert counted.bulk.plan == plan
    done, (relabel,) = rules.reduce(counted, a.AnswerBulk(True))
    assert relabel == e.Relabel(state.query, 0.0, plan, "ann") and done.bulk is None
    left, effects = rules.reduce(counted, a.AnswerBulk(False))
    assert effects == () and left.bulk is None


def test_answers_in_a_review_go_with_their_item(rules, state):
    reviewing = replace(state, review=Review(4, "ann", Rule(), 10, 2), item=Item(4, 2, 2, False))
    new, (save, load) = rules.reduce(reviewing, a.Decide("unsure"))
    assert (save.decision.review, save.decision.place) == (4, 2) and load == e.LoadNext(4)
    assert rules.reduce(new, a.Decide("unsure")) == (new, ())
    assert rules.reduce(reviewing, a.Move(1))[1] == (e.LoadNext(4, reviewing.item),)
    assert rules.reduce(reviewing, a.Move(-1)) == (reviewing, ())
    assert rules.reduce(reviewing, a.Nudge(0.1)) == (reviewing, ())
