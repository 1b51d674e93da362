"""Public humanoids read, written unscaled, and read again by pinocchio: the robot of the original file.

One that is averaged with its mirror image differs from that by what the note on it says.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from lxml import etree

from evodesign.guess.body_plan import body_plan
from evodesign.guess.parameters import groups
from evodesign.guess.problem_text import guessed_problem
from evodesign.problem.build import build_problem
from evodesign.problem.source import source_of
from evodesign.tree.model import Tree
from evodesign.tree.resize import resize
from evodesign.tree.symmetry import mirror_of
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from evodesign.tree.urdf_write import urdf_text
from tests.robots import HUMANOIDS

POSTURES = 50

pytestmark = pytest.mark.needs_robots


def model_of(text: str) -> pin.Model:
    return pin.buildModelFromXML(text, pin.JointModelFreeFlyer())


def configuration(model: pin.Model, base: np.ndarray, positions: dict[str, float]) -> np.ndarray:
    """Base pose and joint positions; joints without a position stand at zero."""
    q = pin.neutral(model)
    q[:7] = base
    for name, position in positions.items():
        joint = model.joints[model.getJointId(name)]
        unbounded = joint.nq == 2
        q[joint.idx_q : joint.idx_q + joint.nq] = (
            (np.cos(position), np.sin(position)) if unbounded else position
        )
    return q


@pytest.mark.parametrize("name", HUMANOIDS)
def test_a_robot_written_unscaled_is_the_original(name: str) -> None:
    original_text = Path(HUMANOIDS[name]).read_text(encoding="utf-8")
    tree = read_urdf(original_text, name, InertiaRule.FILE)
    grown = {link for each in groups(body_plan(tree)) for link in each.links}
    links = [link.name for link in tree.links if link.name in grown and link.inertia.mass]
    unscaled = resize(tree, dict.fromkeys(links, 1.0), {})
    original, written = model_of(original_text), model_of(urdf_text(unscaled))
    moving = [joint for joint in original.names[2:] if joint in set(written.names)]
    assert len(moving) >= 25
    assert pin.computeTotalMass(original) == pytest.approx(pin.computeTotalMass(written), rel=1e-9)
    frames = [
        (original.getBodyId(link.name), written.getBodyId(link.name))
        for link in tree.links
        if original.existBodyName(link.name)
    ]
    assert len(frames) > 35
    rng = np.random.default_rng(1)
    one, other = original.createData(), written.createData()
    for _ in range(POSTURES):
        positions = {joint: rng.uniform(-1.0, 1.0) for joint in moving}
        base = np.concatenate([rng.uniform(-1.0, 1.0, 3), pin.Quaternion(pin.SE3.Random().rotation).coeffs()])
        q, q_written = configuration(original, base, positions), configuration(written, base, positions)
        pin.framesForwardKinematics(original, one, q)
        pin.framesForwardKinematics(written, other, q_written)
        for here, there in frames:
            assert np.allclose(one.oMf[here].homogeneous, other.oMf[there].homogeneous, atol=1e-9)
        assert np.allclose(
            pin.centerOfMass(original, one, q), pin.centerOfMass(written, other, q_written), atol=1e-9
        )
        gravity = pin.computeGeneralizedGravity(original, one, q)
        gravity_written = pin.computeGeneralizedGravity(written, other, q_written)
        for joint in ("root_joint", *moving):
            a, b = (model.joints[model.getJointId(joint)] for model in (original, written))
            assert np.allclose(
                gravity[a.idx_v : a.idx_v + a.nv],
                gravity_written[b.idx_v : b.idx_v + b.nv],
                atol=1e-9 * 1e3,
                rtol=1e-9,
            )


STATED = re.compile(r"([\d.]+) (%|mm) in the (mass|centre of mass|inertia) of link (\w+)(?: / (\w+))?")
ROUNDED, UNTOLD = 0.05, 2e-6
"""Of two digits, the largest share by which a figure is rounded; and what is not worth a word."""


@pytest.mark.slow
@pytest.mark.parametrize("name", ["talos", "g1", "icub"])
def test_an_averaged_robot_differs_from_the_original_by_what_the_note_says(name: str) -> None:
    """A pair's figure is what lies between its two links, of which each moves by half."""
    text = HUMANOIDS[name].read_text(encoding="utf-8")
    tree = read_urdf(text, name, InertiaRule.FILE)
    tables = tomllib.loads(guessed_problem(tree, str(HUMANOIDS[name])).text)
    tables["robot"]["meshes"] = False
    problem = build_problem(source_of(tables))
    robot, space = problem.scene.robot.tree, problem.space
    exported = urdf_text(space.resized(robot, space.unscaled(robot)))
    before, after = (inertias(each, tree) for each in (text, exported))
    changes = {link: changed(before[link], after[link]) for link in before}
    partners = mirror_of(robot).links
    assert len(changes) > 25
    (note,) = problem.symmetry_notes
    stated = {
        figure: (float(size), unit, one, other or one)
        for size, unit, figure, one, other in STATED.findall(note)
    }
    assert stated
    for index, figure in enumerate(("mass", "centre of mass", "inertia")):
        if figure not in stated:
            assert max(change[index] for change in changes.values()) < UNTOLD
            continue
        size, unit, one, other = stated[figure]
        size /= 100.0 if unit == "%" else 1000.0
        for link, change in changes.items():
            share = 1.0 if partners[link] == link else 0.5
            assert change[index] <= share * size * (1.0 + ROUNDED), (link, figure)
        moved = changes[one][index] + (changes[other][index] if other != one else 0.0)
        assert moved == pytest.approx(size, rel=ROUNDED), figure


def inertias(text: str, tree: Tree) -> dict[str, pin.Inertia]:
    """Of every link with mass, in the axes of the file's root with all joints at zero."""
    robot = etree.fromstring(text.encode())
    for joint in robot.findall("joint[@type='fixed']"):  # pinocchio makes one body of what is fixed
        joint.set("type", "prismatic")
        etree.SubElement(joint, "limit", lower="-1", upper="1", effort="1", velocity="1")
    model = model_of(etree.tostring(robot).decode())
    data = model.createData()
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    root_from_world = data.oMf[model.getBodyId(tree.root)].inverse()
    bodies = {link.name: model.frames[model.getBodyId(link.name)].parentJoint for link in tree.links}
    return {
        name: (root_from_world * data.oMi[body]).act(model.inertias[body])
        for name, body in bodies.items()
        if model.inertias[body].mass > 0.0
    }


def changed(before: pin.Inertia, after: pin.Inertia) -> tuple[float, float, float]:
    """Share of the mass, distance of the centres of mass [m], share of the largest moment.

    About the mean of two halves' centres, each d away from it, they have m (|d|^2 1 - d d^T) more.
    """
    apart = before.lever - after.lever
    halves = after.mass * (apart @ apart * np.eye(3) - np.outer(apart, apart))
    gap = np.abs(before.inertia - (after.inertia - halves)).max()
    return (
        abs(before.mass - after.mass) / after.mass,
        float(np.linalg.norm(apart)),
        float(gap / np.linalg.eigvalsh(before.inertia)[-1]) if gap else 0.0,
    )
