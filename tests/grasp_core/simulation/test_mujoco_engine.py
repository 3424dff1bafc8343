import math

import msgspec
import numpy as np
import pytest

from grasp_core.grasp import Grasp
from grasp_core.simulation.evidence import Outcome
from grasp_core.simulation.execution import Execution
from grasp_core.simulation.world import World

pytest.importorskip("mujoco", reason="MuJoCo is not installed; pip install 'grasp-workbench[crosscheck]'")

from grasp_core.simulation.mujoco_engine import MujocoEngine


def run(engine, pose, grasp):
    return Execution(engine, [pose]).run(grasp, 0.0, whole=False, recorder=None)


@pytest.mark.parametrize(
    ("size", "mass", "grasp", "outcome"),
    [
        ((0.04, 0.06, 0.06), None, Grasp((0, 0, 0.03), 0.3, 0.05), Outcome.SUCCESS),
        ((0.04, 0.14, 0.06), 4.0, Grasp((0, 0, 0.03), 0.0, 0.05), Outcome.SLIPPED),
        ((0.04, 0.06, 0.02), None, Grasp((0, 0.1, 0.03), 0.0, 0.05), Outcome.MISSED),
    ],
)
def test_same_verdict_as_dart(physics, gripper, shapes, size, mass, grasp, outcome):
    box = shapes.box(*size, mass=mass)
    pose = shapes.standing(box)
    ours, evidence, _ = run(MujocoEngine([box], physics, gripper), pose, grasp)
    theirs, other, _ = run(World([box], physics, gripper, poses=[pose]), pose, grasp)
    assert ours is theirs is outcome
    assert evidence.travel == pytest.approx(other.travel, abs=2e-3)


def test_friction_decides_what_is_held(physics, gripper, shapes):
    """Two fingers of 20 N hold 2 · µ · 20 N: 1.4 kg at µ = 0.6 but not at 0.2."""
    box = shapes.box(0.04, 0.06, 0.06, mass=1.4)
    pose = shapes.standing(box)
    grasp = Grasp((0, 0, 0.03), 0.0, 0.05)
    found = [
        run(MujocoEngine([box], msgspec.structs.replace(physics, friction=friction), gripper), pose, grasp)[0]
        for friction in (0.6, 0.2)
    ]
    assert found == [Outcome.SUCCESS, Outcome.SLIPPED]


def test_mass_and_inertia_are_those_of_the_asset(physics, gripper, shapes):
    mug = shapes.mug()
    model = MujocoEngine([mug], physics, gripper).model
    body = model.body("object_0")
    mass = physics.mass(mug)
    assert body.mass[0] == pytest.approx(mass)
    ours = np.linalg.eigvalsh(mug.unit_inertia * mass / mug.volume)
    assert sorted(body.inertia) == pytest.approx(sorted(ours), rel=1e-6)
    assert sum(name.startswith("object_0/") for name in (model.geom(i).name for i in range(model.ngeom))) == len(
        mug.parts
    )


def test_rests_at_the_height_of_the_pose(physics, gripper, shapes):
    mug = shapes.mug()
    pose = shapes.standing(mug, 0.05, 0.02)
    engine = MujocoEngine([mug], physics, gripper)
    engine.rewind([pose])
    engine.advance(round(0.3 / engine.physics.time_step))
    after = engine.objects[0].pose
    assert np.allclose(after[:3, 3], pose[:3, 3], atol=5e-4)
    assert math.acos(min(1.0, (np.trace(after[:3, :3]) - 1) / 2)) < math.radians(0.5)
