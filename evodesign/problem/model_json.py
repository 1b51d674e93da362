"""What a problem file was understood to mean, as a JSON object: agents, loads, task, links, parameters."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from typing import Any

import msgspec

from evodesign.body.shape import Box, Cylinder, Shape
from evodesign.design.parameter import DesignParameter, ParameterKind
from evodesign.errors import ModelError
from evodesign.mechanics.agent import Agent
from evodesign.mechanics.disturbance import Disturbance
from evodesign.mechanics.payload import Payload
from evodesign.problem.agents import everyone
from evodesign.problem.build import DesignProblem
from evodesign.problem.collisions import may_overlap
from evodesign.problem.file import ProblemFile
from evodesign.problem.source import decode_toml
from evodesign.records import Hold, Lift
from evodesign.tree.model import Link, Tree
from evodesign.tree.resize import growth_of


def model_json(problem: DesignProblem) -> dict[str, Any]:
    """What was understood, as a JSON object."""
    scene, tree = problem.scene, problem.scene.designed_tree
    loads = {each.payload.label: each.payload for each in problem.scenes}
    told = [_load(load) for load in loads.values()]
    disturbed = scene.disturbances
    lifts = [_lift(task) for task in problem.tasks if isinstance(task, Lift)]
    return {
        "problem": problem.name,
        "agents": [*map(_agent, scene.robots), *_people(problem)],
        **({"payload": told[0]} if len(told) == 1 else {"payloads": told}),
        "heights_m": [task.height_m for task in problem.tasks if isinstance(task, Hold)],
        **({"lifts": lifts} if lifts else {}),
        **({"disturbances": [_disturbance(d) for d in disturbed.cases]} if disturbed else {}),
        "objectives": [f"{objective.sense} {objective.name}" for objective in problem.objectives],
        **({"constraints": [*map(msgspec.to_builtins, problem.constraints)]} if problem.constraints else {}),
        "links": [
            _link(link, robot.tree, grows=True) for robot in scene.designed[:1] for link in robot.tree.links
        ],
        "parameters": [_parameter(parameter, tree) for parameter in problem.space.parameters],
        **_collisions(problem),
        **_materials(problem),
    }


def _lift(lift: Lift) -> dict[str, Any]:
    return {key: value for key, value in msgspec.to_builtins(lift).items() if key != "kind"}


def _disturbance(disturbance: Disturbance) -> dict[str, Any]:
    return {
        "name": disturbance.name,
        "load_mass_share": disturbance.mass_share,
        "center_of_mass_m": list(disturbance.center_of_mass),
        "push_n": list(disturbance.push),
        "at": str(disturbance.at),
    }


def _collisions(problem: DesignProblem) -> dict[str, Any]:
    """Pairs of bodies that are kept apart, under a key that other problems do not have."""
    agents = {agent.name: agent for agent in problem.scene.agents}
    rules = {name: agent.collisions for name, agent in agents.items() if agent.collisions is not None}
    if not rules:
        return {}
    pairs = {name: [list(pair) for pair in each.checked] for name, each in rules.items()}
    exempt = {
        agent.label or agent.name: [
            {"bodies": list(pair), "reason": reason} for pair, reason in may_overlap(agent).items()
        ]
        for agent in (*problem.scene.robots, *_by_label(problem).values())
    }
    margin = next(iter(rules.values())).margin
    return {"collisions": {"margin_m": margin, "pairs": pairs, "exempt": exempt}}


def _materials(problem: DesignProblem) -> dict[str, Any]:
    """All materials that some parameter may be of, under a key that other problems do not have."""
    found = {each.name: each for parameter in problem.space.parameters for each in parameter.materials}
    shown = [
        {"name": each.name, "density_kg_per_m3": each.density, "source": each.source}
        for each in sorted(found.values(), key=lambda each: each.density)
    ]
    return {"materials": shown} if shown else {}


def _load(load: Payload) -> dict[str, Any]:
    name = {"payload_name": load.label} if load.label else {}
    return {**name, "size_m": list(load.size), "mass_kg": load.mass}


def _people(problem: DesignProblem) -> list[dict[str, Any]]:
    """The people in short; of several, also who each is, with sex and stature unless a URDF describes it."""
    people = _by_label(problem)
    if len(people) <= 1:
        return [_agent(person) for person in people.values()]
    tables = decode_toml(problem.source.text, problem.source.path, ProblemFile)
    given = sorted(everyone(tables, problem.source), key=lambda entry: entry[1].side.quarters)
    ordered = sorted(people.items(), key=lambda named: named[1].quarters)  # at each side as in the file
    return [
        {**_agent(person), "who": label, "sex": table.sex, "stature_m": table.stature_m}
        for (label, person), (_, table) in zip(ordered, given, strict=True)
    ]


def _by_label(problem: DesignProblem) -> dict[str, Agent]:
    return {person.label: person for scene in problem.scenes for person in scene.people}


def _agent(agent: Agent) -> dict[str, Any]:
    return {
        "name": agent.name,
        "model": agent.tree.name,
        "links": len(agent.tree.links),
        "joints": len(agent.tree.joints),
        "moving_joints": len(agent.joints),
        "mass_kg": sum(float(link.inertia.mass) for link in agent.tree.links),
    }


def _parameter(parameter: DesignParameter, tree: Tree) -> dict[str, Any]:
    grows = parameter.kind is ParameterKind.LENGTH
    joints = [*parameter.joints, *(change.joint for change in parameter.changes)]
    return {
        "name": parameter.name,
        "lower": parameter.lower,
        "upper": parameter.upper,
        "unit": parameter.record.unit,
        **({"materials": [each.name for each in parameter.materials]} if parameter.materials else {}),
        **({"joints": joints} if joints else {}),
        **({"keep_mass": True} if parameter.keeps_mass else {}),
        **({"models": [each.model for each in parameter.models]} if parameter.models else {}),
        "links": [_link(tree.link_by_name[name], tree, grows=grows) for name in parameter.links],
    }


def _link(link: Link, tree: Tree, *, grows: bool) -> dict[str, Any]:
    """A link, and how it answers to a length multiplier: None where it has no answer, or if not asked for."""
    solids = [_shape(solid.shape) for solid in link.solids]
    growth = None
    if grows and link.inertia.mass > 0.0:
        with suppress(ModelError):  # a link whose joints and centre of mass are at one point
            growth = growth_of(tree, link.name)
    return {
        "link": link.name,
        "kind": _kind(link),
        "shape": " + ".join(solids),
        "solids": solids,
        "axis": None if growth is None else list(growth.axis),
        "about_centre": None if growth is None else growth.about_centre,
        "dimension_m": None if growth is None else growth.dimension,
        "longer_solids": None if growth is None else sorted(growth.stretched),
        "density_kg_per_m3": float(link.solids[0].density) if solids else None,
        "mass_kg": float(link.inertia.mass),
    }


def _kind(link: Link) -> str:
    """What a link's mass is made of."""
    if len(link.solids) > 1:
        return "composite"
    if link.solids:
        return type(link.solids[0].shape).__name__.lower()
    return "inertia of the file" if link.inertia.mass > 0.0 else "frame"


def _shape(shape: Shape) -> str:
    if isinstance(shape, Box):
        return f"box {_sizes(shape.sides)}"
    if isinstance(shape, Cylinder):
        return f"cylinder {_sizes((shape.radius, shape.length))}"
    return f"sphere {shape.radius:g}"


def _sizes(sizes: Iterable[float]) -> str:
    return ", ".join(f"{size:.4g}" for size in sizes)
