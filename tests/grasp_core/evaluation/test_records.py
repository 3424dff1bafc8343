import msgspec
import pytest

from grasp_core.errors import GraspError, MismatchError
from grasp_core.evaluation.records import CandidateRecord, Log, PlanRecord, Run, SceneRecord
from grasp_core.evaluation.scenes import SceneSpec
from grasp_core.grasp import Grasp

RUN = Run("folder", "keep", 0, 2, "default", "p", "g", "c", "n", {"cascade": "CascadePlanner aa default 11"})
SPEC = SceneSpec("mug", "abcdef", 0, 0)
SCENE = SceneRecord(SPEC, "mug", 0.5, [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], True, 1.0, 0.0)
CANDIDATE = CandidateRecord(
    Grasp((0.1, 0.0, 0.02), 0.3, 0.1), 0.9, ("SUCCESS", "SLIPPED"), (2**62, 2**62 + 1), (0, 0), (0.001, None)
)
PLAN = PlanRecord(SPEC.name, "cascade", 12.5, None, (CANDIDATE,))


def test_a_log_is_read_back_as_it_was_written(tmp_path):
    path = tmp_path / "deep" / "outcomes.jsonl"
    log = Log(RUN, path)
    log.add(SCENE)
    log.add(PLAN)
    lines = path.read_bytes().splitlines()
    assert [msgspec.json.decode(line)["kind"] for line in lines] == ["run", "scene", "plan"]
    again = Log(RUN, path)
    assert again.scenes == {SPEC.name: SCENE} and again.plans == {(SPEC.name, "cascade"): PLAN}
    assert path.read_bytes().splitlines() == lines


@pytest.mark.parametrize("cut", range(1, 60, 7))
def test_a_line_that_was_cut_is_dropped_and_the_log_goes_on(tmp_path, cut):
    path = tmp_path / "outcomes.jsonl"
    log = Log(RUN, path)
    log.add(SCENE)
    log.add(PLAN)
    whole = path.read_bytes()
    path.write_bytes(whole[:-cut])
    again = Log(RUN, path)
    assert again.scenes and not again.plans
    again.add(PLAN)
    assert path.read_bytes() == whole
    assert Log(RUN, path).plans


def test_a_log_cut_in_its_first_line_begins_anew(tmp_path):
    path = tmp_path / "outcomes.jsonl"
    Log(RUN, path)
    path.write_bytes(path.read_bytes()[:-5])
    assert not Log(RUN, path).scenes
    assert len(path.read_bytes().splitlines()) == 1


def test_another_run_does_not_go_on_from_it(tmp_path):
    path = tmp_path / "outcomes.jsonl"
    Log(RUN, path)
    with pytest.raises(MismatchError, match=r"other seed, physics"):
        Log(msgspec.structs.replace(RUN, seed=1, physics="q"), path)


@pytest.mark.parametrize("told", ["CascadePlanner aa default 22", "CascadePlanner bb default 11"])
def test_other_weights_of_the_same_name_or_other_settings_do_not_go_on_from_it(tmp_path, told):
    path = tmp_path / "outcomes.jsonl"
    Log(RUN, path)
    before = path.read_bytes()
    with pytest.raises(MismatchError, match=r"other cascade \(CascadePlanner aa default 11\).*another folder"):
        Log(msgspec.structs.replace(RUN, planners={"cascade": told, "random": "r"}), path)
    assert path.read_bytes() == before


def test_further_planners_are_held_to_what_the_log_says_of_them(tmp_path):
    path = tmp_path / "outcomes.jsonl"
    Log(RUN, path)
    more = msgspec.structs.replace(RUN, planners={"random": "RandomPlanner cc"})
    for _ in range(2):
        assert Log(more, path).run.planners == {**RUN.planners, **more.planners}
    assert len(path.read_bytes().splitlines()) == 2  # the second run has nothing new to tell
    with pytest.raises(MismatchError, match="other random"):
        Log(msgspec.structs.replace(RUN, planners={"random": "RandomPlanner dd"}), path)


def test_an_old_log_is_read_but_not_added_to(tmp_path):
    path = tmp_path / "outcomes.jsonl"
    log = Log(msgspec.structs.replace(RUN, planners=None), path)
    log.add(SCENE)
    log.add(PLAN)
    before = path.read_bytes()
    old = Log(RUN, path)
    assert old.plans and path.read_bytes() == before
    with pytest.raises(MismatchError, match="another folder"):
        old.check_more()
    Log(RUN, tmp_path / "new.jsonl").check_more()


@pytest.mark.parametrize("content", [b'{"kind": "plan"}\n', b"no json\n", msgspec.json.encode(SCENE) + b"\n"])
def test_what_is_no_log_is_refused_and_kept(tmp_path, content):
    path = tmp_path / "outcomes.jsonl"
    path.write_bytes(content)
    with pytest.raises(GraspError, match="another folder"):
        Log(RUN, path)
    assert path.read_bytes() == content


def test_a_folder_that_cannot_be_made_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(GraspError, match="another folder"):
        Log(RUN, tmp_path / "file" / "outcomes.jsonl")


def test_without_a_path_nothing_is_written(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    log = Log(RUN)
    log.add(SCENE)
    assert log.scenes and not list(tmp_path.iterdir())


def test_an_execution_that_was_redrawn_counts_as_failed():
    assert CANDIDATE.successes == 1
    twice = msgspec.structs.replace(CANDIDATE, outcomes=("SUCCESS", "SUCCESS"), redraws=(0, 1))
    assert twice.successes == 1
