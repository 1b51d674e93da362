"""Which angles of a joint the posture problem looks among."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import pytest

from evodesign.body.placement import Placement
from evodesign.posture.terms.floating_base import joint_ranges
from evodesign.tree.model import Joint, JointKind

PI, INF = math.pi, math.inf


def found(lower: float, upper: float) -> tuple[float, float]:
    joint = Joint("j", JointKind.REVOLUTE, "a", "b", Placement(), lower=lower, upper=upper)
    form: Any = SimpleNamespace(
        joints=("j",),
        agent=SimpleNamespace(
            tree=SimpleNamespace(joint_by_name={"j": joint}), bent_ranges={}, chosen_ranges={}
        ),
    )
    return joint_ranges(form)[0]


@pytest.mark.parametrize(
    "limits", [(-1.0, 2.0), (0.0, 2 * PI), (3.5, 5.0), (-6.0, -4.0), (12.0, 15.0), (7.0, 7.0)]
)
def test_a_range_of_no_more_than_a_turn_is_kept_wherever_it_lies(limits: tuple[float, float]) -> None:
    assert found(*limits) == limits


@pytest.mark.parametrize(
    ("limits", "window"),
    [
        ((-INF, INF), (-PI, PI)),
        ((-2 * PI, 2 * PI), (-PI, PI)),
        ((-10.0, 10.0), (-PI, PI)),
        ((0.0, 10.0), (0.0, 2 * PI)),
        ((-1.0, 7.0), (-1.0, 2 * PI - 1.0)),
        ((3.5, INF), (3.5, 3.5 + 2 * PI)),
        ((-INF, -4.0), (-4.0 - 2 * PI, -4.0)),
    ],
)
def test_of_more_than_a_turn_one_is_looked_at_which_has_every_posture(
    limits: tuple[float, float], window: tuple[float, float]
) -> None:
    assert found(*limits) == pytest.approx(window, rel=1e-15)
    assert limits[0] <= found(*limits)[0] < found(*limits)[1] <= limits[1]
