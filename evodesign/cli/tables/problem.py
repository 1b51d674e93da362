"""What a problem file was understood to mean, and from what the problem is solved, as tables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from rich.markup import escape
from rich.table import Table

from evodesign.cli.output import printable, rounded
from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.collision.pairs import JOINED, STILL
from evodesign.guess.preflight import Finding
from evodesign.mechanics.agent import ROBOT
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.seeking.start_portfolio import StartPortfolio
from evodesign.problem.build import DesignProblem
from evodesign.problem.inertia_rules import RuleDifference
from evodesign.problem.model_json import model_json
from evodesign.records import Case, Constraint
from evodesign.violations import bounds_text

CAPTION = (
    "sizes [m]: box x, y, z; cylinder radius, length; sphere radius; density [kg/m^3]\n"
    "grows along: direction in the link's frame in which it gets longer; -: keeps its size"
)


def model_tables(problem: DesignProblem) -> tuple[FittedTable | Table, ...]:
    """What was understood, for a person: agents, task, the robot's links, and the parameters."""
    shown = model_json(problem)
    of_materials = [*names("material"), *numbers("density [kg/m^3]"), *names("source")]
    materials = [
        (each["name"], each["density_kg_per_m3"], each["source"]) for each in shown.get("materials", ())
    ]
    return (
        _agents_table(problem.name, shown["agents"]),
        _task_table(shown, problem.constraints),
        _links_table(shown["links"]),
        _parameters_table(shown["parameters"]),
        *([titled("materials", of_materials, materials)] if materials else []),
        *([_exempt_table(shown["collisions"]["exempt"])] if "collisions" in shown else []),
    )


def rules_table(differences: Iterable[RuleDifference]) -> FittedTable:
    """Where shapes and file disagree about a link's inertia."""
    columns = [*names("link", "taken"), *numbers("apart [mm]", "moments taken", "and otherwise")]
    caption = 'apart: the centres of mass by [robot] inertia = "shapes" and "file"; principal moments [g m^2]'
    table = titled("links whose shapes and inertia disagree", columns, caption=caption)
    for each in differences:
        moments = (", ".join(f"{1e3 * moment:.3g}" for moment in one) for one in each.moments_kg_m2)
        table.add_row(each.link, str(each.taken), f"{1e3 * each.center_m:.1f}", *moments)
    return table


def findings_table(findings: Iterable[Finding]) -> FittedTable:
    """What was tried before anything long begins."""
    rows = ((each.item, each.found or "fails") for each in findings)
    return titled("tried with the robot of the file", names("item", "found"), rows)


def _agents_table(name: str, agents: Sequence[dict[str, Any]]) -> FittedTable:
    """Robot and people; of several people, also who each is and how tall."""
    several = any("who" in agent for agent in agents)
    who = names("agent", *(("person",) if several else ()), "model")
    table = titled(name, [*who, *numbers("links", "joints", "that move", "mass [kg]")])
    for agent in agents:
        counts = (agent["links"], agent["joints"], agent["moving_joints"])
        table.add_row(
            agent["name"],
            *([agent.get("who", "")] if several else []),
            f"{agent['sex']}, {rounded(agent['stature_m'])} m" if agent.get("sex") else agent["model"],
            *map(str, counts),
            agent["mass_kg"],
        )
    return table


def _task_table(shown: dict[str, Any], constraints: Sequence[Constraint]) -> Table:
    table = Table(show_header=False)
    for load in shown["payloads"] if "payloads" in shown else [shown["payload"]]:
        mass, size = f"{load['mass_kg']:g} kg", f"{' x '.join(map(rounded, load['size_m']))} m"
        name = load.get("payload_name", mass)
        told = mass if name == mass else f"{printable(name)}: {mass}"
        table.add_row("load", escape(f"{told}, {size}"))
    if "collisions" in shown:
        kept = shown["collisions"]
        counts = " and ".join(f"{len(pairs)} of the {name}" for name, pairs in kept["pairs"].items())
        margin = f"{1e3 * kept['margin_m']:g} mm"
        table.add_row("kept apart", f"pairs of bodies, by {margin}: {counts}")
    if shown["heights_m"]:
        table.add_row("heights", ", ".join(f"{height:g}" for height in shown["heights_m"]) + " m")
    for lift in shown.get("lifts", ()):
        way = f"{lift['from_m']:g} to {lift['to_m']:g} m in {lift['seconds']:g} s"
        table.add_row("lift", f"{way}, {lift['profile'].replace('_', ' ')}")
    for disturbance in shown.get("disturbances", ()):
        table.add_row("disturbance", escape(_disturbance_text(disturbance)))
    table.add_row("objectives", ", ".join(shown["objectives"]))
    if constraints:
        bounds = (f"{constraint.name} {bounds_text(constraint)}" for constraint in constraints)
        table.add_row("constraints", escape(", ".join(bounds)))
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


def _links_table(links: Iterable[dict[str, Any]]) -> FittedTable:
    """Every link that has mass; the frames without are named below."""
    frames = [link["link"] for link in links if link["kind"] == "frame"]
    caption = f"{CAPTION}\nwithout mass: {printable(', '.join(frames))}" if frames else CAPTION
    columns = names("link", "shape", "grows along", "density", "mass [kg]")
    table = titled("links of the robot", columns, caption=caption)
    for link in links:
        if link["kind"] != "frame":
            _add_link(table, link)
    return table


def _add_link(table: FittedTable, link: dict[str, Any]) -> None:
    """A link's rows, one for each solid."""
    figures = (rounded(link["density_kg_per_m3"]), rounded(link["mass_kg"]))
    for number, shape in enumerate(link["solids"] or [link["kind"]]):
        name, density, mass = (link["link"], *figures) if number == 0 else ("", "", "")
        longer = link["axis"] is not None and number in link["longer_solids"]
        grows = _direction(link["axis"], link["about_centre"]) if longer else "-"
        table.add_row(name, shape, grows, density, mass)


def _parameters_table(parameters: Iterable[dict[str, Any]]) -> FittedTable:
    table = titled("parameters", names("parameter", "from", "to", "unit", "links or joints"))
    for parameter in parameters:
        bounds = (rounded(parameter["lower"]), rounded(parameter["upper"]), parameter["unit"])
        links = ", ".join([*(link["link"] for link in parameter["links"]), *parameter.get("joints", ())])
        if "materials" in parameter:
            links = f"{links}; of {', '.join(parameter['materials'])}"
        table.add_row(parameter["name"], *bounds, links)
    return table


def _exempt_table(exempt: Mapping[str, Sequence[Mapping[str, Any]]]) -> FittedTable:
    """Pairs of bodies that may overlap, by their reason; those joined by a joint are counted alone."""
    rows: dict[tuple[str, str], list[str]] = {}
    for agent, pairs in exempt.items():
        for pair in pairs:
            rows.setdefault((agent, pair["reason"]), []).append(" and ".join(pair["bodies"]))
    table = titled("bodies that may overlap", names("agent", "reason", "pairs"))
    for (agent, reason), found in sorted(rows.items(), key=lambda row: row[0][0] != ROBOT):
        told = f"{len(found)} pairs (--json lists them)" if reason in (JOINED, STILL) else ", ".join(found)
        table.add_row(agent, reason, told)
    return table


def _direction(axis: list[float], about_centre: bool) -> str:
    """The axis in words: `-z` where it is a main axis, its components otherwise; `+-` for both ways."""
    for name, component in zip("xyz", axis, strict=True):
        if abs(abs(component) - 1.0) < 1e-6:
            return f"+-{name}" if about_centre else f"{'+' if component > 0.0 else '-'}{name}"
    components = f"({', '.join(f'{component:.2f}' for component in axis)})"
    return f"+-{components}" if about_centre else components


def _portfolios(problem: DesignProblem, known: Precomputed) -> Iterator[tuple[str, StartPortfolio, str]]:
    """Each portfolio with what it is for and the unit in which it misses."""
    if not problem.start_portfolio:
        return
    yield "highest load", known.highest, "m"
    yield "lowest load", known.lowest, "m"
    own = {_named(f"posture at {case.task}", case): found for case, found in known.postures.items()}
    lifts = {_named(f"lift from {case.task}", case): found for case, found in known.lifts.items()}
    for name, found in {**own, **lifts}.items():
        yield name, found, "100 N^2 m^2"


def _named(subject: str, case: Case) -> str:
    return ", ".join(part for part in (subject, case.label) if part)


def starts_table(problem: DesignProblem, known: Precomputed) -> FittedTable:
    """Coverage of each portfolio of starts."""
    columns = [*names("problem"), *numbers("starts", "designs tried", "within 1 %", "worst miss")]
    table = titled("start portfolios, and designs that they were not made from", columns)
    for name, found, unit in _portfolios(problem, known):
        coverage = found.coverage
        share = f"{coverage.share:.1%}" if coverage.designs else "-"
        miss = f"{rounded(coverage.worst)} {unit}" if coverage.good < coverage.designs else "none"
        table.add_row(name, len(found.starts), coverage.designs, share, miss)
    return table


def starts_json(problem: DesignProblem, known: Precomputed) -> dict[str, Any]:
    """The same as a JSON object; its shape is a promise."""
    return {
        "problem": problem.name,
        "portfolios": [
            {
                "for": name,
                "starts": len(found.starts),
                "designs_tried": found.coverage.designs,
                "designs_good": found.coverage.good,
                "worst_miss": found.coverage.worst,
                "unit": unit,
            }
            for name, found, unit in _portfolios(problem, known)
        ],
    }
