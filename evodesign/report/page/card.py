"""What the page's card of a design shows beside postures and objectives.

The bill of materials, what a posture does to the person, how torques spread over the people of the problem,
and of a lift what its moments would take at rest.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from statistics import mean, stdev
from typing import Any

import numpy as np

from evodesign.evaluation.bill import bill_of_materials
from evodesign.evaluation.logged_posture import logged_posture
from evodesign.human.back import ACTION_LIMIT
from evodesign.mechanics.agent import ROBOT, Agent
from evodesign.mechanics.floating_base import ROOT
from evodesign.mechanics.scene import Scene, scene_of
from evodesign.posture.check import AgentModel
from evodesign.posture.design_checkers import with_hardware
from evodesign.posture.terms.torque import asked
from evodesign.problem.build import DesignProblem
from evodesign.quantities.ergonomics import of_most_loaded_back
from evodesign.records import CaseDetail, CaseOutcome, InstantDetail, Lift
from evodesign.report.page.content import ActuatorContent, EffortContent, HardwareContent, WallContent
from evodesign.tree.equip import actuators_of
from evodesign.tree.model import Tree


def hardware_content(
    problem: DesignProblem, tree: Tree, cases: Sequence[CaseDetail]
) -> HardwareContent | None:
    """What a design is built of; None for a problem without hardware.

    Args:
        problem: whose design it is.
        tree: of the design, numbers.
        cases: its postures.
    """
    bill = bill_of_materials(problem, tree, cases)
    if not bill:
        return None
    groups: dict[str, dict[str, Mapping[str, Any]]] = {}
    for joint, row in bill["joints"].items():
        groups.setdefault(row["actuator"], {})[joint] = row
    return HardwareContent(
        actuators=tuple(_actuator(name, rows, tree, cases) for name, rows in groups.items()),
        walls=tuple(
            WallContent(link, *(row[key] for key in WallContent.__struct_fields__[1:]))
            for link, row in bill["links"].items()
        ),
        mass_kg=bill["mass_kg"],
        governs=tuple(bill["governs"]),
        least_clearance=bill.get("least_clearance"),
    )


def _actuator(
    name: str, rows: Mapping[str, Mapping[str, Any]], tree: Tree, cases: Sequence[CaseDetail]
) -> ActuatorContent:
    """A group of joints with the same actuator, told by the joint that is used most."""
    joint = max(rows, key=lambda each: rows[each]["share"])
    row, actuator = rows[joint], actuators_of(tree)[joint]
    duty, warming = actuator.duty, actuator.motor(_held(rows, cases)).value
    return ActuatorContent(
        name=name,
        model=row["model"] or "",
        count=len(rows),
        rated_torque_n_m=row["rated_torque_n_m"],
        peak_torque_n_m=row["peak_torque_n_m"],
        mass_kg=row["mass_kg"],
        price_eur=row["price_eur"],
        joint=joint,
        asked_n_m=row["asked_n_m"],
        asked_by=row["asked_by"],
        share=row["share"],
        loss_w=sum(each["loss_w"] for each in rows.values()),
        winding_c=None if duty is None else duty.temperature(warming / row["rated_torque_n_m"]),
        winding_limit_c=None if duty is None else duty.limit,
    )


def _held(joints: Collection[str], cases: Sequence[CaseDetail]) -> float:
    """The largest torque of some of the robot's joints in any case, disturbed or not [N m]."""
    held = []
    for instant in (instant for case in cases for instant in case.instants):
        held.append(instant.agents[ROBOT].torques_n_m)
        held += [agents[ROBOT].torques_n_m for agents in instant.disturbed.values()]
    return max((abs(torques.get(joint, 0.0)) for torques in held for joint in joints), default=0.0)


def effort_content(scenes: Sequence[Scene], cases: Sequence[CaseDetail]) -> tuple[EffortContent, ...]:
    """One for each case, that of a lift at the person's largest torques; none of robots alone.

    Of several people who hold the load together it is that of the one whose back bears most.

    Args:
        scenes: every person with every load.
        cases: a design's postures, of these people.
    """
    return tuple(_of(scenes, case) for case in cases if scene_of(scenes, case.case.pair).people)


def _of(scenes: Sequence[Scene], case: CaseDetail) -> EffortContent:
    """Newtons as whole numbers, and what is not known as null."""
    asked = of_most_loaded_back(scene_of(scenes, case.case.pair).people, case.hardest.agents)
    back, tires = asked.back, asked.endurance
    return EffortContent(
        back_n=None if back is None else round(back.compression),
        shear_n=None if back is None else round(back.shear),
        back_limit_n=round(ACTION_LIMIT),
        load_n_m=round(asked.load_torque, 1),
        seconds=None if tires is None else round(tires.known_seconds),
        longer=tires is not None and tires.seconds > tires.known_seconds,
        tires="" if tires is None else tires.joint.joint,
        rula=None if asked.rula is None else asked.rula.whole,
        reba=None if asked.reba is None else asked.reba.whole,
    )


TORQUE = re.compile(r"(worst_|q\d+_)?(robot|human)_torque")
"""Quantities of which the log has the value of every case."""


def over_people(names: Iterable[str], cases: Sequence[CaseOutcome]) -> dict[str, tuple[float, float]]:
    """Mean and standard deviation over people of each of some quantities; nothing for one person.

        of one person   what the objective is of that person's cases alone: mean, largest or quantile of |tau|
        told            mean and standard deviation (n - 1) of these over the people

    Args:
        names: of quantities; those of which the log has only the value of the design are left out.
        cases: of the design; with lifts nothing is told, whose mean over time the log has not.
    """
    people = dict.fromkeys(case.case.person for case in cases)
    if len(people) < 2 or any(isinstance(case.case.task, Lift) for case in cases):
        return {}
    found = {}
    for name in names:
        if not (torque := TORQUE.fullmatch(name)):
            continue
        way, role = torque[1] or "", torque[2]
        by_person = [
            [norm for case in cases if case.case.person == person for norm in _norms(case, role)]
            for person in people
        ]
        if all(None not in values and values for values in by_person):
            each = [_together([norm for norm in values if norm is not None], way) for values in by_person]
            found[name] = mean(each), stdev(each)
    return found


def _norms(case: CaseOutcome, role: str) -> list[float | None]:
    """Undisturbed and under every disturbance."""
    own = {"robot": case.robot_torque_norm, "human": case.human_torque_norm}[role]
    return [own, *(norms.get(role) for norms in case.disturbed.values())]


def _together(norms: Sequence[float], way: str) -> float:
    if way == "worst_":
        return max(norms)
    return float(np.quantile(norms, float(way[1:-1]) / 100.0) if way else np.mean(norms))


Torques = dict[str, dict[str, float]]
"""By agent and joint [N m]."""


class StaticTorques:
    """Joint torques of the postures of lifts, with the wrenches that act there, if nothing moved.

    What a torque has beyond that accelerates the agent's own links and rotors. The load's inertia is in the
    wrenches of the hands.

    Args:
        scenes: every team with every load, all with the same robots.
    """

    def __init__(self, scenes: Sequence[Scene]) -> None:
        self._scenes = scenes

    @cached_property
    def _models(self) -> dict[tuple[str, str], list[AgentModel]]:
        known = {id(agent): _model(agent) for scene in self._scenes for agent in scene.agents}
        return {scene.pair: [known[id(agent)] for agent in scene.agents] for scene in self._scenes}

    def of(
        self, robot: Tree, cases: Sequence[CaseDetail]
    ) -> tuple[tuple[tuple[Torques, ...], ...], dict[str, float]]:
        """Torques at each moment of each case, and the robot's limits [N m].

        Of no moment where the load is held still; nothing at all where no load is lifted.

        Args:
            robot: the design's tree.
            cases: its postures, of the problem's people and loads.
        """
        lifted = [isinstance(case.case.task, Lift) for case in cases]
        if not any(lifted):
            return (), {}
        models = {pair: with_hardware(own, robot) for pair, own in self._models.items()}
        torques = tuple(
            tuple(_static(models[case.case.pair], each) for each in case.instants if moves)
            for case, moves in zip(cases, lifted, strict=True)
        )
        own = self._scenes[0].robot
        return torques, dict(own.torque_limits) if own.limits_torques else {}


def _model(agent: Agent) -> AgentModel:
    """An agent that is not asked for its distances."""
    return AgentModel.of(replace(agent, collisions=None), agent.tree)


def _static(models: Sequence[AgentModel], instant: InstantDetail) -> Torques:
    found: Torques = {}
    for model in models:
        posture = logged_posture(instant.agents[model.agent.name])
        rows = asked(model.agent, posture, model.at(posture), (0.0, 0.0, 0.0))
        found[model.agent.name] = dict(zip(model.agent.joints, rows[ROOT:].tolist(), strict=True))
    return found
