"""Robots, people and loads as the page's scripts draw them.

The page gets the trees and the logged joint positions; it computes the link poses itself, by the same
formula as `tree.kinematics`. A design's robot is told by what differs from the unscaled one. The triangles of
meshes are told once: what differs between links and designs is how they are placed, scaled and stretched.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Shape
from evodesign.mechanics.agent import Agent
from evodesign.problem.build import DesignProblem
from evodesign.report.page.content import (
    AgentContent,
    Bodies,
    JointBody,
    LinkBody,
    LoadBody,
    MeshBody,
    ShapeBody,
    SurfaceBody,
    TreeBody,
)
from evodesign.report.scene_models import looks_of
from evodesign.tree.mesh_write import link_from_vertex
from evodesign.tree.model import Joint, Link, Mesh, Tree
from evodesign.tree.surface import Surface


def bodies(problem: DesignProblem) -> Bodies:
    """Everything that stands in the problem's scenes, the robot unscaled."""
    robot = problem.scene.robot
    others = {
        scene.pair[0]: {agent.name: agent for agent in scene.agents if not agent.designed}
        for scene in problem.scenes
    }
    trees = [robot.tree, *(agent.tree for each in others.values() for agent in each.values())]
    surfaces = _surfaces(trees)
    payloads = {scene.payload.label: scene.payload for scene in problem.scenes}
    position = _positions(robot.tree)
    changing = {position[name] for parameter in problem.space.parameters for name in parameter.links}
    return Bodies(
        robot=agent_body(robot, surfaces),
        agents=tuple(
            AgentContent(agent.name, agent.role, agent.quarters % 4, agent.designed)
            for agent in problem.scene.agents
        ),
        others={
            label: {name: agent_body(agent, surfaces) for name, agent in each.items()}
            for label, each in others.items()
        },
        payloads={
            name: LoadBody(
                size_m=_three(load.size),
                mass_kg=float(load.mass),
                hand_moment_n_m=load.hand_moment if 0.0 < load.hand_moment < math.inf else None,
            )
            for name, load in payloads.items()
        },
        changing=tuple(sorted(changing)),
        surfaces=tuple(_surface(surface) for surface in surfaces),
    )


def changes(
    problem: DesignProblem, values: Sequence[float]
) -> tuple[dict[int, LinkBody], dict[int, JointBody]]:
    """Links and joints of a design's robot that differ from the unscaled one's, by index in the tree."""
    before = problem.scene.designed_tree
    after = problem.space.resized(before, values)
    position, surfaces = _positions(after), _surfaces([after])
    links = enumerate(zip(before.links, after.links, strict=True))
    joints = enumerate(zip(before.joints, after.joints, strict=True))
    return (
        {index: _link(new, surfaces) for index, (old, new) in links if new is not old},
        {index: _joint(new, position) for index, (old, new) in joints if new is not old},
    )


def agent_body(agent: Agent, surfaces: Mapping[Surface, int]) -> TreeBody:
    """An agent's tree with what shows its links, and which links are its soles, of what size.

    Args:
        agent: unscaled.
        surfaces: of all meshes, each with its index.
    """
    position = _positions(agent.tree)
    sole = agent.feet[0].sole
    return TreeBody(
        links=tuple(_link(link, surfaces) for link in agent.tree.links),
        joints=tuple(_joint(joint, position) for joint in agent.tree.joints),
        soles={foot.name: position[foot.frame] for foot in agent.feet},
        sole_size_m=(float(sole.length), float(sole.width)),
    )


def _positions(tree: Tree) -> Mapping[str, int]:
    return {link.name: index for index, link in enumerate(tree.links)}


def _surfaces(trees: Sequence[Tree]) -> Mapping[Surface, int]:
    """The surfaces of trees, each with its index; those of a robot are the same in all of its designs."""
    seen = dict.fromkeys(mesh.surface for tree in trees for link in tree.links for mesh in link.shown)
    return {surface: index for index, surface in enumerate(seen) if surface is not None}


def _link(link: Link, surfaces: Mapping[Surface, int]) -> LinkBody:
    return LinkBody(
        name=link.name,
        mass_kg=float(link.inertia.mass),
        shapes=tuple(_shape(shape, place) for shape, place in looks_of(link)),
        meshes=tuple(_mesh(mesh, surfaces) for mesh in link.shown),
    )


def _mesh(mesh: Mesh, surfaces: Mapping[Surface, int]) -> MeshBody:
    linear, position = link_from_vertex(mesh)
    index = -1 if mesh.surface is None else surfaces[mesh.surface]
    return MeshBody(surface=index, linear=linear, position=position)


def _surface(surface: Surface) -> SurfaceBody:
    return SurfaceBody(low=surface.low, step=surface.step, points=surface.points, triangles=surface.triangles)


def _shape(shape: Shape, place: Placement) -> ShapeBody:
    return ShapeBody(
        kind=type(shape).__name__.lower(),
        size=_size(shape),
        rotation=_nine(place),
        position=_three(place.translation),
    )


def _size(shape: Shape) -> tuple[float, ...]:
    match shape:
        case Box():
            return _three(shape.sides)
        case Cylinder():
            return (float(shape.radius), float(shape.length))
        case _:
            return (float(shape.radius),)


def _joint(joint: Joint, position: Mapping[str, int]) -> JointBody:
    return JointBody(
        name=joint.name,
        kind=str(joint.kind),
        parent=position[joint.parent],
        child=position[joint.child],
        rotation=_nine(joint.parent_from_child),
        position=_three(joint.parent_from_child.translation),
        axis=_three(joint.axis),
    )


def _nine(place: Placement) -> tuple[float, ...]:
    return tuple(float(entry) for row in place.rotation for entry in row)


def _three(vector: Sequence[float]) -> tuple[float, ...]:
    return tuple(float(entry) for entry in vector)
