"""How results spread over samples of people, as tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from evodesign.analysis.people_spread import NEGLIGIBLE, Moments, PeopleSpread, QuantitySpread
from evodesign.cli.output import heading, rounded
from evodesign.cli.tables.table import FittedTable, names, numbers, titled
from evodesign.records import Constraint, Objective

CAPTION = "mean ± standard deviation over people of the measured distribution (docs/person.md)"


def spread_table(
    spread: PeopleSpread, objectives: Sequence[Objective], constraints: Sequence[Constraint]
) -> FittedTable:
    """A row for each sampled design: on how many fronts it is, and its quantities.

    Args:
        spread: of the designs.
        objectives: of the problem.
        constraints: of the problem.
    """
    headings = _headings(objectives, constraints)
    varying = [name for name in headings if name in _varying(spread)]
    compared = (
        []
        if spread.reference is None
        else [f"{name} less that of design {spread.reference}" for name in varying]
    )
    columns = numbers("design", "on the front", *(headings[name] for name in headings), *compared)
    title = f"{len(spread.designs)} designs beside {spread.samples} samples of people"
    table = titled(title, columns, caption=CAPTION)
    for number, own in spread.designs.items():
        cells = [moments_text(own.quantities[name].values, own.samples) for name in headings]
        if compared:
            cells += [difference_text(own.quantities[name], own.samples) for name in varying]
        table.add_row(number, f"{own.on_front} of {spread.samples}", *cells)
    return table


def quantities_table(
    spread: PeopleSpread,
    number: int,
    objectives: Sequence[Objective],
    constraints: Sequence[Constraint],
    means: Mapping[str, float],
    reference: str,
) -> FittedTable:
    """A row for each quantity of a design.

    Args:
        spread: of the design and others.
        number: of the design.
        objectives: of the problem.
        constraints: of the problem.
        means: the quantities beside the mean people.
        reference: what the reference design is called.
    """
    own, compared = spread.designs[number], spread.reference not in (None, number)
    further = numbers(f"less that of {reference}", f"better than {reference}") if compared else []
    columns = [*names("quantity"), *numbers("mean person", "people"), *further]
    table = titled("", columns, caption=CAPTION)
    for name, title in _headings(objectives, constraints).items():
        each = own.quantities[name]
        cells = [rounded(means.get(name)), moments_text(each.values, own.samples)]
        if compared:
            count = each.difference.count if each.difference is not None else 0
            better = "-" if each.better is None else f"{each.better} of {count}"
            cells += [difference_text(each, own.samples), better]
        table.add_row(title, *cells)
    return table


def moments_text(moments: Moments | None, samples: int) -> str:
    """`118.9 ± 3.2`; the mean alone where nothing spreads, a dash for none.

    `(7 of 10)` follows where the quantity exists in some of the samples only.
    """
    if moments is None:
        return rounded(None)
    some = f" ({moments.count} of {samples})" if moments.count < samples else ""
    spread = f" ± {moments.deviation:.2g}" if moments.deviation is not None and moments.spreads else ""
    return f"{rounded(moments.mean)}{spread}{some}"


def difference_text(quantity: QuantitySpread, samples: int) -> str:
    """The same of the difference to the reference; zero where a solver leaves more open."""
    values, found = quantity.values, quantity.difference
    if values is not None and found is not None:
        size = abs(found.mean) + (found.deviation or 0.0)
        if size <= NEGLIGIBLE * abs(values.mean):
            return "0"
    return moments_text(found, samples)


def _headings(objectives: Sequence[Objective], constraints: Sequence[Constraint]) -> dict[str, str]:
    """Of all quantities, by name."""
    found = {each.name: heading(each) for each in objectives}
    return found | {each.name: f"{each.name} [{each.unit}]" for each in constraints if each.name not in found}


def _varying(spread: PeopleSpread) -> set[str]:
    """Names of quantities that depend on the people."""
    return {
        name
        for own in spread.designs.values()
        for name, each in own.quantities.items()
        if each.values is not None and each.values.spreads
    }
