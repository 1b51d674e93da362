"""Robot, person and load as one plant of Drake, made of the trees that evodesign itself works with.

    bodies  links with their inertias; joints that do not move are welds
    sole    a small ball in each corner, which touches the floor in a point with the problem's friction
    hand    a point grasp is a ball joint between hand and load, a rigid one a weld
    rotor   its reflected inertia

Contacts, grasps and the ends of ranges are as stiff as a step h of SAP makes them, springs that swing in one
step: what stands on a contact sinks by about g (h / 2 pi)^2, a tenth of a micrometre.

Source: Castro, Permenter and Han 2022, An unconstrained convex formulation of compliant contact, section V;
Drake `MultibodyPlant`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from pydrake.geometry import (
    AddContactMaterial,
    Box,
    CollisionFilterDeclaration,
    GeometrySet,
    ProximityProperties,
    Sphere,
)
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import (
    AddMultibodyPlantSceneGraph,
    ContactModel,
    CoulombFriction,
    DiscreteContactApproximation,
)
from pydrake.multibody.tree import (
    FixedOffsetFrame,
    PrismaticJoint,
    RevoluteJoint,
    RotationalInertia,
    SpatialInertia,
    WeldJoint,
)
from pydrake.systems.framework import DiagramBuilder

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.errors import ModelError
from evodesign.mechanics.agent import Agent, Contact
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.payload import Grasp, Payload
from evodesign.mechanics.scene import Scene
from evodesign.tree.equip import actuators_of
from evodesign.tree.model import JointKind, Tree

Placed = Mapping[str, Placement]
"""world_from_link by link name."""

BALL = 1e-3
"""Radius of the balls in a sole's corners [m]."""

FLOOR = (20.0, 20.0, 1.0)
"""Sides of the block whose upper face is the floor [m]."""

RIGID = 1e12
"""Stiffness of a contact [N/m], beyond what any step lets SAP show."""


@dataclass(frozen=True, slots=True, eq=False)
class DrakeScene:
    """A finished plant and what it is made of.

    Args:
        diagram: of the plant and its geometry.
        plant: Drake's.
        load: its body.
        links: bodies of every agent's links, by the names of both.
    """

    diagram: Any
    plant: Any
    load: Any
    links: Mapping[str, Mapping[str, Any]]


def drake_scene(
    scene: Scene, trees: Mapping[str, Tree], placed: Mapping[str, Placed], step: float
) -> DrakeScene:
    """The model of a scene.

    Args:
        scene: undisturbed.
        trees: of robot and person by name, of a design.
        placed: their links where the scene begins; hands keep their turn on the load from then on.
        step: of the integration [s].
    Raises:
        ModelError: Drake cannot move a body: one that turns has no inertia, or one that none can have.
    """
    builder = DiagramBuilder()
    plant, graph = AddMultibodyPlantSceneGraph(builder, step)
    plant.SetUseSampledOutputPorts(False)  # so that steps are functions of positions and velocities
    plant.set_contact_model(ContactModel.kPoint)
    plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
    plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -GRAVITY])
    touching, friction = ProximityProperties(), scene.ground.friction
    AddContactMaterial(touching, None, RIGID, CoulombFriction(friction, friction))
    touching.AddProperty("material", "relaxation_time", step / math.pi)
    below = RigidTransform([0.0, 0.0, -FLOOR[2] / 2.0])
    plant.RegisterCollisionGeometry(plant.world_body(), below, Box(*FLOOR), "floor", touching)
    links, balls = {}, []
    try:
        load = plant.AddRigidBody("load", _inertia(scene.payload.inertia))
        for agent in scene.agents:
            own = links[agent.name] = _add_links(plant, agent, trees[agent.name])
            balls += [ball for foot in agent.feet for ball in _add_balls(plant, own, agent, foot, touching)]
            for hand in agent.hands:
                _add_grasp(plant, own[hand.frame], load, scene.payload, agent, hand, placed[agent.name])
        plant.Finalize()
    except RuntimeError as error:
        raise ModelError("drake", "", "bodies that Drake can move", f"{error}") from error
    apart = CollisionFilterDeclaration().ExcludeWithin(GeometrySet(balls))
    graph.collision_filter_manager().Apply(apart)
    return DrakeScene(builder.Build(), plant, load, links)


def transform_of(placement: Placement) -> Any:
    """As Drake has it."""
    return RigidTransform(RotationMatrix(np.array(placement.rotation)), np.array(placement.translation))


def _inertia(inertia: Inertia) -> Any:
    if not float(inertia.mass):
        return SpatialInertia.Zero()
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = inertia.about_center
    about_center = RotationalInertia(xx, yy, zz, xy, xz, yz)
    return SpatialInertia.MakeFromCentralInertia(inertia.mass, np.array(inertia.center, float), about_center)


def _add_links(plant: Any, agent: Agent, tree: Tree) -> dict[str, Any]:
    """An agent's links with their joints."""
    own, driven = plant.AddModelInstance(agent.name), actuators_of(tree)
    links = {link.name: plant.AddRigidBody(link.name, own, _inertia(link.inertia)) for link in tree.links}
    for joint in tree.joints:
        parent, child = links[joint.parent].body_frame(), links[joint.child].body_frame()
        place = transform_of(joint.parent_from_child)
        if joint.name not in agent.joints:
            plant.AddJoint(WeldJoint(joint.name, parent, child, place))
            continue
        kind = PrismaticJoint if joint.kind is JointKind.PRISMATIC else RevoluteJoint
        at = plant.AddFrame(FixedOffsetFrame(joint.name, parent, place))
        moving = plant.AddJoint(kind(joint.name, at, child, np.array(joint.axis, float)))
        if joint.kind is not JointKind.CONTINUOUS:
            moving.set_position_limits([joint.lower], [joint.upper])
        if joint.name in driven:
            rotor = plant.AddJointActuator(joint.name, moving)
            rotor.set_default_gear_ratio(1.0)
            rotor.set_default_rotor_inertia(float(driven[joint.name].inertia))
    return links


def _add_balls(
    plant: Any, links: Mapping[str, Any], agent: Agent, foot: Contact, touching: Any
) -> Iterator[Any]:
    """Those in the corners of a sole."""
    for x, y in product((-0.5, 0.5), repeat=2):
        corner = RigidTransform([x * foot.sole.length, y * foot.sole.width, BALL])
        name = f"{agent.name}/{foot.name}{x:+}{y:+}"
        yield plant.RegisterCollisionGeometry(links[foot.frame], corner, Sphere(BALL), name, touching)


def _add_grasp(
    plant: Any, link: Any, load: Any, payload: Payload, agent: Agent, hand: Contact, placed: Placed
) -> None:
    """A hand on the load: its place, and with rigid grasps its turn in the first posture."""
    grip = agent.turn @ payload.grasp_point(agent, hand)
    if payload.grasp is Grasp.RIGID:
        held = RigidTransform(transform_of(placed[hand.frame]).rotation(), grip)
        plant.AddWeldConstraint(link, RigidTransform(), load, held)
    else:
        plant.AddBallConstraint(link, np.zeros(3), load, grip)
