import math

import numpy as np
import pytest

import grasp_core.simulation.trial as trial_module
from grasp_core.errors import GraspError
from grasp_core.grasp import Grasp, angle_distance
from grasp_core.objects.library import catalogue
from grasp_core.scene import Scene
from grasp_core.simulation.evidence import Evidence
from grasp_core.simulation.execution import Execution
from grasp_core.simulation.trial import GraspNoise, GraspTrial, Outcome, Trial, child_seed


@pytest.fixture(scope="module")
def box_trial(physics, gripper, shapes):
    return GraspTrial(shapes.alone(shapes.box(0.04, 0.06, 0.06)), gripper, physics)


def rim_grasps(count: int) -> list[Grasp]:
    """Grasps across the wall of the mug of these tests, some off the mark."""
    rng = np.random.default_rng(1)
    grasps = []
    for angle in rng.uniform(0, 2 * np.pi, count):
        x, y = 0.04 * np.array([np.cos(angle), np.sin(angle)]) + rng.normal(size=2) * 0.003
        grasps.append(Grasp((x, y, 0.06), angle + 0.2 * rng.normal(), 0.1))
    return grasps


def test_success(box_trial):
    attempt = box_trial.attempt(Grasp((0, 0, 0.03), 0.0, 0.1), 0)
    assert attempt.outcome is Outcome.SUCCESS
    assert attempt.dynamic
    assert attempt.redraws == 0
    assert 0 < attempt.comfort.distance < 0.02
    evidence = attempt.evidence
    assert evidence.object == 0
    assert evidence.clearance > 0.02
    assert sum(evidence.travel) == pytest.approx(0.1 - 0.04, abs=2e-3)
    for contact, side in ((evidence.left, 1.0), (evidence.right, -1.0)):
        assert contact.force == pytest.approx(20, rel=0.05)
        assert np.allclose(contact.normal, [-side, 0, 0], atol=0.1)
        assert contact.point[0] == pytest.approx(-side * 0.02, abs=3e-3)
        assert contact.friction < 0.6 * 20 * math.sqrt(2)


def test_collision_names_body_and_place(box_trial):
    attempt = box_trial.attempt(Grasp((0.04, 0, 0.03), 0.0, 0.1), 0)
    assert attempt.outcome is Outcome.COLLISION
    assert not attempt.dynamic
    assert attempt.comfort is None
    assert attempt.evidence.body == "left_finger"
    assert attempt.evidence.object == 0
    assert attempt.evidence.place[2] == pytest.approx(0.06, abs=1e-6)
    assert "left finger met the object" in attempt.evidence.words


def test_collision_with_the_table(box_trial):
    attempt = box_trial.attempt(Grasp((0, 0.2, -0.002), 0.0, 0.1), 0)
    assert attempt.outcome is Outcome.COLLISION
    assert attempt.evidence.object is None
    assert "the table" in attempt.evidence.words


def test_missed(box_trial):
    attempt = box_trial.attempt(Grasp((0, 0.2, 0.03), 0.0, 0.1), 0)
    assert attempt.outcome is Outcome.MISSED
    assert not attempt.dynamic
    assert "closed on nothing" in attempt.evidence.words


def test_slipped(physics, gripper, shapes):
    """A steep wedge cannot be held at its tip: 20 N and friction 0.6 do not grip 45° slopes."""
    import trimesh

    from grasp_core.objects.decomposition import build_asset

    points = np.array([[x, y, z] for x, z in ((-0.03, 0), (0.03, 0), (0, 0.03)) for y in (-0.05, 0.05)])
    roof = build_asset("roof", "roof", trimesh.convex.convex_hull(points), parts=[points], mass=0.4)
    trial = GraspTrial(shapes.alone(roof), gripper, physics, None)
    attempt = trial.attempt(Grasp((0, 0, 0.015), 0.0, 0.1), 0)
    assert attempt.outcome in (Outcome.SLIPPED, Outcome.MISSED)
    assert attempt.dynamic
    trial = GraspTrial(shapes.alone(shapes.box(0.04, 0.14, 0.06, mass=4.0)), gripper, physics, None)
    attempt = trial.attempt(Grasp((0, 0, 0.03), 0.0, 0.1), 0)
    assert attempt.outcome is Outcome.SLIPPED  # 4 kg on 2 · 0.6 · 20 N
    assert "slipped" in attempt.evidence.words
    assert attempt.evidence.time > 0
    assert attempt.evidence.place is not None


def test_same_seed_same_attempt_in_any_order(physics, gripper, shapes):
    scene = shapes.alone(shapes.mug())
    grasps = rim_grasps(40)

    def run(order):
        trial = GraspTrial(scene, gripper, physics)
        found = {}
        for index in order:
            attempt = trial.attempt(grasps[index], index)
            pose = trial._execution.engine.objects[0].pose.tobytes() if attempt.dynamic else b""
            found[index] = (attempt, pose)
        return found

    forward, backward = run(range(40)), run(reversed(range(40)))
    assert sum(attempt.dynamic for attempt, _ in forward.values()) > 25
    assert all(forward[index] == backward[index] for index in range(40))


def test_an_attempt_ends_alike_in_every_world(physics, gripper):
    """Where the detector remembers its contacts, the second attempt in a world ends otherwise than the first."""
    cup = catalogue("cup_000")
    pose = np.diag([1.0, -1.0, -1.0, 1.0])
    pose[2, 3] = cup.vertices[:, 2].max()
    scene = Scene.single(cup, pose)
    kept = []
    for y, angle in ((-0.012, 0.0), (-0.012, 2.0), (-0.008, 1.0), (-0.004, 1.5), (-0.004, 2.5)):
        ends = set()
        for number in range(5):
            trial = GraspTrial(scene, gripper, physics)
            for _ in range(2):
                attempt = trial.attempt(Grasp((0.0, y, 0.06), angle, 0.1), 0)
                assert attempt.dynamic
                ends.add((attempt, trial._execution.engine.objects[0].pose.tobytes()))
                kept.append(bytearray(1000 * number + 10))  # memory moves on
        assert len(ends) == 1


def test_batch_equals_trials_and_attempts(box_trial):
    rng = np.random.default_rng(5)
    grasps = [Grasp((*rng.uniform(-0.03, 0.03, 2), 0.03), rng.uniform(-1.5, 1.5), 0.1) for _ in range(6)]
    batch = box_trial.batch(grasps, attempts=2, seed=0)
    for index, (grasp, trial) in enumerate(zip(grasps, batch, strict=True)):
        assert trial == box_trial.trial(grasp, 2, child_seed(0, index))
        assert trial.attempts[1] == box_trial.attempt(grasp, trial.attempts[1].seed)
    assert len({attempt.executed for trial in batch for attempt in trial.attempts}) == 12
    assert box_trial.batch([]) == []


def test_seed_zero_is_a_seed(box_trial):
    grasp = Grasp((0, 0.2, 0.03), 0.0, 0.1)
    assert box_trial.trial(grasp, 3, 0) == box_trial.trial(grasp, 3, 0)
    assert box_trial.trial(grasp, 3, 0).attempts[0].executed != box_trial.trial(grasp, 3, 1).attempts[0].executed
    assert child_seed(0, 0) != child_seed(0, 1) != child_seed(1, 0)


def test_noise_follows_equation_4():
    noise = GraspNoise(sigma_p=0.003, sigma_phi=0.05)
    grasp = Grasp((0.1, 0.2, 0.3), 1.0, 0.07)
    drawn = [noise.draw(grasp, np.random.default_rng(seed)) for seed in range(3000)]
    offsets = np.array([d.position for d in drawn]) - grasp.position
    assert offsets.std(axis=0) == pytest.approx([0.003] * 3, rel=0.06)
    assert abs(offsets.mean(axis=0)).max() < 3e-4
    turns = [angle_distance(d.angle, grasp.angle) for d in drawn]
    assert math.sqrt(np.mean(np.square(turns))) == pytest.approx(0.05, rel=0.06)
    assert {d.width for d in drawn} == {0.07}


def test_no_noise_executes_the_grasp_itself(physics, gripper, shapes):
    trial = GraspTrial(shapes.alone(shapes.box(0.04, 0.06, 0.06)), gripper, physics, None)
    result = trial.trial(Grasp((0, 0, 0.03), 0.0, 0.1), 3)
    assert {attempt.executed for attempt in result.attempts} == {result.grasp}
    assert result.quality == 1.0


def test_quality_is_the_share_of_successes(box_trial):
    good = box_trial.attempt(Grasp((0, 0, 0.03), 0.0, 0.1), 0)
    bad = box_trial.attempt(Grasp((0, 0.2, 0.03), 0.0, 0.1), 0)
    trial = Trial(good.executed, (good, bad, bad, good, bad))
    assert trial.quality == pytest.approx(0.4)
    assert trial.outcomes == (Outcome.SUCCESS, Outcome.MISSED, Outcome.MISSED, Outcome.SUCCESS, Outcome.MISSED)


def test_a_diverged_attempt_is_drawn_anew_and_counted(box_trial, monkeypatch):
    real = Execution.run
    calls = []

    def run(self, grasp, advance, **rest):
        calls.append(grasp)
        if len(calls) < 3:
            return Outcome.UNSTABLE, Evidence(words="the solver diverged"), None
        return real(self, grasp, advance, **rest)

    monkeypatch.setattr(Execution, "run", run)
    attempt = box_trial.attempt(Grasp((0, 0, 0.03), 0.0, 0.1), 0)
    assert attempt.outcome is Outcome.SUCCESS
    assert attempt.redraws == 2
    assert len(set(calls)) == 3


def test_a_scene_that_always_diverges_is_an_error(box_trial, monkeypatch):
    monkeypatch.setattr(
        Execution, "run", lambda *_, **__: (Outcome.UNSTABLE, Evidence(words="the solver diverged"), None)
    )
    with pytest.raises(GraspError, match="diverges again and again"):
        box_trial.attempt(Grasp((0, 0, 0.03), 0.0, 0.1), 0)


def test_too_wide_and_empty_are_refused(box_trial, physics, gripper):
    with pytest.raises(GraspError, match=r"opens to 0\.1000 m"):
        box_trial.attempt(Grasp((0, 0, 0.03), 0.0, 0.11), 0)
    with pytest.raises(GraspError, match="at least one attempt"):
        box_trial.trial(Grasp((0, 0, 0.03), 0.0, 0.1), 0)
    with pytest.raises(GraspError, match="at least one object"):
        GraspTrial(Scene((), None), gripper, physics)


def test_the_object_between_the_fingers_is_the_one_grasped(physics, gripper, shapes):
    near, far = shapes.box(0.04, 0.06, 0.06), shapes.can()
    scene = Scene.single(near, shapes.standing(near, x=0.2))
    scene = Scene((*scene.objects, *Scene.single(far, shapes.standing(far)).objects), scene.camera)
    trial = GraspTrial(scene, gripper, physics, None)
    attempt = trial.attempt(Grasp((0, 0, 0.06), 0.3, 0.1), 0)
    assert attempt.outcome is Outcome.SUCCESS
    assert attempt.evidence.object == 1
    assert trial._execution.engine.objects[0].pose[2, 3] == pytest.approx(0.03, abs=1e-3)
    hit = trial.attempt(Grasp((0.2, 0, 0.02), math.pi / 2, 0.05), 0)
    assert hit.outcome is Outcome.COLLISION
    assert "object 0" in hit.evidence.words


def test_public_names():
    assert set(trial_module.__all__) <= set(dir(trial_module))
