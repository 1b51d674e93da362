"""All terms, in the order in which they enter a program."""

from __future__ import annotations

from collections.abc import Mapping

from evodesign.posture.terms.base import BodyTerm, SystemTerm
from evodesign.posture.terms.collisions import COLLISIONS, OVERLAP
from evodesign.posture.terms.coupled_joints import COUPLED_JOINTS
from evodesign.posture.terms.feet import FEET, UPRIGHT
from evodesign.posture.terms.feet_gap import FEET_GAP
from evodesign.posture.terms.floating_base import FLOATING_BASE
from evodesign.posture.terms.gaze import GAZE
from evodesign.posture.terms.grasp import GRASP
from evodesign.posture.terms.grip import GRIP
from evodesign.posture.terms.load import LOAD
from evodesign.posture.terms.measured_posture import MEASURED_POSTURE
from evodesign.posture.terms.regularisation import POSTURE_REGULARISATION, WRENCH_REGULARISATION
from evodesign.posture.terms.stance import STANCE
from evodesign.posture.terms.torque import TORQUE

TERMS: Mapping[str, BodyTerm | SystemTerm] = {
    "floating_base": FLOATING_BASE,
    "grasp": GRASP,
    "feet": FEET,
    "stance": STANCE,
    "feet_gap": FEET_GAP,
    "collisions": COLLISIONS,
    "overlap": OVERLAP,
    "torque": TORQUE,
    "posture_regularisation": POSTURE_REGULARISATION,
    "wrench_regularisation": WRENCH_REGULARISATION,
    "load": LOAD,
    "upright": UPRIGHT,
    "coupled_joints": COUPLED_JOINTS,
    "grip": GRIP,
    "gaze": GAZE,
    "measured_posture": MEASURED_POSTURE,
}
