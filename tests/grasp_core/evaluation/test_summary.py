import msgspec
import pytest

from grasp_core.evaluation.records import CandidateRecord, Log, PlanRecord, Run, SceneRecord
from grasp_core.evaluation.scenes import SceneSpec
from grasp_core.evaluation.summary import summarise, text
from grasp_core.grasp import Grasp
from grasp_core.rates import wilson

POSE = [[1.0, 0, 0, 0], [0, 1.0, 0, 0], [0, 0, 1.0, 0], [0, 0, 0, 1.0]]
GRASP = Grasp((0, 0, 0.02), 0, 0.1)


def candidate(word: str, redraws: tuple[int, ...] | None = None) -> CandidateRecord:
    names = {"s": "SUCCESS", "c": "COLLISION", "m": "MISSED", "l": "SLIPPED"}
    outcomes = tuple(names[letter] for letter in word)
    return CandidateRecord(GRASP, 0.5, outcomes, tuple(range(len(word))), redraws or (0,) * len(word))


def log_of(*scenes: tuple[str, bool, dict[str, list[CandidateRecord]]], ms: float = 10.0) -> Log:
    log = Log(Run("f", "keep", 0, 2, "default", "p", "g", "c", "n"))
    for number, (name, graspable, plans) in enumerate(scenes):
        spec = SceneSpec(name, "abcd", 0, number)
        log.add(SceneRecord(spec, name, 1.0, POSE, graspable, 1.0 if graspable else 0.0, 0.1))
        for planner, candidates in plans.items():
            reason = None if candidates else "all below t"
            log.add(PlanRecord(spec.name, planner, ms * (number + 1), reason, tuple(candidates)))
    return log


def test_figures_of_one_planner():
    log = log_of(
        ("mug", True, {"a": [candidate("ss"), candidate("sc")]}),
        ("mug", True, {"a": [candidate("sl"), candidate("mm"), candidate("ss")]}),
        ("pen", True, {"a": []}),
        ("pen", False, {"a": [candidate("cc")]}),
        ("box", False, {"a": []}),
        ("box", False, {"a": [candidate("ss")]}),
    )
    summary = summarise(log, 2)["a"]
    assert (summary.top1.successes, summary.top1.attempts) == (3, 6)  # the empty plan loses its two attempts
    assert summary.top1.rate == 0.5 and (summary.top1.low, summary.top1.high) == wilson(3, 6)
    assert (summary.all.successes, summary.all.attempts) == (6, 10)  # an empty plan returned nothing
    assert (summary.scenes, summary.graspable, summary.ungraspable) == (6, 3, 3)
    assert (summary.empty, summary.abstained_on_ungraspable, summary.grasped_ungraspable) == (1, 1, 1)
    assert summary.plan_median_ms == 35.0 and summary.candidates_median == 2
    assert summary.outcomes == {"EMPTY": 2, "SLIPPED": 1, "SUCCESS": 3}
    assert {name: (r.successes, r.attempts) for name, r in summary.objects.items()} == {"mug": (3, 4), "pen": (0, 2)}


def test_a_higher_threshold_drops_candidates_and_plans():
    def scored(score: float, word: str) -> CandidateRecord:
        return msgspec.structs.replace(candidate(word), score=score)

    log = log_of(
        ("mug", True, {"a": [scored(0.95, "ss"), scored(0.55, "sc")]}),
        ("pen", True, {"a": [scored(0.65, "ss"), scored(0.55, "cc")]}),
        ("box", False, {"a": [scored(0.72, "cc")]}),
    )
    for key, plan in list(log.plans.items()):
        log.add(msgspec.structs.replace(plan, weights="w 1"))
        assert log.plans[key].weights == "w 1"
    summary = summarise(log, 2)["a"]
    at = {a.threshold: a for a in summary.at_thresholds}
    assert min(at) == 0.6  # all were returned at 0.55 and above: nothing is known of lower ones
    assert (at[0.6].all.successes, at[0.6].all.attempts, at[0.6].empty) == (4, 4, 0)
    assert (at[0.7].top1.successes, at[0.7].top1.attempts, at[0.7].empty) == (2, 4, 1)
    assert [at[t].abstained_on_ungraspable for t in (0.6, 0.7, 0.75)] == [0, 0, 1]
    # bins: 0.55 twice with a half and nothing, 0.65 and 0.95 with all, 0.72 with nothing
    assert summary.calibration_error == pytest.approx((2 * 0.30 + 0.35 + 0.05 + 0.72) / 5, abs=1e-4)
    assert "a with t" in text({"a": summary}) and summary.five_candidates == 0


def test_planners_without_networks_have_no_thresholds_and_no_calibration():
    log = log_of(("mug", True, {"a": [candidate("ss")] * 5}))
    summary = summarise(log, 2)["a"]
    assert summary.at_thresholds == () and summary.calibration_error is None and summary.five_candidates == 1


def test_the_keys_of_the_contract_are_there():
    built = msgspec.to_builtins(summarise(log_of(("mug", True, {"a": [candidate("ss")]})), 2))
    assert set(built) == {"a"}
    assert {"top1", "all", "scenes", "graspable", "empty", "abstained_on_ungraspable", "plan_median_ms"} <= set(
        built["a"]
    )
    for key in ("top1", "all"):
        assert {"successes", "attempts", "rate", "low", "high"} <= set(built["a"][key])


def apart(count: int) -> list[CandidateRecord]:
    return [msgspec.structs.replace(candidate("ss"), grasp=Grasp((0.02 * k, 0, 0.02), 0, 0.1)) for k in range(count)]


def test_five_candidates_are_asked_for_where_the_oracle_has_five_distinct_ones():
    log = log_of(
        ("mug", True, {"a": apart(5), "oracle": apart(5)}),
        ("cup", True, {"a": apart(4), "oracle": apart(5)}),
        ("pen", True, {"a": apart(3), "oracle": [candidate("ss")] * 5}),  # one grasp five times
        ("box", False, {"a": apart(5), "oracle": []}),
    )
    summary = summarise(log, 2)["a"]
    assert (summary.five_where_oracle, summary.oracle_five, summary.five_candidates) == (1, 2, 1)
    assert "1/2" in text(summarise(log, 2))
    pen = next(scene for scene in log.scenes.values() if scene.spec.object == "pen")
    log.add(msgspec.structs.replace(pen, distinct=8))  # it knows more than it returned
    assert summarise(log, 2)["a"].oracle_five == 3


def test_planners_are_compared_on_the_scenes_that_both_planned_on():
    log = log_of(
        ("mug", True, {"a": [candidate("ss")], "b": [candidate("sc")]}),
        ("cup", True, {"a": [candidate("ss"), candidate("cc")], "b": []}),
        ("pen", True, {"a": [candidate("cc")]}),
        ("box", False, {"a": [candidate("cc")], "b": [candidate("ss")]}),
    )
    summaries = summarise(log, 2)
    over = summaries["a"].against["b"]
    assert over.top1.scenes == 2 and over.top1.difference == pytest.approx(1 - 1 / 4)
    assert over.all.scenes == 1 and over.all.difference == pytest.approx(0.5)
    assert summaries["b"].against["a"].top1.difference == -over.top1.difference
    (line,) = [line for line in text(summaries).splitlines() if line.startswith("a - b")]
    assert "+75.0 (" in line and "+50.0 (" in line


def test_planners_are_counted_apart_in_the_order_of_the_log():
    log = log_of(("mug", True, {"b": [candidate("ss")], "a": [candidate("cc")]}))
    summaries = summarise(log, 2)
    assert list(summaries) == ["b", "a"]
    assert summaries["b"].top1.rate == 1 and summaries["a"].top1.rate == 0


def test_diverged_executions_are_failures_and_reported():
    summary = summarise(log_of(("mug", True, {"a": [candidate("ss", (0, 2))]})), 2)["a"]
    assert summary.top1.successes == 1 and summary.redrawn == 1


def test_only_ungraspable_scenes_give_no_rate():
    summary = summarise(log_of(("box", False, {"a": []})), 2)["a"]
    assert summary.top1.rate is None and summary.all.rate is None and summary.candidates_median is None
    assert "none" in text({"a": summary})


def test_text_shows_planners_objects_and_outcomes():
    log = log_of(
        ("mug", True, {"a": [candidate("ss")], "b": [candidate("cs")]}),
        ("pen", True, {"a": [candidate("ls")]}),
    )
    shown = text(summarise(log, 2))
    assert "75.0 %" in shown and "50.0 %" in shown
    (pen,) = [line for line in shown.splitlines() if line.startswith("pen")]
    assert pen.split() == ["pen", "1/2", "-", "10", "%"]
    assert "a: SLIPPED 1, SUCCESS 3" in shown


def test_nothing_planned_is_said():
    assert "nothing was planned" in text({})


@pytest.mark.parametrize("attempts", [1, 5])
def test_an_empty_plan_loses_as_many_attempts_as_were_asked_for(attempts):
    assert summarise(log_of(("mug", True, {"a": []})), attempts)["a"].top1.attempts == attempts
