"""Every word of MuJoCo's own schema is one that is read, one that is told, or one that is harmless."""

from __future__ import annotations

import re

import mujoco
import pytest

READ_OR_TOLD = {
    "joint": (
        "name class type group pos axis range limited ref actuatorfrclimited actuatorfrcrange",  # read
        "stiffness springref springdamper springyield damping frictionloss armature",  # told
        "margin solimpfriction solimplimit solreffriction solreflimit actuatorgravcomp user",  # of the solver
    ),
    "option": (
        "gravity wind density viscosity",
        "timestep tolerance ls_tolerance noslip_tolerance ccd_tolerance sleep_tolerance impratio",
        "integrator cone jacobian solver iterations ls_iterations noslip_iterations ccd_iterations",
        "sdf_iterations sdf_initpoints magnetic o_margin o_solref o_solimp o_friction",
        "actuatorgroupdisable apirate collision",
    ),
    "tendon": (
        "stiffness springlength springyield limited range frictionloss damping armature",
        "class group name actuatorfrclimited actuatorfrcrange margin material rgba width user",
        "solimpfriction solimplimit solreffriction solreflimit",
    ),
    "flag": (
        "gravity spring",
        "actuation autoreset clampctrl constraint contact damper diagexact energy equality eulerdamp",
        "filterparent frictionloss fwdinv invdiscrete ipc island limit midphase multiccd nativeccd",
        "override refsafe sensor passive sleep speculative warmstart",
    ),
    "mujoco": (
        "compiler option default asset worldbody (world)body equality tendon actuator deformable extension",
        "include frame size statistic visual custom contact sensor keyframe model",
    ),
}
"""By section: words of the schema, what a tree takes of them or a note tells first."""


def schema(section: str) -> set[str]:
    """Attributes of a section where MuJoCo's list has it first; of the outermost element, its children."""
    lines = mujoco.mj_printSchema(False, False).splitlines()
    if section == "mujoco":
        return {line.split()[0] for line in lines if re.match(r"   \S", line)}
    found: set[str] = set()
    inside = False
    for line in lines:
        head = re.match(r"\s*(\w+) \([!*?R]\)\s*(.*)", line)
        if head:
            if inside:
                break
            inside = head[1] == section
            found |= set(head[2].split()) if inside else set()
        elif inside:
            found |= set(line.split())
    return found


@pytest.mark.parametrize("section", READ_OR_TOLD)
def test_a_new_word_of_mujoco_is_noticed(section: str) -> None:
    known = set(" ".join(READ_OR_TOLD[section]).split())
    found = schema(section)
    assert len(found) > 10
    assert found - known == set(), "new in MuJoCo: is it read, told or harmless (`mjcf_unread`)?"
