"""The same trial in MuJoCo: same parts, masses, friction, pads, forces and protocol, to check DART's verdicts.

Needs the extra `crosscheck`. Contacts are as stiff as the time step allows, with an elliptic friction cone and several
contacts per convex pair; MuJoCo's defaults are softer and let objects creep out of a grip. At 2 ms it agrees with its
own 1 ms on 0.973 and with 0.5 ms on 0.969 of grasps that need dynamics.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from grasp_core.errors import GraspError
from grasp_core.gripper import Gripper
from grasp_core.objects.asset import ObjectAsset
from grasp_core.simulation.contacts import Touch
from grasp_core.simulation.engine import Velocity
from grasp_core.simulation.gripper_model import FINGERS
from grasp_core.simulation.physics import Physics

_IMPRATIO = 10.0
"""Stiffness of friction over that of normal contact: slows the creep of MuJoCo's soft friction."""
_BASE = 1000.0
_SERVO = 1e5
"""kg of the base and N·s/m of the servo that lifts it. The base is driven as good as kinematically: a heavy body whose
force is known beforehand. A stiff servo on a light base would kick the object: MuJoCo's contacts see its force before
the implicit integration has tamed it (a box rose by 8 mm in the grip).
"""
_PARKED = 5.0


def _numbers(values: Any) -> str:
    return " ".join(f"{float(value):.12g}" for value in np.ravel(values))


def _model_xml(assets: Sequence[ObjectAsset], gripper: Gripper, physics: Physics) -> str:
    """The MuJoCo model: what meets what is set by bits, 1 the table, 2 objects, 4 the gripper."""
    meshes, bodies = [], []
    for index, asset in enumerate(assets):
        mass = physics.mass(asset)
        i = asset.unit_inertia * (mass / asset.volume)
        inertia = _numbers([i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]])
        geoms = []
        for number, part in enumerate(asset.parts):
            name = f"object_{index}/{number}"
            # MuJoCo moves a mesh's vertices to its own centre and axes; `pos` and `quat` stay those of the geom.
            meshes.append(f'<mesh name="{name}" vertex="{_numbers(part.vertices)}"/>')
            geoms.append(f'<geom name="{name}" type="mesh" mesh="{name}" contype="2" conaffinity="7"/>')
        bodies.append(
            f'<body name="object_{index}"><freejoint name="object_{index}"/>'
            f'<inertial pos="0 0 0" mass="{mass:.12g}" fullinertia="{inertia}"/>{"".join(geoms)}</body>'
        )
    boxes = gripper.boxes()
    parts, motors, ties = [], [], []
    grip = ' contype="4" conaffinity="2"'
    for name in ("rod", "base"):
        box, centre = boxes[name]
        size = _numbers(np.array(box.size) / 2)
        parts.append(f'<geom name="{name}" type="box" pos="{_numbers(centre)}" size="{size}" mass="1"{grip}/>')
    for name in FINGERS:
        box, centre = boxes[name]
        half_size = _numbers([box.x / 2, box.y / 4, box.z / 2])
        axis = -math.copysign(1.0, centre[0])
        for side in (-1, 1):
            place = centre + np.array([0.0, side * box.y / 4, 0.0])
            joint = f"{name}/{side}"
            parts.append(
                f'<body pos="{_numbers(place)}" gravcomp="1"><joint name="{joint}" type="slide" axis="{axis} 0 0"'
                f' range="0 {gripper.opening / 2}" limited="true" damping="{gripper.force / gripper.speed / 2:.12g}"/>'
                f'<geom name="{joint}" type="box" size="{half_size}" mass="{gripper.finger_mass / 2}"{grip}/></body>'
            )
            motors.append(f'<motor name="{joint}" joint="{joint}"/>')
        ties.append(
            f'<fixed stiffness="{physics.pad_stiffness}" springlength="0"><joint joint="{name}/-1" coef="1"/>'
            f'<joint joint="{name}/1" coef="-1"/></fixed>'
        )
    stiff = f'solref="{2 * physics.time_step} 1" solimp="0.95 0.99 0.0005 0.5 2"'
    return (
        f'<mujoco><compiler autolimits="true"/><option timestep="{physics.time_step}" gravity="0 0 {-physics.gravity}"'
        f' cone="elliptic" impratio="{_IMPRATIO}" integrator="implicitfast"><flag multiccd="enable"/></option>'
        f'<default><geom friction="{physics.friction} 0 0" condim="3" {stiff}/></default>'
        f"<asset>{''.join(meshes)}</asset><worldbody>"
        '<geom name="table" type="plane" size="1 1 0.1" contype="1" conaffinity="2"/>'
        f'{"".join(bodies)}<body name="gripper" pos="0 0 {_PARKED}"><body name="lifted" gravcomp="1">'
        f'<joint name="lift" type="slide" axis="0 0 1"/><inertial pos="0 0 0" mass="{_BASE}" diaginertia="1 1 1"/>'
        f"{''.join(parts)}</body></body></worldbody><tendon>{''.join(ties)}</tendon>"
        f'<actuator><velocity name="lift" joint="lift" kv="{_SERVO}"/>{"".join(motors)}<motor joint="lift"/></actuator>'
        "</mujoco>"
    )


class MujocoObject:
    """One object in MuJoCo."""

    def __init__(self, asset: ObjectAsset, data: Any, start: int, dof: int) -> None:
        """An object whose free joint begins at `start` in the positions and `dof` in the velocities."""
        self.asset = asset
        self._data = data
        self._start = start
        self._dof = dof

    @property
    def pose(self) -> NDArray[np.float64]:
        """world_from_object, 4×4."""
        x, y, z, w, a, b, c = self._data.qpos[self._start : self._start + 7]
        pose = np.eye(4)
        pose[:3, :3] = Rotation.from_quat([a, b, c, w]).as_matrix()
        pose[:3, 3] = x, y, z
        return pose

    def place(self, pose: NDArray[np.float64]) -> None:
        """Put it there, at rest."""
        a, b, c, w = Rotation.from_matrix(pose[:3, :3]).as_quat()
        self._data.qpos[self._start : self._start + 7] = [*pose[:3, 3], w, a, b, c]
        self._data.qvel[self._dof : self._dof + 6] = 0.0

    @property
    def velocity(self) -> Velocity:
        """Linear (m/s) then angular (rad/s) velocity in the world."""
        speed = self._data.qvel[self._dof : self._dof + 6]
        vx, vy, vz = speed[:3].tolist()
        wx, wy, wz = (self.pose[:3, :3] @ speed[3:]).tolist()
        return vx, vy, vz, wx, wy, wz


class MujocoEngine:
    """Objects on the table and the gripper in MuJoCo; see `grasp_core.simulation.engine.Engine`."""

    def __init__(self, assets: Sequence[ObjectAsset], physics: Physics, gripper: Gripper) -> None:
        """Build the model.

        Raises:
            GraspError: MuJoCo is not installed, or refuses the model.
        """
        try:
            import mujoco
        except ImportError as error:
            raise GraspError(
                "MuJoCo is not installed; pip install 'grasp-workbench[crosscheck]' to compare engines"
            ) from error
        self._mujoco = mujoco
        self.physics = physics
        self.spec = gripper
        try:
            self.model = mujoco.MjModel.from_xml_string(_model_xml(assets, gripper, physics))
        except ValueError as error:
            raise GraspError(f"MuJoCo refuses the scene ({error}); mend the objects' parts") from error
        self._data = mujoco.MjData(self.model)
        self.objects = [
            MujocoObject(
                asset,
                self._data,
                int(self.model.joint(f"object_{index}").qposadr[0]),
                int(self.model.joint(f"object_{index}").dofadr[0]),
            )
            for index, asset in enumerate(assets)
        ]
        self._frame = self.model.body("gripper").id
        self._lift = int(self.model.joint("lift").qposadr[0])
        self._lift_dof = int(self.model.joint("lift").dofadr[0])
        self._driven = float(self.model.body("lifted").subtreemass[0])
        names = [self.model.geom(index).name for index in range(self.model.ngeom)]
        owners = [name.split("/")[0] for name in names]
        self._finger = np.array([FINGERS.index(owner) if owner in FINGERS else -1 for owner in owners])
        self._owner = np.array(
            [int(owner.removeprefix("object_")) if owner.startswith("object_") else -1 for owner in owners]
        )

    def rewind(self, poses: Sequence[NDArray[np.float64]]) -> None:
        """Start afresh, the objects at rest at these poses (4×4), the gripper out of the way."""
        self._mujoco.mj_resetData(self.model, self._data)
        self.model.body_pos[self._frame] = [0.0, 0.0, _PARKED]
        for item, pose in zip(self.objects, poses, strict=True):
            item.place(pose)
        self._mujoco.mj_forward(self.model, self._data)

    def grip(self, world_from_gripper: NDArray[np.float64], travel: tuple[float, float]) -> None:
        """Put the gripper at a pose (4×4, z up), each finger at its travel from fully open, metres, and closing."""
        a, b, c, w = Rotation.from_matrix(world_from_gripper[:3, :3]).as_quat()
        self.model.body_pos[self._frame] = world_from_gripper[:3, 3]
        self.model.body_quat[self._frame] = [w, a, b, c]
        left, right = travel
        self._data.qpos[self._lift : self._lift + 5] = [0.0, left, left, right, right]
        self._data.qvel[self._lift_dof : self._lift_dof + 5] = [0.0, *[self.spec.speed] * 4]
        self._data.ctrl[1:5] = self.spec.force / 2
        self._mujoco.mj_forward(self.model, self._data)

    def advance(self, steps: int, speed: float = 0.0, acceleration: float = 0.0) -> None:
        """Close with full force for some steps while the base rises: at `speed` before the first, then accelerating."""
        self._data.ctrl[0] = speed
        self._data.ctrl[5] = acceleration * self._driven
        if acceleration == 0:
            self._mujoco.mj_step(self.model, self._data, nstep=steps)
            return
        for number in range(steps):
            self._data.ctrl[0] = speed + acceleration * number * self.physics.time_step
            self._mujoco.mj_step(self.model, self._data)

    def push(self, index: int, force: NDArray[np.float64]) -> None:
        """Push an object with a force (3,) at its centre of mass, world, N, from now on; a rewind ends it."""
        self._data.xfrc_applied[self.model.body(f"object_{index}").id, :3] = force

    @property
    def time(self) -> float:
        """Seconds since the last rewind."""
        return float(self._data.time)

    @property
    def lift(self) -> float:
        """How far the base has risen, metres."""
        return float(self._data.qpos[self._lift])

    @property
    def rising(self) -> float:
        """How fast it rises, m/s."""
        return float(self._data.qvel[self._lift_dof])

    @property
    def travel(self) -> tuple[float, float]:
        """How far each finger has closed from fully open (left, right), metres."""
        _, a, b, c, d = self._data.qpos[self._lift : self._lift + 5].tolist()
        return (a + b) / 2, (c + d) / 2

    @property
    def diverged(self) -> bool:
        """Whether the solver lost it."""
        return not float(np.abs(self._data.qvel).max(initial=0.0)) < 500.0

    def _pairs(self) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp], NDArray[np.bool_]]:
        """Of contacts between finger and object: their index, finger, object, and whether the finger is geom 1."""
        contact = self._data.contact
        if not len(contact.dist):
            none = np.zeros(0, np.intp)
            return none, none, none, none.astype(bool)
        first, second = contact.geom[:, 0], contact.geom[:, 1]
        forward = (self._finger[first] >= 0) & (self._owner[second] >= 0)
        backward = (self._finger[second] >= 0) & (self._owner[first] >= 0)
        chosen = np.flatnonzero((forward | backward) & (contact.dist <= 0))
        flip = forward[chosen]
        finger = np.where(flip, self._finger[first[chosen]], self._finger[second[chosen]])
        item = np.where(flip, self._owner[second[chosen]], self._owner[first[chosen]])
        return chosen, finger, item, flip

    def touched(self) -> tuple[bool, bool]:
        """Whether the left and the right finger touch an object."""
        finger = self._pairs()[1]
        return bool((finger == 0).any()), bool((finger == 1).any())

    def touches(self) -> list[Touch]:
        """Every contact of the last step between a finger and an object."""
        found = []
        wrench = np.zeros(6)
        for index, finger, item, finger_first in zip(*self._pairs(), strict=True):
            contact = self._data.contact[index]
            frame = contact.frame.reshape(3, 3)
            self._mujoco.mj_contactForce(self.model, self._data, index, wrench)
            # The frame's x axis points from geom 1 to geom 2; the force is that of geom 1 on geom 2.
            sign = 1.0 if finger_first else -1.0
            force = sign * (wrench[:3] @ frame)
            found.append(Touch(int(finger), int(item), np.array(contact.pos), -sign * frame[0], force))
        return found
