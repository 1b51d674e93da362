"""How designs did beside people drawn from a distribution of measured ones."""

from __future__ import annotations

from evodesign.records.evaluations import Assessment
from evodesign.tasks import Record


class SampledDesign(Record, frozen=True):
    """A design beside the people of one sample.

    Attributes:
        sample: its number, from 1; it is the problem's `posture_sample`.
        design: number of the evaluation that the design is in the run.
        assessment: as of any evaluation.
        seconds: that it took.
    """

    sample: int
    design: int
    assessment: Assessment
    seconds: float


class SampledPeople(Record, frozen=True):
    """What is kept of all samples of a run.

    Attributes:
        problem: digest of the run's problem.
        versions: of the packages by which it was evaluated.
        samples: how many were asked for.
        reference: number of the design that others are compared with; None for none.
        designs: in the order in which they were evaluated.
    """

    problem: str
    versions: dict[str, str]
    samples: int
    reference: int | None
    designs: tuple[SampledDesign, ...]

    def __repr__(self) -> str:
        return f"<{len(self.designs)} evaluations beside {self.samples} samples of people>"
