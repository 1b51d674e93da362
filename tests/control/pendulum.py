"""A point mass on a rod without mass, which an ankle holds upright on a sole: pushes with a closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.mechanics.agent import Agent, Contact, Role, Touched
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.contact import SoleSize
from evodesign.mechanics.payload import Payload
from evodesign.mechanics.scene import Scene
from evodesign.posture.results import AgentPosture
from evodesign.simulation.controlled import Timing
from evodesign.simulation.engine import EngineMaker
from evodesign.simulation.mujoco_engine import MujocoEngine
from evodesign.simulation.push import Push, PushOutcome, PushTest
from evodesign.simulation.pushed_plan import PushConditions, PushedPlan
from evodesign.tree.model import Joint, JointKind, Link, Tree

SMALL = ((1e-4, 0.0, 0.0), (0.0, 1e-4, 0.0), (0.0, 0.0, 1e-4))
MASS, HEIGHT, FOOT = 50.0, 1.0, 0.01
SECONDS = 0.02


@dataclass(frozen=True)
class Pendulum:
    """Length of the sole [m] and largest torque of the ankle [N m]."""

    sole: float
    torque: float = math.inf

    def scene(self) -> Scene:
        links = (Link("body", own_inertia=Inertia(MASS, (0.0, 0.0, 0.0), SMALL)),)
        links += (Link("foot", own_inertia=Inertia(FOOT, (0.0, 0.0, 0.0), SMALL)),)
        below = Placement(translation=(0.0, 0.0, -HEIGHT))
        ankle = Joint("ankle", JointKind.REVOLUTE, "body", "foot", below, (0.0, 1.0, 0.0), -1.0, 1.0)
        contact = Contact("foot", Touched.GROUND, "foot", patch=SoleSize(self.sole, 0.1))
        limits = {} if math.isinf(self.torque) else {"ankle": self.torque}
        tree = Tree("pendulum", links, (ankle,))
        agent = Agent("robot", Role.ROBOT, tree, ("ankle",), (contact,), ("body",), torque_limits=limits)
        return Scene((agent,), Payload((0.1, 0.1, 0.1), 1.0))

    def test(self, timing: Timing | None = None, engine: EngineMaker = MujocoEngine) -> PushTest:
        scene, weight = self.scene(), np.array([0.0, 0.0, (MASS + FOOT) * GRAVITY, 0.0, 0.0, 0.0])
        upright = AgentPosture(
            np.array([0.0, 0.0, HEIGHT]), np.zeros(3), {"ankle": 0.0}, {"ankle": 0.0}, {"foot": weight}
        )
        conditions = PushConditions(timing=timing or Timing(2e-3, 4), engine=engine)
        plan = PushedPlan("upright", scene, {"robot": scene.robot.tree}, {"robot": upright}, 0.0)
        return plan.tests(conditions, alone=True)["upright"]

    def survived(self) -> float:
        """The largest impulse that a controller without delay survives [N s].

        During a push of T seconds xi' = w0 (xi - p) + F / (m w0), with the pressure p at the end of the sole
        or where the ankle's torque ends; it is survived where xi is not beyond p at its end:

            J = m w0^2 T p / (1 - exp(-w0 T))
        """
        pressure = min(self.sole / 2.0, self.torque / (MASS * GRAVITY))
        rate = math.sqrt(GRAVITY / HEIGHT)
        return MASS * rate**2 * SECONDS * pressure / (1.0 - math.exp(-rate * SECONDS))

    def pushed(self, share: float, timing: Timing | None = None) -> PushOutcome:
        return self.test(timing).pushed(Push(share * self.survived(), 0.0, seconds=SECONDS))
