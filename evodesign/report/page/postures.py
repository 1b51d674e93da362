"""Which postures are in the page: those of the marked designs, then those of the front, as many as fit."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from msgspec.structs import replace

from evodesign.records import CaseDetail, Detail, Evaluation
from evodesign.report.page.content import Mark
from evodesign.report.subset import subsample

MOMENTS = 9
"""Moments of a lift that are in the page."""

MOST_NUMBERS = 450_000
"""Of all postures in the page, two and a half bytes each: 1000 designs of the default problem."""


def shown_cases(cases: Sequence[CaseDetail]) -> tuple[CaseDetail, ...]:
    """Logged cases as the page has them: few moments of a lift, and no disturbances, which it never shows."""
    return tuple(
        replace(case, instants=tuple(replace(instant, disturbed={}) for instant in case.instants))
        for case in (each.thinned(MOMENTS) for each in cases)
    )


def details_shown(
    details: Sequence[Detail], marked: Sequence[Mark], shown: Sequence[Evaluation], front: Collection[int]
) -> tuple[dict[int, Detail], tuple[str, ...]]:
    """Details that go into the page, by number, and a note on designs of the front that go without.

    Args:
        details: that the log holds.
        marked: designs whose postures must be there.
        shown: evaluations in the page.
        front: numbers of the front.
    """
    known = {detail.evaluation: detail for detail in details}
    first = list(dict.fromkeys(mark.number for mark in marked if mark.number in known))
    of_front = [each.number for each in shown if each.number in front and each.number not in first]
    others = [number for number in of_front if number in known]
    kept = subsample(others, max(0, most_designs(details) - len(first)))
    notes = []
    if len(kept) < len(others):
        notes.append(
            f"postures of {len(first) + len(kept)} of {len(first) + len(others)} designs are in this page; "
            "evodesign report RUN --designs NUMBER,NUMBER puts in those that you name"
        )
    if lost := len(of_front) - len(others):
        notes.append(
            f"the log holds no postures of {lost} designs of the front; evodesign report RUN "
            "--designs NUMBER,NUMBER solves those that you name anew"
        )
    return {number: known[number] for number in (*first, *kept)}, tuple(notes)


def most_designs(details: Sequence[Detail]) -> int:
    """How many designs have their postures in the page."""
    numbers = max((_numbers(shown_cases(detail.cases)) for detail in details), default=0)
    return MOST_NUMBERS // max(numbers, 1)


def _numbers(cases: Sequence[CaseDetail]) -> int:
    """How many numbers postures have that differ by more than their sign, for others are written once."""
    numbers: list[float] = []
    for instant in (instant for case in cases for instant in case.instants):
        for agent in instant.agents.values():
            for by_joint in (agent.joints_rad, agent.torques_n_m, agent.speeds_rad_s):
                numbers += by_joint.values()
            for row in (*agent.wrenches.values(), agent.base_position_m, agent.base_rpy_rad):
                numbers += row
    return len({round(abs(number), 5) for number in numbers})
