"""What a problem file was understood to mean, as tables and as JSON."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from rich.markup import escape
from rich.table import Table

from evodesign.body.shape import Box, Cylinder, Shape
from evodesign.cli.output import figure, shown, visible
from evodesign.design.space import DesignParameter, ParameterKind
from evodesign.errors import on_one_line
from evodesign.mechanics.disturbance import Disturbance
from evodesign.mechanics.scene import Agent, Payload
from evodesign.problem.build import Problem
from evodesign.problem.decode import decode_toml
from evodesign.problem.file import ProblemFile
from evodesign.problem.people import everyone
from evodesign.tree.model import Link, Tree
from evodesign.tree.resize import growth_of

__all__ = ["model_json", "model_tables"]

CAPTION = (
    "sizes [m]: box x, y, z; cylinder radius, length; sphere radius; density [kg/m^3]\n"
    "grows along: direction in the link's frame in which it gets longer; -: keeps its size"
)


def model_json(problem: Problem) -> dict[str, Any]:
    """What was understood, as a JSON object."""
    scene = problem.scene
    loads = {each.payload.label: each.payload for each in problem.scenes}
    told = [_load(load) for load in loads.values()]
    disturbed = scene.disturbances
    return {
        "problem": problem.name,
        "agents": [_agent(scene.robot), *_people(problem)],
        **({"payload": told[0]} if len(told) == 1 else {"payloads": told}),
        "heights_m": list(problem.heights),
        **({"disturbances": [_disturbance(d) for d in disturbed.cases]} if disturbed else {}),
        "objectives": [f"{objective.sense} {objective.name}" for objective in problem.objectives],
        "links": [_link(link, scene.robot.tree, grows=True) for link in scene.robot.tree.links],
        "parameters": [_parameter(parameter, scene.robot.tree) for parameter in problem.space.parameters],
        **_materials(problem),
    }


def _disturbance(disturbance: Disturbance) -> dict[str, Any]:
    return {
        "name": disturbance.name,
        "load_mass_share": disturbance.mass_share,
        "center_of_mass_m": list(disturbance.center_of_mass),
        "push_n": list(disturbance.push),
        "at": str(disturbance.at),
    }


def _materials(problem: Problem) -> dict[str, Any]:
    """All materials that some parameter may be of, under a key that other problems do not have."""
    found = {each.name: each for parameter in problem.space.parameters for each in parameter.materials}
    shown = [
        {"name": each.name, "density_kg_per_m3": each.density, "source": each.source}
        for each in sorted(found.values(), key=lambda each: each.density)
    ]
    return {"materials": shown} if shown else {}


def model_tables(problem: Problem) -> tuple[Table, ...]:
    """What was understood, for a person: agents, task, the robot's links, and the parameters."""
    shown = model_json(problem)
    return (
        _agents_table(problem.name, shown["agents"]),
        _task_table(shown),
        _links_table(shown["links"]),
        _parameters_table(shown["parameters"]),
        *([_materials_table(shown["materials"])] if "materials" in shown else []),
    )


def _agents_table(name: str, agents: Sequence[dict[str, Any]]) -> Table:
    """Robot and people; of several people, also who each is and how tall."""
    several = any("who" in agent for agent in agents)
    table = Table(title=escape(name), title_justify="left")
    for column in ("agent", *(("person",) if several else ()), "model"):
        table.add_column(escape(column), overflow="fold")
    for column in ("links", "joints", "that move", "mass [kg]"):
        table.add_column(escape(column), justify="right")
    for agent in agents:
        counts = (agent["links"], agent["joints"], agent["moving_joints"])
        table.add_row(
            agent["name"],
            *([shown(agent.get("who", ""))] if several else []),
            escape(_model(agent)),
            *map(str, counts),
            figure(agent["mass_kg"]),
        )
    return table


def _model(agent: dict[str, Any]) -> str:
    """The model's name, or what a generated person is, where that tells it from others."""
    return f"{agent['sex']}, {figure(agent['stature_m'])} m" if agent.get("sex") else str(agent["model"])


def _task_table(shown: dict[str, Any]) -> Table:
    table = Table(show_header=False)
    for load in shown["payloads"] if "payloads" in shown else [shown["payload"]]:
        mass, size = f"{load['mass_kg']:g} kg", f"{' x '.join(map(figure, load['size_m']))} m"
        name = load.get("payload_name", mass)
        told = mass if name == mass else f"{visible(name)}: {mass}"
        table.add_row("load", escape(f"{told}, {size}"))
    table.add_row("heights", ", ".join(f"{height:g}" for height in shown["heights_m"]) + " m")
    for disturbance in shown.get("disturbances", ()):
        table.add_row("disturbance", escape(_disturbance_text(disturbance)))
    table.add_row("objectives", ", ".join(shown["objectives"]))
    return table


def _disturbance_text(disturbance: dict[str, Any]) -> str:
    """A disturbance in words."""
    parts = []
    if disturbance["load_mass_share"]:
        parts.append(f"load {disturbance['load_mass_share']:+.0%}")
    if any(disturbance["center_of_mass_m"]):
        parts.append(f"centre of mass moved by {disturbance['center_of_mass_m']} m")
    if any(disturbance["push_n"]):
        parts.append(f"{disturbance['push_n']} N on the {disturbance['at']}")
    return f"{disturbance['name']}: {', '.join(parts) or 'nothing changes'}"


def _links_table(links: Iterable[dict[str, Any]]) -> Table:
    """Every link that has mass; the frames without are named below."""
    frames = [link["link"] for link in links if link["kind"] == "frame"]
    caption = f"{CAPTION}\nwithout mass: {', '.join(frames)}" if frames else CAPTION
    table = Table(title="links of the robot", title_justify="left", caption=escape(caption))
    table.caption_justify = "left"
    for column in ("link", "shape", "grows along", "density", "mass [kg]"):
        table.add_column(escape(column))
    for link in links:
        if link["kind"] != "frame":
            _add_link(table, link)
    return table


def _add_link(table: Table, link: dict[str, Any]) -> None:
    """A link's rows, one for each solid."""
    figures = (figure(link["density_kg_per_m3"]), figure(link["mass_kg"]))
    for number, shape in enumerate(link["solids"] or [link["kind"]]):
        name, density, mass = (link["link"], *figures) if number == 0 else ("", "", "")
        table.add_row(escape(name), shape, escape(_growth(link, number)), density, mass)


def _parameters_table(parameters: Iterable[dict[str, Any]]) -> Table:
    table = Table(title="parameters", title_justify="left")
    for column in ("parameter", "from", "to", "unit", "links"):
        table.add_column(column)
    for parameter in parameters:
        bounds = (figure(parameter["lower"]), figure(parameter["upper"]), parameter["unit"])
        links = ", ".join(link["link"] for link in parameter["links"])
        if "materials" in parameter:
            links = f"{links}; of {', '.join(parameter['materials'])}"
        table.add_row(escape(parameter["name"]), *bounds, escape(links))
    return table


def _materials_table(materials: Iterable[dict[str, Any]]) -> Table:
    table = Table(title="materials", title_justify="left")
    table.add_column("material", overflow="fold")
    table.add_column(escape("density [kg/m^3]"), justify="right")
    table.add_column("source", overflow="fold")
    for material in materials:
        name, source = escape(on_one_line(material["name"])), escape(on_one_line(material["source"]))
        table.add_row(name, figure(material["density_kg_per_m3"]), source)
    return table


def _load(load: Payload) -> dict[str, Any]:
    name = {"payload_name": load.label} if load.label else {}
    return {**name, "size_m": list(load.size), "mass_kg": load.mass}


def _people(problem: Problem) -> list[dict[str, Any]]:
    """The people in short; of several, also who each is, with sex and stature unless a URDF describes it."""
    people = {scene.human.label: scene.human for scene in problem.scenes}
    if len(people) == 1:
        return [_agent(problem.scene.human)]
    tables = decode_toml(problem.source.text, problem.source.path, ProblemFile)
    given = [table for _, table in everyone(tables, problem.source)]
    return [
        {**_agent(person), "who": label, "sex": table.sex, "stature_m": table.stature_m}
        for (label, person), table in zip(people.items(), given, strict=True)
    ]


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
    return {
        "name": parameter.name,
        "lower": parameter.lower,
        "upper": parameter.upper,
        "unit": parameter.record.unit,
        **({"materials": [each.name for each in parameter.materials]} if parameter.materials else {}),
        "links": [_link(tree.link_by_name[name], tree, grows=grows) for name in parameter.links],
    }


def _link(link: Link, tree: Tree, *, grows: bool) -> dict[str, Any]:
    """A link, and how it answers to a length multiplier: None without solids, or if not asked for."""
    solids = [_shape(solid.shape) for solid in link.solids]
    growth = growth_of(tree, link.name) if grows and solids else None
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


def _growth(link: dict[str, Any], solid: int) -> str:
    """The direction in which a solid of a link grows, or a dash."""
    if link["axis"] is None or solid not in link["longer_solids"]:
        return "-"
    return _direction(link["axis"], link["about_centre"])


def _shape(shape: Shape) -> str:
    if isinstance(shape, Box):
        return f"box {_sizes(shape.sides)}"
    if isinstance(shape, Cylinder):
        return f"cylinder {_sizes((shape.radius, shape.length))}"
    return f"sphere {shape.radius:g}"


def _sizes(sizes: Iterable[float]) -> str:
    return ", ".join(f"{size:.4g}" for size in sizes)


def _direction(axis: list[float], about_centre: bool) -> str:
    """The axis in words: `-z` where it is a main axis, its components otherwise; `+-` for both ways."""
    for name, component in zip("xyz", axis, strict=True):
        if abs(abs(component) - 1.0) < 1e-6:
            return f"+-{name}" if about_centre else f"{'+' if component > 0.0 else '-'}{name}"
    components = f"({', '.join(f'{component:.2f}' for component in axis)})"
    return f"+-{components}" if about_centre else components
