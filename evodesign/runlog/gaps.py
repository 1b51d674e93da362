"""What a run's log lacks, as far as the records and segments that stand in it tell.

Segments and generations are counted from zero without gaps, and a generation begins when the one before it is
concluded. So a number that is missing below a later one was there, and is lost. Evaluations of the present
generation come in any order, those of an asynchronous run in the order of their numbers.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from evodesign.records import Evaluation, Front, Generation, RunHeader

MOST_LISTED = 20
"""Ranges of numbers in one sentence."""


def missing(known: Iterable[int], end: int) -> list[range]:
    """The numbers from zero to an end (not included) that are not known, as ranges in order."""
    found, start = [], 0
    for number in sorted({number for number in known if 0 <= number < end}):
        if number > start:
            found.append(range(start, number))
        start = number + 1
    return [*found, range(start, end)] if start < end else found


def consecutive(numbers: Iterable[int]) -> list[range]:
    """Numbers in order, consecutive ones as one range."""
    ranges: list[range] = []
    for number in sorted(set(numbers)):
        if ranges and number == ranges[-1].stop:
            ranges[-1] = range(ranges[-1].start, number + 1)
        else:
            ranges.append(range(number, number + 1))
    return ranges


def listed(ranges: Sequence[range]) -> str:
    """Ranges as text, such as `3, 7 to 9`; of very many the first ones, and how many numbers follow."""
    shown = [
        str(each.start) if len(each) == 1 else f"{each.start} to {each.stop - 1}"
        for each in ranges[:MOST_LISTED]
    ]
    further = sum(len(each) for each in ranges[MOST_LISTED:])
    return ", ".join([*shown, *([f"and {further} more"] if further else [])])


def record_gaps(
    header: RunHeader,
    evaluations: Sequence[Evaluation],
    generations: Sequence[Generation],
    fronts: Sequence[Front],
) -> list[str]:
    """A sentence for each kind of record of which some are lost.

    Args:
        header: of the run.
        evaluations: in order of number, each once.
        generations: in order of number, each once.
        fronts: in order of generation, each once.
    """
    latest = max((evaluation.generation for evaluation in evaluations), default=0)
    ordered = header.search.asynchronous
    last = next((each.number for each in reversed(evaluations) if ordered or each.generation < latest), -1)
    concluded = max((state.evaluations for state in generations), default=0)
    member = max((number for front in fronts for number in front.evaluations), default=-1)
    lost = {
        "evaluations": missing((each.number for each in evaluations), max(last + 1, concluded, member + 1)),
        "states of generations": _below_last([state.number for state in generations]),
        "fronts of generations": _below_last([front.generation for front in fronts]),
    }
    return [f"missing {what}: {listed(ranges)}" for what, ranges in lost.items() if ranges]


def _below_last(numbers: Sequence[int]) -> list[range]:
    return missing(numbers, numbers[-1] if numbers else 0)


def segment_gaps(files: Iterable[int], sessions: Iterable[int]) -> list[str]:
    """A sentence on segments that are lost; none if there are none.

    Args:
        files: numbers of the segments that are there.
        sessions: numbers of the segments whose headers are there: a merged segment has those of many.
    """
    there = set(files)
    lost = missing({*there, *sessions}, max(there, default=0))
    if not lost:
        return []
    many = sum(map(len, lost)) > 1
    return [f"segment{'s' * many} {listed(lost)} of the run {'are' if many else 'is'} missing"]
