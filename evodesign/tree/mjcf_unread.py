"""What an MJCF model has that a tree does not: sentences on all that would change what a robot holds.

MuJoCo's compiler refuses what it does not know, so the compiled model has everything that a file says. What
holds a torque at rest (springs, tendons, friction, gravity compensation), or is drawn from elsewhere (other
bodies, gravity, media, plugins), is told in a line each. A test classifies every attribute of MuJoCo's schema
for joints, tendons and options, so that a new one is noticed.

Source: MuJoCo XML reference; MuJoCo's computation chapter, "Passive forces".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from evodesign.errors import listed
from evodesign.tree.mjcf_effort import acts_on
from evodesign.tree.mjcf_geoms import is_left_out

GRAVITY, LIKE_IT = (0.0, 0.0, -9.81), 0.02
"""Weight per mass [m/s^2] that problems have (`mechanics.balance`), and a difference that is rounding."""


@dataclass(frozen=True, slots=True)
class Unread:
    """A compiled model, and the names of its robot's links by body, the root first, and of its joints."""

    mujoco: Any
    model: Any
    links: Mapping[int, str]
    joints: Mapping[int, str]

    def sentences(self) -> Iterator[str]:
        """One for each kind that there is."""
        kinds: Mapping[str, Callable[[], Sequence[str]]] = {
            "no part of the robot, and left out": self._other_bodies,
            "the robot floats without its joints to the world": self._joints_to_world,
            "what these equalities tie together moves freely": self._loops,
            "no actuator acts directly on": self._passive,
            "geoms that are left out, as they have no size": self._endless,
            "weights that MuJoCo compensates count nevertheless": self._weightless,
            "gravity is 9.81 m/s^2 straight down, not as in the file": self._gravity,
            "springs of joints hold torque at rest, which is not counted": self._springs,
            "tendons hold torque at rest or limit joints, which is not counted": self._tendons,
            "passive forces of muscles are not counted": self._muscles,
            "damping, friction and armature of joints are not counted": self._damped,
            "not read": self._others,
        }
        for what, found in kinds.items():
            names = found()
            if names:
                yield f"{what}: {listed(names)}"

    def _name(self, kind: str, number: int) -> str:
        return getattr(self.model, kind)(number).name or f"{kind} {number}"

    def _other_bodies(self) -> list[str]:
        roots = (body for body in range(1, self.model.nbody) if self.model.body_rootid[body] == body)
        return [self._name("body", body) for body in roots if body not in self.links]

    def _joints_to_world(self) -> list[str]:
        root, free = next(iter(self.links)), self.mujoco.mjtJoint.mjJNT_FREE
        return [
            self._name("joint", joint)
            for joint in range(self.model.njnt)
            if self.model.jnt_bodyid[joint] == root and self.model.jnt_type[joint] != free
        ]

    def _loops(self) -> list[str]:
        of_joints = int(self.mujoco.mjtEq.mjEQ_JOINT)
        active = (each for each in range(self.model.neq) if self.model.eq_active0[each])
        return [self._name("equality", each) for each in active if int(self.model.eq_type[each]) != of_joints]

    def _passive(self) -> list[str]:
        if not len(self.model.actuator_trntype):
            return []
        return [name for joint, name in self.joints.items() if not acts_on(self.mujoco, self.model, joint)]

    def _endless(self) -> list[str]:
        geoms = (geom for geom in range(self.model.ngeom) if is_left_out(self.mujoco, self.model, geom))
        return [self._name("geom", geom) for geom in geoms if int(self.model.geom_bodyid[geom]) in self.links]

    def _weightless(self) -> list[str]:
        return [name for body, name in self.links.items() if self.model.body_gravcomp[body]]

    def _is_off(self, flag: str) -> bool:
        """Whether the file switches something off for all."""
        return bool(self.model.opt.disableflags & int(getattr(self.mujoco.mjtDisableBit, f"mjDSBL_{flag}")))

    def _gravity(self) -> list[str]:
        given = [0.0, 0.0, 0.0] if self._is_off("GRAVITY") else self.model.opt.gravity.tolist()
        return [] if math.dist(given, GRAVITY) <= LIKE_IT else [f"({', '.join(f'{g:g}' for g in given)})"]

    def _springs(self) -> list[str]:
        model, found = self.model, []
        for joint, name in self.joints.items() if not self._is_off("SPRING") else ():
            stiffness = float(model.jnt_stiffness[joint])
            if stiffness or _any(model, "jnt_stiffnesspoly", joint):
                turns = model.jnt_type[joint] == self.mujoco.mjtJoint.mjJNT_HINGE
                unit, at = ("N m/rad", "rad") if turns else ("N/m", "m")
                rest = float(model.qpos_spring[model.jnt_qposadr[joint]])
                found.append(f"{name} ({stiffness:.3g} {unit} about {rest:.3g} {at})")
        return found

    def _tendons(self) -> list[str]:
        model = self.model
        return [
            self._name("tendon", tendon)
            for tendon in range(model.ntendon)
            if model.tendon_stiffness[tendon]
            or _any(model, "tendon_stiffnesspoly", tendon)
            or model.tendon_frictionloss[tendon]
            or model.tendon_limited[tendon]
        ]

    def _muscles(self) -> list[str]:
        muscle = int(self.mujoco.mjtBias.mjBIAS_MUSCLE)
        biases = enumerate(self.model.actuator_biastype.tolist())
        return [self._name("actuator", number) for number, bias in biases if bias == muscle]

    def _damped(self) -> list[str]:
        fields = ("dof_damping", "dof_dampingpoly", "dof_frictionloss", "dof_armature")
        places = ((int(self.model.jnt_dofadr[joint]), name) for joint, name in self.joints.items())
        return [name for dof, name in places if any(_any(self.model, field, dof) for field in fields)]

    def _others(self) -> list[str]:
        """Media, plugins and parts that bend, with how many there are."""
        model = self.model
        medium = float(model.opt.density) or float(model.opt.viscosity)
        counts = {"plugins": int(model.nplugin), "flexible parts": int(getattr(model, "nflex", 0))}
        found = [f"{count} {what}" for what, count in counts.items() if count]
        return [*(["drag of the medium (density, viscosity, wind)"] if medium else []), *found]


def _any(model: Any, field: str, number: int) -> bool:
    """Whether a field of a joint or tendon is not zero; versions of MuJoCo differ in which there are."""
    return bool(np.any(getattr(model, field)[number])) if hasattr(model, field) else False
