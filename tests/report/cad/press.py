"""A mechanism with what shipped robots lack: overlapping solids, a slide, a mesh, a link of mass alone."""

from __future__ import annotations

import numpy as np
import trimesh

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Solid, Sphere
from evodesign.hardware.actuators import actuator_of_row, catalogue
from evodesign.tree.equip import with_actuators
from evodesign.tree.model import Joint, JointKind, Link, Mesh, Tree
from evodesign.tree.surface import surface_of

HOSTILE = "../ram | `rm`\n"
"""The name of a link, as a file may have it."""


def press() -> Tree:
    """frame -> ram (slide) -> knob (turns, with a motor); a cover of a mesh and a bolt of a mass alone."""
    sides = (
        Solid(Box(0.3, 0.2, 0.1), Placement(), 2700.0, 0.004, 0.2),
        Solid(Box(0.1, 0.2, 0.4), Placement(translation=(0.1, 0.0, 0.15)), 2700.0, 0.004, 0.1),
    )
    ball = trimesh.creation.icosphere(radius=50.0)
    surface = surface_of(np.array(ball.vertices), np.array(ball.faces), float(ball.volume))
    heavy = Inertia(0.5, (0.0, 0.0, 0.01), ((1e-4, 0.0, 0.0), (0.0, 1e-4, 0.0), (0.0, 0.0, 1e-4)))
    links = (
        Link("frame", sides),
        Link(HOSTILE, (Solid(Cylinder(0.04, 0.3), Placement(), 7850.0),)),
        Link("knob", (Solid(Sphere(0.05), Placement(), 1200.0, 0.003),)),
        Link("cover", own_inertia=heavy, meshes=(Mesh("cover.stl", (1e-3, 1e-3, 1e-3), surface=surface),)),
        Link("bolt", own_inertia=heavy),
        Link("tip"),
    )
    joints = (
        Joint("slide", JointKind.PRISMATIC, "frame", HOSTILE, at(0.1, 0.0, 0.5), (0.0, 0.0, 1.0), 0.0, 0.2),
        Joint("turn", JointKind.CONTINUOUS, HOSTILE, "knob", at(0.0, 0.0, 0.19), (0.6, 0.0, 0.8)),
        Joint("cover", JointKind.FIXED, "frame", "cover", at(-0.2, 0.0, 0.0)),
        Joint("bolt", JointKind.FIXED, "frame", "bolt", at(0.0, 0.1, 0.0)),
        Joint("tip", JointKind.FIXED, "knob", "tip", at(0.0, 0.0, 0.1)),
    )
    tree = Tree("press", links, joints)
    return with_actuators(tree, {"turn": actuator_of_row(catalogue()["X6-60"])})


def at(x: float, y: float, z: float) -> Placement:
    return Placement(translation=(x, y, z))
