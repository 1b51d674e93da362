"""What a design is built of: told, exported, and held by MuJoCo's motors."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path

import msgspec
import mujoco
import numpy as np
import pytest

from evodesign.body.material import CATALOGUE
from evodesign.body.placement import Placement
from evodesign.evaluation.bill import bill_of_materials, link_materials
from evodesign.evaluation.evaluate import Evaluator, detail_of
from evodesign.hardware.structure import STRENGTHS, Failure, wall_buckling_stress
from evodesign.mechanics.agent import ROBOT, SIDES
from evodesign.mechanics.balance import GRAVITY
from evodesign.mechanics.beams import beams_of
from evodesign.posture.results import AgentPosture
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.problem.source import read_source
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.hardware_quantities import link_safety
from evodesign.quantities.objectives import objective_kinds
from evodesign.tree.equip import actuators_of
from evodesign.tree.frames import link_frames
from evodesign.tree.kinematics import euler_rotation
from evodesign.tree.mjcf_write import mjcf_text
from evodesign.tree.model import Tree
from evodesign.tree.urdf_read import InertiaRule, read_urdf
from evodesign.tree.urdf_write import urdf_text

DESIGNS = 3


@pytest.fixture(scope="module")
def hardware(repository: Path) -> DesignProblem:
    """The problem of hardware as it comes, solved by IPOPT on CasADi's virtual machine."""
    source = read_source(repository / "problems" / "icub_hardware.toml")
    built = build_problem(msgspec.structs.replace(source, method="ipopt"))
    return replace(built, options=replace(built.options, compiled=False, tolerance=1e-11))


@pytest.fixture(scope="module")
def results(hardware: DesignProblem) -> list[DesignResult]:
    evaluator, generator = Evaluator(hardware), np.random.default_rng(4)
    found: list[DesignResult] = []
    while len(found) < DESIGNS:
        genome = tuple(generator.uniform(0.2, 0.6, len(hardware.space.parameters)).tolist())
        result = evaluator.solve(hardware.space.values(genome))
        if all(solution.solved for solution in result.cases):
            found.append(result)
    return found


@pytest.mark.slow
def test_the_bill_adds_up_and_names_what_governs(
    hardware: DesignProblem, results: list[DesignResult]
) -> None:
    result = results[0]
    bill = bill_of_materials(hardware, result.tree, [detail_of(solution) for solution in result.cases])
    mass = bill["mass_kg"]
    assert mass["total"] == pytest.approx(objective_kinds()["mass"].value(result))
    assert mass["actuators"] == pytest.approx(objective_kinds()["actuator_mass"].value(result))
    assert mass["total"] == pytest.approx(mass["actuators"] + mass["structure"] + mass["rest"])
    assert sum(row["mass_kg"] for row in bill["joints"].values()) == pytest.approx(mass["actuators"])
    for parameter, margin in zip(hardware.space.parameters, result.values, strict=True):
        if parameter.joints:
            rows = [bill["joints"][joint] for joint in parameter.joints]
            assert max(row["share"] for row in rows) == pytest.approx(1.0 / margin, rel=2e-4)
    by = {row["actuator"]: row["asked_by"] for row in bill["joints"].values() if row["share"] > 0.2}
    assert by["knee"] in ("squat", "one leg")
    assert by["elbow"].endswith(" m")
    wall = bill["links"]["l_forearm"]
    assert (wall["material"], wall["wall_m"]) == ("aluminium_6061", 0.002)
    least = min(row["safety_factor"] for row in bill["links"].values() if row["safety_factor"])
    assert least == pytest.approx(objective_kinds()["least_safety_factor"].value(result), rel=1e-12)
    alone = {case.name for case in hardware.stances}
    assert wall["safety_case"] in {str(solution.case.task) for solution in result.cases} | alone


@pytest.mark.slow
def test_links_tire_by_the_stresses_that_their_safety_factors_tell(results: list[DesignResult]) -> None:
    result, cycles = results[0], 1.2e6
    walls = tuple(replace(wall, cycles=cycles) for wall in result.space.walls)
    living = replace(result, space=replace(result.space, walls=walls))
    material = STRENGTHS["aluminium_6061"]
    breaks = {
        beam.link: {
            Failure.YIELD: material.strength,
            Failure.WALL: wall_buckling_stress(beam.section, material),
        }
        for beam in beams_of(result.tree, link_frames(result.tree, Placement(), {}))
    }
    stresses = []
    for solution in result.cases:
        robot = result.scene_of(solution.case).robot
        for link, safety in link_safety(robot, solution.postures[ROBOT]).items():
            stresses.append(breaks[link][safety.failure] / safety.factor)
    amplitude = (14479.0 / cycles**0.5 + 96.5) * 1e6
    goodman = 1.0 / (max(stresses) / 2.0 / amplitude + max(stresses) / 2.0 / 310e6)
    assert objective_kinds()["fatigue_safety_factor"].value(living) == pytest.approx(goodman)
    assert objective_kinds()["fatigue_safety_factor"].value(result) is None


@pytest.mark.slow
def test_a_problem_without_hardware_has_no_bill(problem: DesignProblem) -> None:
    assert bill_of_materials(problem, problem.scene.robot.tree, []) == {}


@pytest.mark.slow
def test_an_exported_urdf_has_limits_and_masses(results: list[DesignResult]) -> None:
    tree = results[0].tree
    again = read_urdf(urdf_text(tree), "robot.urdf", InertiaRule.FILE)
    for joint, actuator in actuators_of(tree).items():
        limits = again.joint_by_name[joint]
        assert (limits.effort, limits.velocity) == (float(actuator.peak), float(actuator.speed))
    for link in tree.links:
        assert float(again.link_by_name[link.name].mass) == pytest.approx(float(link.mass), abs=1e-12)


def posed(tree: Tree, posture: AgentPosture) -> tuple[mujoco.MjModel, mujoco.MjData]:
    model = mujoco.MjModel.from_xml_string(mjcf_text(tree, GRAVITY, {}).partition("?>")[2])
    data = mujoco.MjData(model)
    data.qpos[:3] = posture.base_position
    rotation = np.array(euler_rotation(posture.base_angles), float)
    mujoco.mju_mat2Quat(data.qpos[3:7], rotation.ravel())
    for joint, position in posture.joints.items():
        data.qpos[model.joint(joint).qposadr] = position
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    return model, data


@pytest.mark.slow
def test_mujoco_holds_every_posture_with_motors_within_their_rating(
    hardware: DesignProblem, results: list[DesignResult]
) -> None:
    """Base and moving joints are at rest under weight, wrenches of hands and feet, and the motors."""
    robot = hardware.scene.robot
    for result in results:
        actuators = actuators_of(result.tree)
        for solution in result.cases:
            posture = solution.postures[ROBOT]
            model, data = posed(result.tree, posture)
            for side in SIDES:
                hand, sole = (data.body(robot.frame(f"{side}_{part}")) for part in ("hand", "foot"))
                turn = np.array(sole.xmat).reshape(3, 3)
                foot = posture.wrenches[f"{side}_foot"]
                for body, wrench in (
                    (hand, posture.wrenches[f"{side}_hand"]),
                    (sole, np.concatenate([turn @ foot[:3], turn @ foot[3:]])),
                ):
                    mujoco.mj_applyFT(
                        model, data, wrench[:3], wrench[3:], body.xpos, body.id, data.qfrc_applied
                    )
            for joint, torque in posture.torques.items():
                assert abs(torque) <= float(actuators[joint].rated) + 1e-6
                data.actuator(joint).ctrl = torque
            mujoco.mj_forward(model, data)
            left = data.qfrc_bias - data.qfrc_applied - data.qfrc_actuator
            moving = [int(model.joint(joint).dofadr[0]) for joint in posture.torques]
            assert np.abs(left[moving]).max() < 1e-6
            assert np.abs(left[:6]).max() < 1e-5
            armature = model.dof_armature[moving]
            assert armature == pytest.approx([float(actuators[joint].inertia) for joint in posture.torques])


def test_links_are_of_the_materials_whose_densities_they_have(repository: Path) -> None:
    """Walls of a given one, and densities that a design chooses."""
    found = {}
    for name in ("icub_hardware", "icub_materials"):
        source = read_source(repository / "problems" / f"{name}.toml")
        problem = build_problem(source)
        own = {
            each["name"]: each["density_kg_per_m3"] for each in tomllib.loads(source.text).get("material", ())
        }
        densities = {each.name: each.density for each in CATALOGUE.values()} | own
        for seed in range(3):
            genome = np.random.default_rng(seed).uniform(size=len(problem.space.parameters)).tolist()
            values = problem.space.given(problem.space.values(tuple(genome)), {})
            tree = problem.space.resized(problem.scene.designed_tree, values)
            for link, material in link_materials(problem.space, tree).items():
                density = float(tree.link_by_name[link].solids[0].density)
                assert density == pytest.approx(densities[material]), (name, link)
                found.setdefault(name, set()).add(material)
    assert found["icub_hardware"] == {"aluminium_6061"}
    assert len(found["icub_materials"]) > 1
