import msgspec
import pytest

from grasp_core.errors import GraspError
from grasp_core.evaluation import verdicts
from grasp_core.evaluation.suites import object_plans
from grasp_core.evaluation.verdicts import LOG, Line, Work, all_work, judge, make_plan, open_log, scene_and_grasps
from grasp_core.gripper import load_gripper
from grasp_core.simulation.crosscheck import Judge
from grasp_core.simulation.evidence import Outcome
from grasp_core.simulation.physics import load_physics

SOURCES = [plan for plan in object_plans("trials", "keep", 0) if plan.name == "box_900"]


def planned(engines=("half",), **rest):
    numbers = {"grasps": 6, "poses": 2, "noisy": 2, "attempts": 2, "seed": 0} | rest
    return make_plan(SOURCES, engines, load_gripper(), load_physics(), **numbers)


def work(noisy, plan, engine="dart"):
    return Work(SOURCES[0], 0, engine, 0, noisy, plan, load_gripper(), load_physics())


def test_a_plan_holds_all_that_verdicts_follow_from(monkeypatch):
    plan = planned()
    assert plan.objects == {"box_900": SOURCES[0].make().digest}
    assert set(plan.simulators) == {"dartpy"}
    assert plan.digest == planned().digest
    assert plan.digest != planned(grasps=7).digest
    monkeypatch.setattr(verdicts, "code_digest", lambda *places: "another")
    assert planned().digest != plan.digest


def test_mujoco_counts_where_it_is_compared():
    pytest.importorskip("mujoco")
    assert set(planned(("half", "mujoco")).simulators) == {"dartpy", "mujoco"}


@pytest.mark.parametrize(
    ("engines", "words"),
    [
        (("bullet",), "'bullet' is no engine; choose from: whole, half, fcl, mujoco"),
        (("half", "dart"), "'dart' is what the other engines are compared with; choose from: whole"),
        ((), "names nothing"),
    ],
)
def test_what_cannot_be_compared_is_refused(engines, words):
    with pytest.raises(GraspError, match=words):
        planned(engines)


@pytest.mark.parametrize("numbers", [{"grasps": 0}, {"poses": 0}, {"noisy": -1}, {"attempts": 0}, {"seed": -1}])
def test_impossible_numbers_are_refused(numbers):
    with pytest.raises(GraspError, match="at least"):
        planned(**numbers)


def test_noise_is_work_only_beside_mujoco():
    gripper, physics = load_gripper(), load_physics()
    plan = planned()
    assert {each.engine for each in all_work(SOURCES, plan, gripper, physics)} == {"dart", "half"}
    assert not any(each.noisy for each in all_work(SOURCES, plan, gripper, physics))
    both = msgspec.structs.replace(plan, engines=("half", "mujoco"))
    assert {each.engine for each in all_work(SOURCES, both, gripper, physics) if each.noisy} == {"dart", "mujoco"}


def test_empty_lines_with_and_without_noise_are_different_work():
    plan = planned(grasps=1, noisy=1)
    keys = [msgspec.structs.replace(work(noisy, plan), pose=1).key for noisy in (False, True)]
    lines = [judge(msgspec.structs.replace(work(noisy, plan), pose=1)) for noisy in (False, True)]
    assert [line.outcomes + line.qualities for line in lines] == [(), ()]
    assert [line.key for line in lines] == keys
    assert keys[0] != keys[1]


def test_diverged_attempts_do_not_count_as_failures(monkeypatch):
    plan = planned(attempts=3)
    ends = iter([Outcome.SUCCESS, Outcome.UNSTABLE, Outcome.SLIPPED, *[Outcome.UNSTABLE] * 3])
    monkeypatch.setattr(Judge, "verdict", lambda self, grasp: next(ends))
    one = msgspec.structs.replace(work(True, plan), plan=msgspec.structs.replace(plan, noisy=4))
    assert len(scene_and_grasps(one)[1]) == 2
    line = judge(one)
    assert line.qualities == (0.5, None)
    assert line.diverged == 4


def test_qualities_are_those_of_one_judge_on_the_same_draws(monkeypatch):
    plan = planned(attempts=2)
    drawn = {"dart": [], "half": []}
    for engine, seen in drawn.items():
        monkeypatch.setattr(Judge, "verdict", lambda self, grasp, seen=seen: seen.append(grasp) or Outcome.SUCCESS)
        assert judge(work(True, plan, engine)).qualities == (1.0,)
    assert drawn["dart"] == drawn["half"]
    assert len(set(drawn["dart"])) == 2


def test_a_log_goes_on_and_drops_a_torn_line(tmp_path):
    plan = planned()
    assert open_log(tmp_path, plan) == []
    line = Line("box_900", 0, "dart", 0, False, outcomes=("SUCCESS",))
    with (tmp_path / LOG).open("ab") as log:
        log.write(msgspec.json.encode(line) + b"\n" + msgspec.json.encode(line)[:9])
    assert open_log(tmp_path, plan) == [line]
    assert (tmp_path / LOG).read_bytes().count(b"\n") == 2


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"seed": 1}, "other seed"),
        ({"code": "old"}, "other code"),
        ({"objects": {"box_900": "old"}}, "other objects"),
        ({"simulators": {"dartpy": "0"}, "code": "old"}, "other code, simulators"),
    ],
)
def test_a_stale_log_is_refused_with_the_way_out(change, named, tmp_path):
    plan = planned()
    open_log(tmp_path, msgspec.structs.replace(plan, **change))
    with pytest.raises(GraspError, match=rf"belongs to another comparison \({named}\).*another --out, or remove"):
        open_log(tmp_path, plan)


@pytest.mark.parametrize("text", ["not a log\n", '{"grasps": 6}\n', "[1]\n"])
def test_other_files_are_refused(text, tmp_path):
    (tmp_path / LOG).write_text(text)
    with pytest.raises(GraspError, match="belongs to another comparison"):
        open_log(tmp_path, planned())
