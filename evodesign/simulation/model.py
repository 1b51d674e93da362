"""Robot, person and load as one MuJoCo model, made of the trees that evodesign itself works with.

    sole      a box as large as the sole under its frame; it alone touches the floor, with the problem's
              friction
    hand      a site at its frame; a point grasp joins it to a site of the load (`connect`: the hand is free
              to turn), a rigid one also keeps it from turning (`weld`)
    joint     those that the problem moves, within the ranges of the file; the others are welded at zero
    actuator  tau = u - k q - d dq/dt, with u = tau_plan + k q_plan + d dq_plan/dt as its input; limited where
              file or actuator has a limit, and k and d from `feedback`
    armature  the reflected inertia of an actuator's rotor

Bodies do not touch each other: what may pass through what is the problem's matter (`[collisions]`).

Source: MuJoCo XML reference (equality, actuator, option); computation chapter (soft constraints).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import mujoco
import numpy as np

from evodesign.body.placement import Placement, quaternion_wxyz
from evodesign.control.limits import torque_limit
from evodesign.mechanics.agent import Agent, Contact
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.contact import Ground
from evodesign.mechanics.payload import Grasp, Payload
from evodesign.mechanics.scene import Scene
from evodesign.posture.results import AgentPosture, Array
from evodesign.simulation.engine import placed_links
from evodesign.tree.mjcf_write import mjcf_text
from evodesign.tree.model import JointKind, Tree

LOAD = "load"

STEP = 2.5e-4
"""Of the integration [s]."""

SOLE_HALF_THICKNESS = 0.005  # [m]

MARGIN = 1e-6
"""Height above the floor [m] from which a sole touches it: a posture's soles are on it to within rounding."""

NEARLY_RIGID = (0.97, 0.97, 0.001, 0.5, 2.0)
"""`solimp` of contacts and grasps, which give way by micrometres; the stiffer, the sooner feet chatter."""

FRICTION_FIRST = 1000.0
"""`impratio`: by how much harder friction is than the normal force, so that feet do not creep."""


@dataclass(frozen=True, slots=True, eq=False)
class AgentParts:
    """Where MuJoCo keeps an agent's numbers; j joints in the agent's order.

    Args:
        agent: whose they are.
        root: number of the root link's body.
        positions: of the joints in `qpos`, shape (j,).
        rates: of the joints in `qvel`, shape (j,).
        actuators: of the joints, shape (j,).
        soles: geoms of the soles, by side.
        hands: sites at the hands, by side.
    """

    agent: Agent
    root: int
    positions: Array
    rates: Array
    actuators: Array
    soles: Mapping[str, int]
    hands: Mapping[str, int]


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedScene:
    """A compiled model and the state in which it begins.

    Args:
        model: MuJoCo's.
        data: at rest in the first posture.
        agents: by name.
        load: number of the load's body.
    """

    model: mujoco.MjModel
    data: mujoco.MjData
    agents: Mapping[str, AgentParts]
    load: int

    def sole_origin(self, sole: int) -> Array:
        """Of the sole frame of a sole's geom, in the world [m]."""
        down = self.data.geom_xmat[sole].reshape(3, 3)[:, 2] * SOLE_HALF_THICKNESS
        return np.asarray(self.data.geom_xpos[sole] - down)


def _outcomes_tell(warning: str) -> None:
    """Take a warning of MuJoCo's, which else goes into MUJOCO_LOG.TXT where a command was started."""


def simulated_scene(
    scene: Scene,
    trees: Mapping[str, Tree],
    postures: Mapping[str, AgentPosture],
    height: float,
    step: float = STEP,
) -> SimulatedScene:
    """The model of a scene, at rest in a posture; its actuators have no feedback yet.

    Args:
        scene: undisturbed.
        trees: of robot and person by name, of a design.
        postures: by agent name, with which it begins.
        height: of the load's centre [m].
        step: of the integration [s].
    Raises:
        ModelError: MuJoCo cannot hold a tree: a link that moves has no mass.
    """
    if mujoco.get_mju_user_warning() is None:
        mujoco.set_mju_user_warning(_outcomes_tell)
    spec = mujoco.MjSpec()
    spec.option.timestep, spec.option.gravity = step, [0.0, 0.0, -GRAVITY]
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_EULER
    spec.option.cone, spec.option.impratio = mujoco.mjtCone.mjCONE_ELLIPTIC, FRICTION_FIRST
    spec.option.tolerance = 1e-12
    give = {"solref": [2.0 * step, 1.0], "solimp": NEARLY_RIGID}
    spec.worldbody.add_geom(
        name="floor", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[3.0, 3.0, 0.1], rgba=[0.9, 0.9, 0.9, 1.0]
    )
    spec.worldbody.add_light(pos=[0.0, -2.0, 4.0], dir=[0.0, 0.5, -1.0])
    load = _add_load(spec, scene.payload)
    frames = {}
    for agent in scene.agents:
        frames[agent.name] = placed_links(agent, trees[agent.name], postures[agent.name])
        _add_agent(spec, agent, trees[agent.name], scene.ground, give)
        for hand in agent.hands:
            _add_grasp(spec, load, scene.payload, agent, hand, frames[agent.name], give)
    compiled = spec.compile()
    data = mujoco.MjData(compiled)
    parts = {agent.name: _parts(compiled, agent) for agent in scene.agents}
    found = SimulatedScene(compiled, data, parts, compiled.body(LOAD).id)
    _place(found, postures, frames, height)
    mujoco.mj_forward(compiled, data)
    return found


def _add_load(spec: Any, payload: Payload) -> Any:
    body = spec.worldbody.add_body(name=LOAD, mass=payload.mass, ipos=payload.center_of_mass)
    body.inertia, body.explicitinertial = np.diag(payload.inertia.about_center), True
    body.add_freejoint(name=LOAD)
    half = [side / 2.0 for side in payload.size]
    body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_BOX, size=half, contype=0, conaffinity=0, rgba=[0.55, 0.45, 0.33, 1.0]
    )
    return body


def _moving_only(tree: Tree, joints: tuple[str, ...]) -> Tree:
    """The tree with all other joints welded at zero."""
    return tree.reshaped(
        tree.links,
        tuple(each if each.name in joints else replace(each, kind=JointKind.FIXED) for each in tree.joints),
    )


def _add_agent(spec: Any, agent: Agent, tree: Tree, ground: Ground, give: Mapping[str, Any]) -> None:
    part = mujoco.MjSpec.from_string(mjcf_text(_moving_only(tree, agent.joints), GRAVITY, {}))
    for each in (*part.worldbody.geoms, *part.worldbody.lights, *part.actuators):
        part.delete(each)
    for geom in part.geoms:
        geom.contype = geom.conaffinity = 0
    for joint in part.joints:
        joint.actfrclimited = mujoco.mjtLimited.mjLIMITED_FALSE  # the limits are the actuators'
    for foot in agent.feet:
        sole = foot.sole
        part.body(foot.frame).add_geom(
            name=f"{foot.name}_sole",
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=[sole.length / 2.0, sole.width / 2.0, SOLE_HALF_THICKNESS],
            pos=[0.0, 0.0, SOLE_HALF_THICKNESS],
            friction=[ground.friction, 0.0, 0.0],
            priority=1,
            condim=3,
            margin=MARGIN,
            contype=0,
            conaffinity=1,
            group=3,
            **give,
        )
    for hand in agent.hands:
        part.body(hand.frame).add_site(name=hand.name)
    for joint in agent.joints:
        _add_motor(part, joint, torque_limit(agent, tree, joint))
    spec.attach(part, prefix=f"{agent.name}/", frame=spec.worldbody.add_frame())


def _add_motor(part: Any, joint: str, limit: float) -> None:
    """An actuator of a joint, whose gains of feedback are still zero."""
    limited = math.isfinite(limit)
    part.add_actuator(
        name=joint,
        target=joint,
        trntype=mujoco.mjtTrn.mjTRN_JOINT,
        gaintype=mujoco.mjtGain.mjGAIN_FIXED,
        gainprm=[1.0] + [0.0] * 9,
        biastype=mujoco.mjtBias.mjBIAS_AFFINE,
        forcelimited=limited,
        forcerange=[-limit, limit] if limited else [0.0, 0.0],
    )


def _add_grasp(
    spec: Any,
    load: Any,
    payload: Payload,
    agent: Agent,
    hand: Contact,
    frames: Mapping[str, Placement],
    give: Mapping[str, Any],
) -> None:
    """A hand on the load: its place, and with rigid grasps its turn in the first posture."""
    name = f"{agent.name}/{hand.name}"
    grip = agent.turn @ payload.grasp_point(agent, hand)
    turn = quaternion_wxyz(frames[hand.frame].rotation)
    site = load.add_site(name=f"{name}_grip", pos=grip, quat=turn)
    rigid = payload.grasp is Grasp.RIGID
    spec.add_equality(
        name=name,
        type=mujoco.mjtEq.mjEQ_WELD if rigid else mujoco.mjtEq.mjEQ_CONNECT,
        objtype=mujoco.mjtObj.mjOBJ_SITE,
        name1=name,
        name2=site.name,
        **give,
    )


def _parts(model: mujoco.MjModel, agent: Agent) -> AgentParts:
    named = [f"{agent.name}/{joint}" for joint in agent.joints]
    return AgentParts(
        agent=agent,
        root=model.body(f"{agent.name}/{agent.tree.root}").id,
        positions=np.array([model.joint(name).qposadr[0] for name in named]),
        rates=np.array([model.joint(name).dofadr[0] for name in named]),
        actuators=np.array([model.actuator(name).id for name in named]),
        soles={foot.name: model.geom(f"{agent.name}/{foot.name}_sole").id for foot in agent.feet},
        hands={hand.name: model.site(f"{agent.name}/{hand.name}").id for hand in agent.hands},
    )


def _place(
    found: SimulatedScene,
    postures: Mapping[str, AgentPosture],
    frames: Mapping[str, Mapping[str, Placement]],
    height: float,
) -> None:
    """Put load and agents where they begin."""
    model, qpos = found.model, found.data.qpos
    qpos[model.joint(LOAD).qposadr[0] :][:7] = [0.0, 0.0, height, 1.0, 0.0, 0.0, 0.0]
    for name, parts in found.agents.items():
        root = frames[name][parts.agent.tree.root]
        free = model.jnt_qposadr[model.body_jntadr[parts.root]]
        qpos[free : free + 3], qpos[free + 3 : free + 7] = root.translation, quaternion_wxyz(root.rotation)
        qpos[parts.positions] = [postures[name].joints[joint] for joint in parts.agent.joints]
