"""Between programs and postures: values of variables as whole postures, and known postures as starts."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from evodesign.mechanics.scene import Scene
from evodesign.nlp.program import Array, Program, Start
from evodesign.posture.assemble import Slot
from evodesign.posture.results import AgentPosture, Instant
from evodesign.posture.symmetry import Form

Layout = Mapping[Slot, str]
"""Names of variables by where they belong."""


def layout_of(program: Program, *parties: str) -> Layout:
    """Where the variables of an assembled program belong: those of some parties, or all."""
    slots = {v.key: v.name for v in program.variables if isinstance(v.key, Slot)}
    return {slot: name for slot, name in slots.items() if not parties or slot.party in parties}


def instants_of(
    layout: Layout,
    forms: Sequence[Form],
    scene: Scene,
    values: Mapping[str, Array],
    times: Sequence[float] = (0.0,),
) -> tuple[Instant, ...]:
    """Whole postures from a solution, with what is carried under each of the scene's disturbances.

    Args:
        layout: of both agents' variables.
        forms: of both agents.
        scene: whose disturbances they are.
        values: of a solution, by variable name, SI units.
        times: of each instant [s].
    """
    named: dict[tuple[str, int, int], dict[str, Array]] = defaultdict(dict)
    for slot, name in layout.items():
        named[slot.party, slot.instant, slot.load_case][slot.part] = values[name]

    def postures(instant: int, load_case: int) -> dict[str, AgentPosture]:
        return {form.agent.name: form.expand(parts(instant, form.agent.name, load_case)) for form in forms}

    def parts(instant: int, party: str, load_case: int) -> dict[str, Array]:
        return named[party, instant, 0] | named[party, instant, load_case]

    return tuple(
        Instant(
            time,
            postures(number, 0),
            {each.name: postures(number, case) for case, each in enumerate(scene.disturbances.cases, 1)},
        )
        for number, time in enumerate(times)
    )


def start_from(program: Program, forms: Sequence[Form], instants: Sequence[Instant]) -> Start:
    """Known postures as values of a program's variables; free hands pass what their agent's do.

    Args:
        program: assembled.
        forms: of robot and person.
        instants: one for each of the program's.
    """
    by_name = {form.agent.name: form for form in forms}
    known: dict[str, Any] = {}
    for slot, name in layout_of(program).items():
        cases = [instants[slot.instant].postures, *instants[slot.instant].disturbed.values()]
        if slot.load_case < len(cases):
            parts = by_name[slot.party].parts(cases[slot.load_case][slot.party])
            known[name] = parts[slot.part][: program.counts[name]]
    return known


def filled(start: Start, program: Program) -> Start:
    """A start in which each disturbed load case begins as the undisturbed one, unless it says otherwise."""
    layout = layout_of(program)
    twins = {name: layout[replace(slot, load_case=0)] for slot, name in layout.items() if slot.load_case}
    return {**{name: start[twin] for name, twin in twins.items() if twin in start}, **start}
