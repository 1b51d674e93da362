"""Motors that are mounted offset are at the same place in both links of their joint."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from evodesign.report.cad.parts import parts_of
from tests.report.cad.robots import designed


def test_a_motor_is_at_one_place_in_both_links_and_in_the_root(repository: Path) -> None:
    tree, materials = designed(repository, "icub_geometry", 5)
    motors = parts_of(tree, materials).motors
    for motor in motors:
        through_child = motor.joint.parent_from_child @ motor.child_from_motor
        for name in ("rotation", "translation"):
            wanted = np.array(getattr(motor.link_from_motor, name), float)
            np.testing.assert_allclose(np.array(getattr(through_child, name), float), wanted, atol=1e-12)
    offsets = [np.linalg.norm(np.array(motor.child_from_motor.translation, float)) for motor in motors]
    assert sum(offset > 0.01 for offset in offsets) == 5  # hips and waist
