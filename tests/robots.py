"""Public models of humanoids of other make: of the extra `robots`, and of robosuite without its needs."""

from __future__ import annotations

import sys
import sysconfig
from pathlib import Path

SHARED = Path(sysconfig.get_path("purelib")) / "cmeel.prefix" / "share" / "example-robot-data" / "robots"
ROBOSUITE = Path(sysconfig.get_path("purelib")) / "robosuite" / "models" / "assets" / "robots"
ICUB = Path(sys.prefix) / "share" / "iCub" / "robots"

HUMANOIDS = {
    "talos": SHARED / "talos_data" / "robots" / "talos_full_v2.urdf",
    "romeo": SHARED / "romeo_description" / "urdf" / "romeo.urdf",
    "g1": SHARED / "g1_description" / "urdf" / "g1_29dof_rev_1_0.urdf",
    "icub_reduced": SHARED / "icub_description" / "robots" / "icub_reduced.urdf",
    "icub": ICUB / "iCubGazeboV2_5" / "model.urdf",
}
"""Their URDF files by name."""

MJCF_HUMANOIDS = {"gr1": ROBOSUITE / "gr1" / "robot.xml"}
"""MJCF files of others."""

NO_HUMANOID = SHARED / "tiago_description" / "robots" / "tiago.urdf"
"""A robot on wheels."""


def robots_installed() -> bool:
    """Whether all of them are there."""
    return all(path.is_file() for path in (*HUMANOIDS.values(), *MJCF_HUMANOIDS.values(), NO_HUMANOID))
