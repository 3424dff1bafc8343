"""Rules of decisions: given, saved, in conflict, undone, reverted, in bulk."""

from __future__ import annotations

from dataclasses import replace

from grasp_core.dataset.review import Item
from workbench.actions import Effect, Notice
from workbench.curate import actions as a
from workbench.curate import effects as e
from workbench.curate.browsing import list_again, move, show
from workbench.curate.registry import Result, nameless, rule
from workbench.curate.state import BulkAsk, Conflict, State
from workbench.curate.values import Decision


@rule(a.WriteNote)
def _write_note(action: a.WriteNote, state: State) -> Result:
    return replace(state, note=action.text[:1000]), ()


@rule(a.Decide)
def _decide(action: a.Decide, state: State) -> Result:
    return decide(state, action.decision, stay=action.decision in ("flag", "unflag", "note"))


def decide(state: State, what: float | str, *, stay: bool) -> Result:
    """Store a decision on the sample that is shown, and go on to the next one unless `stay`."""
    if (told := nameless(state)) is not None:
        return told
    sample, item = state.sample, state.item
    if sample is None or state.conflicts or sample.row.id != state.wanted:
        return state, ()  # a held key must not decide twice
    review, place = (None, 0) if item is None else (item.review, item.place)
    decision = Decision(sample.row.id, what, state.note, sample.seen, review, place)
    saving = replace(state, pending=(*state.pending, decision), note="")
    save = e.Save(decision, state.person)
    if stay:
        return saving, (save,)
    if item is not None:
        return replace(saving, wanted=None), (save, e.LoadNext(item.review))
    moved, more = move(a.Move(1), saving)
    return moved, (save, *more)


@rule(a.Nudge)
def _nudge(action: a.Nudge, state: State) -> Result:
    if state.sample is None or state.item is not None or state.pending:
        return state, ()
    row = state.sample.row
    start = 0.5 if row.label is None and row.quality is None else row.label if row.label is not None else row.quality
    assert start is not None
    return decide(state, round(min(max(start + action.by, 0.0), 1.0), 2), stay=True)


@rule(a.AddNote)
def _add_note(action: a.AddNote, state: State) -> Result:
    if not state.note:
        return state, (Notice("info", "An empty note", "Write something first."),)
    return decide(state, "note", stay=True)


def _without(decisions: tuple[Decision, ...], done: Decision) -> tuple[Decision, ...]:
    return tuple(decision for decision in decisions if decision != done)


@rule(a.Saved)
def _saved(action: a.Saved, state: State) -> Result:
    state = replace(
        state,
        pending=_without(state.pending, action.decision),
        unsaved=_without(state.unsaved, action.decision),
        saved=state.saved + 1,
    )
    if not state.unsaved:
        state = replace(state, trouble="")
    if state.shelf is not None:
        thumbs = (replace(t, row=action.row) if t.row.id == action.row.id else t for t in state.shelf.thumbs)
        state = replace(state, shelf=replace(state.shelf, thumbs=tuple(thumbs)))
    return show(state, action.row.id) if state.wanted == action.row.id else (state, ())


@rule(a.NotSaved)
def _not_saved(action: a.NotSaved, state: State) -> Result:
    told = Notice("error", "A decision is not saved", f"{action.reason} It is kept here: mend that, then try again.")
    unsaved = (*_without(state.unsaved, action.decision), action.decision)
    pending = _without(state.pending, action.decision)
    return replace(state, pending=pending, unsaved=unsaved, trouble=action.reason), (told,)


@rule(a.Retry)
def _retry(action: a.Retry, state: State) -> Result:
    if (told := nameless(state)) is not None:
        return told
    again = tuple(e.Save(decision, state.person) for decision in state.unsaved)
    return replace(state, pending=(*state.pending, *state.unsaved), unsaved=(), trouble=""), again


@rule(a.Conflicted)
def _conflicted(action: a.Conflicted, state: State) -> Result:
    pending, met = _without(state.pending, action.decision), Conflict(action.decision, action.events)
    state = replace(state, pending=pending, conflicts=(*state.conflicts, met))
    return show(state, state.conflicts[0].decision.grasp)


@rule(a.Resolve)
def _resolve(action: a.Resolve, state: State) -> Result:
    if not state.conflicts:
        return state, ()
    decision, events = state.conflicts[0].decision, state.conflicts[0].events
    state = replace(state, conflicts=state.conflicts[1:])
    effects: tuple[Effect, ...] = ()
    if action.mine:
        again = replace(decision, seen=max(event.id for event in events))
        state, effects = replace(state, pending=(*state.pending, again)), (e.Save(again, state.person),)
    if state.conflicts or state.review is None:
        state, more = show(state, (state.conflicts[0].decision if state.conflicts else decision).grasp)
        return state, (*effects, *more)
    left = None  # the review goes on; what was left to a colleague is not asked again
    if not action.mine and decision.review is not None:
        left = Item(decision.review, decision.place, decision.grasp, False)
    return replace(state, wanted=None), (*effects, e.LoadNext(state.review.id, left))


@rule(a.TakeBack)
def _take_back(action: a.TakeBack, state: State) -> Result:
    return nameless(state) or (state, (e.StepBack(state.person, action.redo),))


@rule(a.RevertEvent)
def _revert(action: a.RevertEvent, state: State) -> Result:
    return nameless(state) or (state, (e.Revert(action.event, state.person),))


@rule(a.Changed)
def changed(action: a.Changed, state: State) -> Result:
    """Read again what is shown."""
    effects: tuple[Effect, ...] = (Notice("info", "Done", action.words),) if action.words else ()
    state = replace(state, busy="", bulk=None if action.whole else state.bulk)
    grasp = action.grasp if action.grasp is not None else state.wanted
    if grasp is not None and state.review is None:
        state, more = show(state, grasp)
        effects = (*effects, *more)
    state, more = list_again(state)
    facts: tuple[Effect, ...] = (e.LoadFacts(state.person),) if action.whole else ()
    person: tuple[Effect, ...] = (e.LoadPerson(state.about),) if state.about else ()
    return state, (*effects, *more, *facts, *person)


@rule(a.CountBulk)
def _count_bulk(action: a.CountBulk, state: State) -> Result:
    return nameless(state) or (state, (e.Count(state.query, action.decision),))


@rule(a.BulkCounted)
def _bulk_counted(action: a.BulkCounted, state: State) -> Result:
    if action.query != state.query:
        return state, ()
    return replace(state, bulk=BulkAsk(action.query, action.decision, action.plan)), ()


@rule(a.AnswerBulk)
def _answer_bulk(action: a.AnswerBulk, state: State) -> Result:
    if state.bulk is None or not action.go or state.relabelling is not None:
        return replace(state, bulk=None), ()
    ask = state.bulk
    relabel = e.Relabel(ask.query, ask.decision, ask.plan, state.person)
    return replace(state, bulk=None, relabelling=(0, ask.plan.samples)), (relabel,)


@rule(a.BulkMoved)
def _bulk_moved(action: a.BulkMoved, state: State) -> Result:
    return replace(state, relabelling=(action.done, action.total) if action.done < action.total else None), ()


@rule(a.StopBulk)
def _stop_bulk(action: a.StopBulk, state: State) -> Result:
    return state, () if state.relabelling is None else (e.StopRelabel(state.person),)
