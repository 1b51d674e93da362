"""Tables of what spreads over samples of people."""

from __future__ import annotations

from evodesign.analysis.people_spread import Moments, QuantitySpread, people_spread
from evodesign.cli.tables.spread import difference_text, moments_text, quantities_table, spread_table
from evodesign.cli.tables.table import FittedTable
from tests.analysis.test_people_spread import BOUND, EVERYONE, OBJECTIVES


def rows(table: FittedTable) -> list[list[str]]:
    return [[cell.plain for cell in cells] for cells, _ in table._rows]


def test_a_front_on_which_three_designs_swap_is_shown_as_such() -> None:
    table = spread_table(people_spread(OBJECTIVES, BOUND, EVERYONE, 0), OBJECTIVES, BOUND)
    fronts = {row[0]: row[1] for row in rows(table)}
    assert fronts == {"0": "0 of 4", "3": "1 of 4", "5": "1 of 4", "8": "2 of 4", "9": "4 of 4"}
    heads = [column.header for column in table.columns]
    assert heads[-2:] == ["human_torque less that of design 0", "back_compression less that of design 0"]
    design = rows(table)[1]
    assert design[2:] == ["112 ± 9.1", "1.2", "3002 ± 1.3", "-29 ± 8.4", "0"]


def test_a_card_compares_a_design_with_the_reference() -> None:
    found = people_spread(OBJECTIVES, BOUND, EVERYONE, 0)
    means = {"human_torque": 108.0, "reach_height": 1.2}
    table = quantities_table(found, 3, OBJECTIVES, BOUND, means, "design 0")
    assert [column.header for column in table.columns][-1] == "better than design 0"
    assert rows(table) == [
        ["human_torque [N m] ↓", "108", "112 ± 9.1", "-29 ± 8.4", "4 of 4"],
        ["reach_height [m] ↑", "1.2", "1.2", "0.2", "4 of 4"],
        ["back_compression [N]", "-", "3002 ± 1.3", "0", "-"],
    ]
    alone = quantities_table(found, 0, OBJECTIVES, BOUND, means, "design 0")
    assert [column.header for column in alone.columns] == ["quantity", "mean person", "people"]


def test_what_a_solver_leaves_open_is_no_difference() -> None:
    quantity = QuantitySpread(Moments(100.0, 3.0, 10), Moments(2e-8, 1e-8, 10), 0)
    assert difference_text(quantity, 10) == "0"
    assert moments_text(quantity.values, 10) == "100 ± 3"
    assert moments_text(None, 10) == "-"
    assert moments_text(Moments(2.5, None, 1), 10) == "2.5 (1 of 10)"
    assert moments_text(Moments(2.5, 0.5, 7), 10) == "2.5 ± 0.5 (7 of 10)"
