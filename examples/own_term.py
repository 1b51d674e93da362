"""A physical statement of your own: nobody's centre of mass is lower than 0.5 m. Half a minute.

A term enters every program, the independent check and the derivatives of the process that registers it. The
processes of a search would not know it: to search with it, put the term into a file of a checkout, in
`evodesign/posture/terms/`, with a line in `registry.py` there (CONTRIBUTING.md).

    python examples/own_term.py
"""

import os
import tomllib

import casadi as ca
import numpy as np
import pinocchio as pin

import evodesign
from evodesign.posture.terms.base import BodyTerm, Residual, Row
from evodesign.posture.terms.registry import TERMS

LOWEST = 0.5  # [m]


def rows(body):
    """In the programs: the height of the centre of mass; links with a mirror image count twice."""
    moment, mass, mirror = 0.0, 0.0, body.form.mirror
    for link in body.part.links:
        share = link.inertia.mass * (1.0 if mirror is None or mirror.is_middle(link.name) else 2.0)
        moment += share * body.poses[link.name].point(ca.vertcat(*link.inertia.center))[2]
        mass += share
    yield Row("mass_height", moment / mass, LOWEST, np.inf, ("mass_height",), posture_only=True)


def residuals(body):
    """In the check, by pinocchio: how much too low the centre of mass is [m]."""
    model = body.state.body.model
    height = pin.centerOfMass(model, model.createData(), body.state.coordinates)[2]
    yield Residual("mass_height", max(0.0, LOWEST - height), "m", "the height of the mass", posture_only=True)


tables = tomllib.loads(evodesign.open_problem("point-grasp").source.text)
tables["task"]["heights_m"] = [1.0]
tables["solver"] = {"start_portfolio": False, "compile": False}
tables["search"]["descriptor"] = [{"name": "lowest_reach"}]  # or no lower load is sought than tasks need
for words, term in {"without": None, "with": BodyTerm("mass_height", rows=rows, residuals=residuals)}.items():
    if term is not None:
        TERMS[term.name] = term
    os.environ["EVODESIGN_CACHE"] = f"cache_{words}_term"  # what is precomputed with it is kept apart
    design = evodesign.Problem.from_dict(tables).evaluate({})
    reach = (design.reach.lowest_m, design.reach.highest_m)
    print(f"{words} the term: loads from {reach[0]:.3f} to {reach[1]:.3f} m, {design.reason}")
