"""How the results of designs spread over people drawn from a distribution of measured ones.

    mean +- deviation                   of a quantity over the samples
    mean +- deviation of differences    to a reference design, sample by sample
    on the front in k of n samples      front of the sampled designs beside the people of one sample

All designs are evaluated beside the same people, so that what two of them have in common drops out of their
difference. A sample counts for fronts once every sampled design has been evaluated in it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean, stdev
from typing import Any

from evodesign.analysis.front import front, to_minimise
from evodesign.records import Constraint, Evaluation, Objective, SampledDesign, SampledPeople
from evodesign.runlog.run import RunLog

NEGLIGIBLE = 1e-6
"""Deviation or gain, as a share of a value's size, that counts as none: solvers leave as much open."""


@dataclass(frozen=True, slots=True)
class Moments:
    """Mean and standard deviation (of a sample) of so many numbers; no deviation of fewer than two."""

    mean: float
    deviation: float | None
    count: int

    @classmethod
    def of(cls, values: Sequence[float]) -> Moments | None:
        """Those of numbers; None of none."""
        if not values:
            return None
        return cls(fmean(values), stdev(values) if len(values) > 1 else None, len(values))

    @property
    def spreads(self) -> bool:
        """Whether the numbers differ by more than a solver leaves open."""
        return self.deviation is not None and self.deviation > NEGLIGIBLE * abs(self.mean)


@dataclass(frozen=True, slots=True)
class QuantitySpread:
    """A quantity of a design over the samples.

    Args:
        values: over the samples in which it exists; None if there are none.
        difference: to the reference design's, over the samples in which both exist; None for no reference.
        better: in how many of these it is better than the reference's; None for a quantity without a sense.
    """

    values: Moments | None
    difference: Moments | None
    better: int | None


@dataclass(frozen=True, slots=True)
class DesignSpread:
    """A design over the samples.

    Args:
        samples: in which it was evaluated.
        feasible: in how many of them it is.
        on_front: in how many of the complete samples no other sampled design dominates it.
        quantities: objectives and other constrained quantities, by name.
    """

    samples: int
    feasible: int
    on_front: int
    quantities: Mapping[str, QuantitySpread]


@dataclass(frozen=True, slots=True)
class PeopleSpread:
    """All sampled designs.

    Args:
        samples: in which every design was evaluated.
        reference: number of the design that others are compared with; None for none.
        designs: by number.
    """

    samples: int
    reference: int | None
    designs: Mapping[int, DesignSpread]


def spread_of_run(run: RunLog, sampled: SampledPeople | None) -> PeopleSpread | None:
    """Of the samples that are kept of a run; None where there are none."""
    asked = [] if sampled is None else [each for each in sampled.designs if each.sample <= sampled.samples]
    if sampled is None or not asked:
        return None
    return people_spread(run.header.objectives, run.header.constrained, asked, sampled.reference)


def spread_among(spread: PeopleSpread, numbers: Sequence[int]) -> PeopleSpread | None:
    """That of some designs only; None where none of them was sampled. Fronts are those of all that were."""
    designs = {number: spread.designs[number] for number in numbers if number in spread.designs}
    return PeopleSpread(spread.samples, spread.reference, designs) if designs else None


def people_spread(
    objectives: Sequence[Objective],
    constraints: Sequence[Constraint],
    sampled: Iterable[SampledDesign],
    reference: int | None,
) -> PeopleSpread:
    """The spread of designs.

    Args:
        objectives: of the problem.
        constraints: of the problem.
        sampled: every design in every sample, as far as they were evaluated.
        reference: number of the design to compare with; None for none.
    """
    by_sample: dict[int, dict[int, Evaluation]] = {}
    for each in sampled:
        by_sample.setdefault(each.sample, {})[each.design] = Evaluation(
            number=each.design,
            generation=0,
            genome=(),
            assessment=each.assessment,
            seconds=each.seconds,
            worker="",
        )
    numbers = dict.fromkeys(number for found in by_sample.values() for number in found)
    complete = [found for found in by_sample.values() if found.keys() == numbers.keys()]
    fronts = [{each.number for each in front(objectives, found.values())} for found in complete]
    senses: dict[str, Objective | None] = {each.name: each for each in objectives}
    senses |= {each.name: None for each in constraints if each.name not in senses}
    designs = {}
    for number in numbers:
        own = [found for found in by_sample.values() if number in found]
        designs[number] = DesignSpread(
            samples=len(own),
            feasible=sum(found[number].feasible for found in own),
            on_front=sum(number in best for best in fronts),
            quantities={
                name: _quantity(name, sense, own, number, reference) for name, sense in senses.items()
            },
        )
    return PeopleSpread(len(complete), reference if reference in numbers else None, designs)


def _quantity(
    name: str,
    sense: Objective | None,
    samples: Sequence[Mapping[int, Evaluation]],
    number: int,
    reference: int | None,
) -> QuantitySpread:
    values = [value for found in samples if (value := _value(found[number], name)) is not None]
    others = [None if reference is None or reference == number else found.get(reference) for found in samples]
    pairs = [
        (value, compared)
        for found, other in zip(samples, others, strict=True)
        if other is not None
        if (value := _value(found[number], name)) is not None
        if (compared := _value(other, name)) is not None
    ]
    better, differences = None, [value - compared for value, compared in pairs]
    if sense is not None:
        least = [NEGLIGIBLE * abs(compared) for _, compared in pairs]
        gains = [-to_minimise(sense, difference) for difference in differences]
        better = sum(gain > few for gain, few in zip(gains, least, strict=True))
    return QuantitySpread(Moments.of(values), Moments.of(differences), better)


def _value(evaluation: Evaluation, name: str) -> float | None:
    assessment = evaluation.assessment
    return assessment.objectives.get(name, assessment.constrained.get(name))


def spread_sentence(spread: PeopleSpread) -> str:
    """How firmly the sampled designs stand on the front."""
    if not spread.samples:
        return "no sample of people has all designs yet"
    always = [n for n, each in spread.designs.items() if each.on_front == spread.samples]
    sometimes = [n for n, each in spread.designs.items() if 0 < each.on_front < spread.samples]
    many = len(spread.designs)
    parts = [f"{len(always)} of {many} designs are on the front in all"]
    if sometimes:
        listed = ", ".join(f"{n} in {spread.designs[n].on_front}" for n in sometimes)
        parts.append(f"{len(sometimes)} in some (design {listed})")
    if many > len(always) + len(sometimes):
        parts.append(f"{many - len(always) - len(sometimes)} in none")
    return f"over {spread.samples} samples of people: {', '.join(parts)}"


def spread_json(spread: PeopleSpread, number: int) -> dict[str, Any]:
    """A design's spread as a JSON object; its shape is a promise."""
    own = spread.designs[number]
    return {
        "samples": own.samples,
        "feasible": own.feasible,
        "on_front": own.on_front,
        "quantities": {name: _quantity_json(each) for name, each in own.quantities.items()},
    }


def all_spreads_json(spread: PeopleSpread) -> dict[str, Any]:
    """The spread of all sampled designs as a JSON object; its shape is a promise."""
    return {
        "samples": spread.samples,
        "reference": spread.reference,
        "designs": [{"id": number, **spread_json(spread, number)} for number in spread.designs],
    }


def _quantity_json(each: QuantitySpread) -> dict[str, Any] | None:
    found = _moments_json(each.values)
    if found is not None and each.difference is not None:
        better = {} if each.better is None else {"better": each.better}
        found["difference"] = {**(_moments_json(each.difference) or {}), **better}
    return found


def _moments_json(moments: Moments | None) -> dict[str, Any] | None:
    if moments is None:
        return None
    return {"mean": moments.mean, "deviation": moments.deviation, "samples": moments.count}
