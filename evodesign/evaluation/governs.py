"""What governs walls and actuators of a design, in a sentence each.

A wall is governed by the way in which it gives way where its safety factor is the least that the problem
takes (1, or the lower bound of `least_safety_factor`); by stiffness where the bound of `hand_deflection`
is reached and the link has a share in it; by the least wall that can be made where it is no thicker; else by
nothing that is computed: the problem's file or the design's choice. An actuator is governed by the case that
asks most of it: rated torque in a case of the lift, peak torque in a load case.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from evodesign.evaluation.sizing import BOUNDS
from evodesign.problem.build import DesignProblem
from evodesign.quantities.design_result import WORST

LEAST_WALL, STIFFNESS, GIVEN, CHOSEN = "least wall", "stiffness", "problem file", "design"
"""What governs a wall that bears more than it is asked for."""

AT_BOUND = 1.001
"""Value over bound up to which a bound counts as reached."""

WORDS: Mapping[str, str] = {
    GIVEN: "nothing but the problem file",
    CHOSEN: "nothing but the design's choice",
}


def governing(
    problem: DesignProblem, links: Mapping[str, Mapping[str, Any]], deflections: Mapping[str, float]
) -> dict[str, str]:
    """What governs each hollow link.

    Args:
        problem: with constraints and walls.
        links: rows of the bill.
        deflections: of the hands [mm], by case.
    """
    bounds = {constraint.name: constraint for constraint in problem.constraints}
    safety = bounds.get("least_safety_factor")
    wanted = 1.0 if safety is None or safety.lower is None else safety.lower
    values = list(deflections.values()) or [0.0]
    now = {"hand_deflection": sum(values) / len(values), f"{WORST}hand_deflection": max(values)}
    upper = {name: bounds[name].upper for name in now if name in bounds}
    stiff = any(bound is not None and now[name] * AT_BOUND >= bound for name, bound in upper.items())
    found = {}
    for wall in problem.space.walls:
        for link in wall.links:
            row = links[link]
            if row["safety_factor"] is not None and row["safety_factor"] <= AT_BOUND * wanted:
                found[link] = row["safety_mode"]
            elif stiff and row["deflection_share"]:
                found[link] = STIFFNESS
            elif row["wall_m"] <= AT_BOUND * wall.least:
                found[link] = LEAST_WALL
            else:
                found[link] = CHOSEN if wall.thickness is None else GIVEN
    return found


def sentences(problem: DesignProblem, bill: Mapping[str, Any]) -> Iterator[str]:
    """What governs walls, and what governs actuators; nothing of what the problem does not have."""
    if bill["links"]:
        yield f"walls: {'; '.join(_walls(problem, bill['links']))}"
    if bill["joints"]:
        yield f"actuators: {'; '.join(_actuators(problem, bill['joints']))}"


def _walls(problem: DesignProblem, links: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    groups: dict[str, list[str]] = {}
    for link, row in links.items():
        groups.setdefault(row["governed_by"], []).append(link)
    for by, members in sorted(groups.items(), key=lambda group: -len(group[1])):
        thin = sorted({links[link]["wall_m"] for link in members})
        wall = " to ".join(f"{1e3 * each:.3g}" for each in dict.fromkeys((thin[0], thin[-1])))
        what = "the least wall that can be made" if by == LEAST_WALL else WORDS.get(by, by)
        whom = "" if len(groups) == 1 else f" {len(members)} of {len(links)} links"
        yield f"{what} ({wall} mm) governs{whom}"
    beams = {link: row for link, row in links.items() if row["safety_factor"] is not None}
    if beams:
        link = min(beams, key=lambda name: beams[name]["safety_factor"])
        row = beams[link]
        how = f"{row['safety_mode']} of {link}, {row['safety_case']}"
        yield f"the least safety factor is {row['safety_factor']:.3g} ({how})"
        stiffest = max(beams, key=lambda name: beams[name]["deflection_share"] or 0.0)
        if share := beams[stiffest]["deflection_share"]:
            yield f"{stiffest} has the largest share of the hands' deflection ({share:.1%})"


def _actuators(problem: DesignProblem, joints: Mapping[str, Mapping[str, Any]]) -> Iterator[str]:
    """What asks most of each group of joints, groups with the same answer together."""
    alone = {case.name for case in problem.stances}
    most: dict[str, Mapping[str, Any]] = {}
    for row in joints.values():
        most[row["actuator"]] = max(row, most.get(row["actuator"], row), key=lambda each: each["share"])
    groups: dict[str, list[str]] = {}
    for group, row in most.items():
        torque = "peak torque" if row["asked_by"] in alone else "rated torque"
        by = f"{torque} ({row['asked_by']})" if row["asked_by"] else "nothing that was solved"
        if row["rated_torque_n_m"] <= BOUNDS[0]:
            by = "the smallest size"
        groups.setdefault(by, []).append(group)
    for by, members in groups.items():
        yield f"{by} governs {', '.join(members)}"
