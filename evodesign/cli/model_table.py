"""What a problem file was understood to mean, as tables and as JSON."""

from __future__ import annotations

from typing import Any

from rich.markup import escape
from rich.table import Table

from evodesign.body.shape import Box, Cylinder, Shape
from evodesign.cli.output import figure
from evodesign.design.space import DesignParameter, ParameterKind
from evodesign.problem.build import Problem
from evodesign.statics.scene import Agent
from evodesign.tree.model import Tree
from evodesign.tree.resize import growth_of

__all__ = ["model_json", "model_tables"]

CAPTION = "sizes [m]: box x, y, z; cylinder radius x length; density [kg/m^3]"


def model_json(problem: Problem) -> dict[str, Any]:
    """What was understood, as a JSON object."""
    scene = problem.scene
    return {
        "problem": problem.name,
        "agents": [_agent(agent) for agent in (scene.robot, scene.human)],
        "payload": {"size_m": list(scene.payload.size), "mass_kg": scene.payload.mass},
        "heights_m": list(problem.heights),
        "objectives": [f"{objective.sense} {objective.name}" for objective in problem.objectives],
        "parameters": [_parameter(parameter, scene.robot.tree) for parameter in problem.space.parameters],
    }


def model_tables(problem: Problem) -> tuple[Table, ...]:
    """What was understood, for a person: the agents, the task, the links that may change."""
    shown = model_json(problem)
    agents = Table(title=escape(problem.name), title_justify="left")
    for column in ("agent", "model", "links", "joints", "that move", "mass [kg]"):
        agents.add_column(escape(column), justify="left" if column in ("agent", "model") else "right")
    for agent in shown["agents"]:
        counts = (agent["links"], agent["joints"], agent["moving_joints"])
        agents.add_row(agent["name"], escape(agent["model"]), *map(str, counts), figure(agent["mass_kg"]))
    task = Table(show_header=False)
    task.add_row("load", f"{shown['payload']['mass_kg']:g} kg, {_times(shown['payload']['size_m'])} m")
    task.add_row("heights", ", ".join(f"{height:g}" for height in shown["heights_m"]) + " m")
    task.add_row("objectives", ", ".join(shown["objectives"]))
    links = Table(caption=escape(CAPTION), caption_justify="left")
    for column in ("parameter", "from", "to", "link", "shape", "grows along", "density", "mass [kg]"):
        links.add_column(escape(column))
    for parameter in shown["parameters"]:
        for position, link in enumerate(parameter["links"]):
            name = (parameter["name"], figure(parameter["lower"]), figure(parameter["upper"]))
            growth = "-" if link["axis"] is None else _direction(link["axis"], link["about_centre"])
            first = name if position == 0 else ("", "", "")
            links.add_row(
                *map(escape, (*first, link["link"], link["shape"], growth)),
                figure(link["density_kg_per_m3"]),
                figure(link["mass_kg"]),
            )
    return agents, task, links


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
    return {
        "name": parameter.name,
        "lower": parameter.lower,
        "upper": parameter.upper,
        "links": [_link(name, parameter, tree) for name in parameter.links],
    }


def _link(name: str, parameter: DesignParameter, tree: Tree) -> dict[str, Any]:
    link = tree.link_by_name[name]
    growth = growth_of(tree, name) if parameter.kind is ParameterKind.LENGTH else None
    return {
        "link": name,
        "shape": " + ".join(_shape(solid.shape) for solid in link.solids),
        "axis": None if growth is None else list(growth.axis),
        "about_centre": None if growth is None else growth.about_centre,
        "dimension_m": None if growth is None else growth.dimension,
        "density_kg_per_m3": float(link.solids[0].density),
        "mass_kg": float(link.inertia.mass),
    }


def _shape(shape: Shape) -> str:
    if isinstance(shape, Box):
        return f"box {_times(shape.sides)}"
    if isinstance(shape, Cylinder):
        return f"cylinder {shape.radius:g} x {shape.length:g}"
    return f"sphere {shape.radius:g}"


def _times(sizes: Any) -> str:
    return " x ".join(f"{size:g}" for size in sizes)


def _direction(axis: list[float], about_centre: bool) -> str:
    """The axis in words: `-z` where it is a main axis, its components otherwise."""
    one_way = "+" if max(axis, key=abs) > 0.0 else "-"
    signs = "+-" if about_centre else one_way
    for name, component in zip("xyz", axis, strict=True):
        if abs(abs(component) - 1.0) < 1e-6:
            return f"{signs}{name}"
    return f"({', '.join(f'{component:.3f}' for component in axis)})"
