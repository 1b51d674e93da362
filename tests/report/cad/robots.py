"""Robots of designs of shipped problems, without solving anything, and their URDF in pinocchio."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio

from evodesign.evaluation.bill import link_materials
from evodesign.problem.build import build_problem
from evodesign.problem.source import read_source
from evodesign.tree.model import Tree
from evodesign.tree.urdf_write import urdf_text


def designed(
    repository: Path, name: str, seed: int, sizes: tuple[float, float] = (5.0, 60.0)
) -> tuple[Tree, dict[str, str]]:
    """The robot of a random design, with the materials of its links; actuators are of such sizes [N m]."""
    space = (built := build_problem(read_source(repository / "problems" / f"{name}.toml"))).space
    rng = np.random.default_rng(seed)
    values = space.values(tuple(rng.uniform(size=len(space.parameters)).tolist()))
    rated = {each.name: float(rng.uniform(*sizes)) for each in space.parameters if each.joints}
    tree = space.resized(built.scene.designed_tree, space.given(values, rated))
    return tree, link_materials(space, tree)


def in_pinocchio(tree: Tree) -> pinocchio.Model:
    """The exported URDF of a tree, floating."""
    return pinocchio.buildModelFromXML(urdf_text(tree), pinocchio.JointModelFreeFlyer())


def frames_at_zero(model: pinocchio.Model) -> dict[str, pinocchio.SE3]:
    """The place of each body at joint angles of zero, in that of the root."""
    data = model.createData()
    pinocchio.framesForwardKinematics(model, data, pinocchio.neutral(model))
    return {
        frame.name: data.oMf[number]
        for number, frame in enumerate(model.frames)
        if frame.type == pinocchio.FrameType.BODY
    }


def axes_at_zero(model: pinocchio.Model) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """A point on the axis of each joint that turns, and its direction, by how it turns what it holds."""
    data, found = model.createData(), {}
    for name, number in ((name, model.getJointId(name)) for name in list(model.names)[2:]):
        places = []
        for angle in (0.0, 0.5):
            position = pinocchio.neutral(model)
            position[model.idx_qs[number]] = angle
            pinocchio.forwardKinematics(model, data, position)
            places.append(data.oMi[number].copy())
        turn = pinocchio.log3(places[1].rotation @ places[0].rotation.T)
        found[name] = (places[0].translation, turn / np.linalg.norm(turn))
    return found
