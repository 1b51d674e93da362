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

SHAPELESS = SHARED / "simple_humanoid_description" / "urdf" / "simple_humanoid.urdf"
"""A humanoid without any shape, and with moments of inertia that no foot has."""

NO_HUMANOIDS = {
    "tiago": (
        SHARED / "tiago_description" / "robots" / "tiago.urdf",
        "the lowest link is 'wheel_right_link'",
    ),
    "alex": (
        SHARED / "alex_description" / "urdf" / "alex_nub_hands.urdf",
        "are arms, which begin above 'Pelvis'",
    ),
    "baxter": (SHARED / "baxter_description" / "urdf" / "baxter.urdf", "the lowest link is 'base'"),
    "human": (
        SHARED / "human_description" / "robots" / "human.urdf",
        "mirror images across z, which is to be up",
    ),
    "anymal": (SHARED / "anymal_b_simple_description" / "robots" / "anymal.urdf", "found four or more"),
    "panda": (SHARED / "panda_description" / "urdf" / "panda.urdf", "the lowest link is 'panda_link0'"),
}
"""Robots on wheels, of an upper body, on a stand, on their side, on four legs, of one arm; why in words."""


def robots_installed() -> bool:
    """Whether all of them are there."""
    refused = (path for path, _ in NO_HUMANOIDS.values())
    return all(
        path.is_file() for path in (*HUMANOIDS.values(), *MJCF_HUMANOIDS.values(), SHAPELESS, *refused)
    )
