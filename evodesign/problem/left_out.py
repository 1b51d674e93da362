"""What a problem leaves out of its model, or takes because its file does not say: a sentence each.

Only the file's text is read, and of it the keys in question: a look at a run loads no solver, and runs of
other versions are told of as well.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator

import msgspec

from evodesign.human.measured_posture import USUAL_POSTURE, HumanPosture
from evodesign.mechanics.payload import WRIST_MOMENT
from evodesign.records import ProblemSource


class _Load(msgspec.Struct, frozen=True):
    """What a load's hands pass, as in `PayloadTable`."""

    grasp: str = "point"
    hand_moment_n_m: float | None = None


class _Person(msgspec.Struct, frozen=True):
    """What a person's spine does, as in `HumanTable`; of a URDF's nothing is known."""

    urdf: str | None = None
    joint_ranges: str | None = None
    posture: str = USUAL_POSTURE

    @property
    def zigzags(self) -> bool:
        """Whether its lumbar joints may bend against each other, and farther than backs do."""
        coupled = self.joint_ranges not in (None, "separate")
        return self.urdf is None and not coupled and self.posture != HumanPosture.MEASURED


class _Sketch(msgspec.Struct, frozen=True):
    """The tables in question, as in `ProblemFile`."""

    payload: _Load | tuple[_Load, ...] = ()
    human: _Person | tuple[_Person, ...] = ()
    collisions: object = None


def left_out(source: ProblemSource) -> tuple[str, ...]:
    """A sentence for each of: bodies without collisions, moments of rigid hands, spines without coupling.

    Args:
        source: of a problem; of a text that is no problem file nothing is said.
    """
    try:
        problem = msgspec.convert(tomllib.loads(source.text), _Sketch)
    except (tomllib.TOMLDecodeError, msgspec.ValidationError, RecursionError):
        return ()
    return tuple(_sentences(problem))


def _sentences(problem: _Sketch) -> Iterator[str]:
    if problem.collisions is None:
        yield "no [collisions]: bodies may pass through each other, through the load and the floor"
    loads = problem.payload if isinstance(problem.payload, tuple) else (problem.payload,)
    moments = [load.hand_moment_n_m for load in loads if load.grasp == "rigid"]
    if None in moments:
        yield (
            f"no hand_moment_n_m: a rigid hand passes at most {WRIST_MOMENT:g} N m about each axis, what "
            "wrists bear (Delp, Grierson and Buchanan 1996)"
        )
    if math.inf in moments:
        yield "hand_moment_n_m = inf: hands twist the load with any moment, more than wrists bear"
    people = problem.human if isinstance(problem.human, tuple) else (problem.human,)
    if any(person.zigzags for person in people):
        yield (
            'joint_ranges = "separate": every joint of a spine has all of its own range, and bends further '
            "than backs do"
        )
