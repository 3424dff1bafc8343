import msgspec
import pytest

from grasp_core.errors import GraspError
from grasp_core.evaluation import trials
from grasp_core.evaluation.suites import object_plans
from grasp_core.evaluation.trials import Spent, Timed, Work, run_trials, summarise, time_dart, two_process_speedups
from grasp_core.gripper import load_gripper
from grasp_core.simulation.physics import load_physics

PLAN = next(plan for plan in object_plans("trials", "keep", 0) if plan.name == "box_900")


@pytest.fixture(scope="module")
def work():
    return Work(PLAN, load_gripper(), load_physics(), share=0.02, attempts=2, seed=0)


def test_the_committed_list_is_varied():
    names = [plan.name for plan in object_plans("trials", "keep", 0)]
    assert len(names) >= 12
    assert len(set(names)) == len(names)


def test_pieces_make_up_the_whole(work):
    whole, dynamic, _ = time_dart(work)
    assert sum(whole.outcomes.values()) == round(726 * 0.02) * 2
    assert whole.dynamic == len(dynamic) > 0
    pieces = [time_dart(msgspec.structs.replace(work, piece=k, pieces=2))[0] for k in (0, 1)]
    assert sum(sum(piece.outcomes.values()) for piece in pieces) == sum(whole.outcomes.values())


def test_both_engines_on_the_same_attempts():
    pytest.importorskip("mujoco")
    result = run_trials([PLAN], load_gripper(), load_physics(), share=0.02, attempts=2, two=False)
    assert sum(result.outcomes.values()) == result.attempts == round(726 * 0.02) * 2
    assert 0 < result.dynamic_attempts <= result.attempts
    assert result.dynamic_attempts_per_second_per_core > 0
    assert result.mujoco_dynamic_attempts_per_second_per_core > 0
    assert result.mujoco_agreement > 0.6
    assert sum(row.dynamic for row in result.by_outcome.values()) == result.dynamic_attempts
    assert result.unstable_share == 0
    assert result.two_process_speedup is None
    assert list(result.objects) == ["box_900"]


def test_rates_are_pooled_over_objects():
    a = Timed(
        "a", {"SUCCESS": 10, "MISSED": 90}, 1.0, 10, {"SUCCESS": Spent(8, 0.4, 0.2), "MISSED": Spent(2, 0.1, 0.05)}, 1.0
    )
    b = Timed("b", {"SUCCESS": 30}, 3.0, 30, {"SUCCESS": Spent(30, 2.5, 0.75)}, 0.5, redraws=1)
    pooled = summarise([a, b], [1.7, 2.2, 1.9])
    assert pooled.attempts_per_second_per_core == pytest.approx(130 / 4)
    assert pooled.dynamic_attempts_per_second_per_core == pytest.approx(40 / 3, abs=0.01)
    assert pooled.mujoco_dynamic_attempts_per_second_per_core == pytest.approx(40, abs=0.01)
    assert pooled.mujoco_ratio == pytest.approx(3.0)
    assert pooled.mujoco_agreement == pytest.approx((10 + 15) / 40)
    assert pooled.dynamic_ms["SUCCESS"] == pytest.approx((400 + 2500) / 38, abs=1e-3)
    assert pooled.dynamic_ms["MISSED"] == pytest.approx(50), "of the dynamic ones, however many took none"
    success = pooled.by_outcome["SUCCESS"]
    assert success.dynamic == 38
    assert success.dynamic_attempts_per_second_per_core == pytest.approx(38 / 2.9, abs=0.01)
    assert success.mujoco_dynamic_attempts_per_second_per_core == pytest.approx(38 / 0.95, abs=0.01)
    assert pooled.by_outcome["MISSED"].mujoco_dynamic_attempts_per_second_per_core == pytest.approx(40)
    assert pooled.unstable_share == pytest.approx(1 / 131, abs=1e-6)
    assert pooled.objects["a"].attempts_per_second_per_core == pytest.approx(100)
    assert pooled.two_process_speedup == pytest.approx(1.9)
    assert pooled.two_process_rounds == (1.7, 2.2, 1.9)


def test_one_process_and_two_do_the_same_pieces_by_turns(work, monkeypatch):
    done = []

    def fake(function, items, executor):
        done.append((executor.workers, [(item.piece, item.pieces) for item in items]))
        for index, _ in enumerate(items):
            yield index, Timed("x", {}, 0.0, 0, started=0.0, ended=1.0 if executor.workers == 1 else 1.05)

    monkeypatch.setattr(trials, "map_scenes", fake)
    speedups = two_process_speedups([work, work])
    assert speedups == pytest.approx([2 / 1.05] * len(speedups))
    assert len(speedups) >= 3
    rounds = list(zip(done[::2], done[1::2], strict=True))
    assert all(one[1] == other[1] for one, other in rounds), "both do the same"
    assert [one[0] for one, _ in rounds[:2]] == [2, 1]
    assert {piece for _, pieces in done for piece, _ in pieces} == set(range(len(speedups))), "all of the work"


@pytest.mark.parametrize("share", [0.0, 1.5])
def test_bad_shares_are_refused(share):
    with pytest.raises(GraspError, match="share"):
        run_trials([PLAN], load_gripper(), load_physics(), share=share)
