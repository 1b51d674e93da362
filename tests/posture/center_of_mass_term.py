"""A term as somebody else would add it: the centre of mass of each agent no lower than a height."""

from __future__ import annotations

from collections.abc import Iterator

import casadi as ca
import numpy as np
import pinocchio as pin

from evodesign.posture.terms.base import Body, BodyTerm, MeasuredBody, Residual, Row


def mass_height(lowest: float) -> BodyTerm:
    """The term for a lowest height [m]."""

    def rows(body: Body) -> Iterator[Row]:
        """Height of the centre of mass above the ground; a half's pairs count twice."""
        mirror, weighted, mass = body.form.mirror, 0.0, 0.0
        for link in body.part.links:
            count = 1.0 if mirror is None or mirror.is_middle(link.name) else 2.0
            height = body.poses[link.name].point(ca.vertcat(*link.inertia.center))[2]
            weighted += count * link.inertia.mass * height
            mass += count * link.inertia.mass
        yield Row("mass_height", weighted / mass, lowest, np.inf, ("mass_height",), posture_only=True)

    def residuals(body: MeasuredBody) -> Iterator[Residual]:
        """How much too low pinocchio finds it [m]."""
        model = body.state.body.model
        height = pin.centerOfMass(model, model.createData(), body.state.coordinates)[2]
        short = max(0.0, lowest - float(height))
        yield Residual("mass_height", short, "m", "the height of the mass", posture_only=True)

    return BodyTerm("mass_height", rows=rows, residuals=residuals)
