"""What the card says of the person: back, holding time and scores of the posture that is shown."""

from __future__ import annotations

from collections.abc import Sequence

from evodesign.human.back import ACTION_LIMIT
from evodesign.mechanics.scene import Scene, scene_of
from evodesign.quantities.ergonomics import of_most_loaded_back
from evodesign.records import CaseDetail
from evodesign.report.page.content import EffortContent


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
