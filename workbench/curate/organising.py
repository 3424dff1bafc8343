"""Rules of what surrounds the labels: views, reviews, scores, people, exchange."""

from __future__ import annotations

from dataclasses import replace

from workbench.actions import Notice
from workbench.curate import actions as a
from workbench.curate import effects as e
from workbench.curate.browsing import list_again
from workbench.curate.labelling import changed
from workbench.curate.registry import Result, nameless, rule
from workbench.curate.state import State

SCORING = "The dataset could not be scored"
"""Title of the failure that ends scoring."""

RELABELLING = "Nothing was relabelled"
"""Title of the failure that ends a bulk decision."""


@rule(a.KeepView)
def _keep_view(action: a.KeepView, state: State) -> Result:
    name = " ".join(action.name.split())[:60]
    if not name:
        return state, ()
    return state, (e.KeepQuery(name, None if action.forget else state.query, state.person),)


@rule(a.StartReview)
def _start_review(action: a.StartReview, state: State) -> Result:
    return nameless(state) or (state, (e.MakeReview(action.rule, state.person),))


@rule(a.ResumeReview)
def _resume_review(action: a.ResumeReview, state: State) -> Result:
    if action.review is not None:
        return replace(state, edited=None, playing=None, bulk=None, about=""), (e.LoadNext(action.review),)
    state, effects = list_again(replace(state, review=None, item=None, sample=None, wanted=None), 0)
    return state, (*effects, e.LoadFacts(state.person))


@rule(a.ReviewEnded)
def _review_ended(action: a.ReviewEnded, state: State) -> Result:
    told = Notice("info", "The review is done", f"All {action.review.items} samples were looked at.")
    state, effects = _resume_review(a.ResumeReview(None), state)
    return state, (told, *effects)


@rule(a.ScoreAll)
def _score_all(action: a.ScoreAll, state: State) -> Result:
    if state.scoring is not None:
        return replace(state, scoring=None), ()
    return replace(state, scoring=(0, 0)), (e.ScoreMore(),)


@rule(a.Scored)
def _scored(action: a.Scored, state: State) -> Result:
    if state.scoring is None:
        return state, ()
    if action.done < action.total and not action.words:
        return replace(state, scoring=(action.done, action.total)), (e.ScoreMore(),)
    return changed(a.Changed(action.words, whole=True), replace(state, scoring=None))


@rule(a.Reload)
def _reload(action: a.Reload, state: State) -> Result:
    state, effects = list_again(replace(state, failure="", keys=(None,)), 0)
    return state, (e.LoadFacts(state.person), *effects)


@rule(a.FactsShown)
def _facts_shown(action: a.FactsShown, state: State) -> Result:
    return replace(state, facts=action.facts, failure=""), ()


@rule(a.ShowPerson)
def _show_person(action: a.ShowPerson, state: State) -> Result:
    state = replace(state, about=action.name, events=(), older=False)
    return state, (e.LoadPerson(action.name),) if action.name else ()


@rule(a.OlderEvents)
def _older_events(action: a.OlderEvents, state: State) -> Result:
    return state, (e.LoadPerson(state.about, state.events[-1].id),) if state.older else ()


@rule(a.PersonShown)
def _person_shown(action: a.PersonShown, state: State) -> Result:
    known = state.events if action.before is not None else ()
    if action.name != state.about or (known and known[-1].id != action.before):
        return state, ()
    gone = action.gone | (state.gone if known else frozenset())
    return replace(state, events=(*known, *action.events), gone=gone, older=action.more), ()


@rule(a.ExportEvents)
def _export(action: a.ExportEvents, state: State) -> Result:
    return state, (e.Export(),)


@rule(a.Exported)
def _exported(action: a.Exported, state: State) -> Result:
    return state, (action.file,)


@rule(a.ImportEvents)
def _import(action: a.ImportEvents, state: State) -> Result:
    return state, (e.Import(action.content),)


@rule(a.Failed)
def _failed(action: a.Failed, state: State) -> Result:
    if state.facts is None:  # the dataset cannot be opened: the list says so
        return replace(state, busy="", loading=False, failure=action.reason), ()
    scoring = None if action.title == SCORING else state.scoring
    relabelling = None if action.title == RELABELLING else state.relabelling
    state = replace(state, busy="", loading=False, scoring=scoring, relabelling=relabelling)
    return state, (Notice("error", action.title, action.reason),)
