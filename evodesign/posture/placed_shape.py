"""Convex shapes at poses that are expressions: how far they reach along a direction, and from each other."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from evodesign.collision.supports import ConvexShape
from evodesign.tree.kinematics import Expression, Pose, vector

SHAPE = 36
"""Numbers of a placed shape: centre, axes, box, disc, ball."""

ROUNDING = 0.01
"""By how much a corner is rounded off, as a share of the half side."""

Plane = tuple[Expression, Expression]
"""A unit normal n and an offset d [m]: points x with n . x + d = 0."""


@dataclass(frozen=True, slots=True)
class PlacedShape:
    """A shape somewhere.

    Args:
        centre: where it is [m].
        axes: of its link, as columns; those of a mirror image are mirrored.
        box, disc, ball: columns that span its box, disc and ball, in these axes [m].
    """

    centre: Expression
    axes: Expression
    box: Expression
    disc: Expression
    ball: Expression

    @property
    def numbers(self) -> Expression:
        """All of it as one column of `SHAPE`."""
        return ca.vertcat(
            self.centre, *(ca.vec(each) for each in (self.axes, self.box, self.disc, self.ball))
        )

    @staticmethod
    def of(numbers: Expression) -> PlacedShape:
        """That which a column of numbers stands for."""
        columns = ca.reshape(numbers, 3, SHAPE // 3)
        return PlacedShape(columns[:, 0], *ca.horzsplit(columns[:, 1:], [0, 3, 6, 8, 11]))

    def mirrored(self, plane: Plane) -> PlacedShape:
        """Its mirror image in a plane."""
        normal, offset = plane
        away = ca.dot(normal, self.centre) + offset
        axes = self.axes - 2.0 * normal @ (normal.T @ self.axes)
        return PlacedShape(self.centre - 2.0 * away * normal, axes, self.box, self.disc, self.ball)

    @property
    def sides(self) -> list[Expression]:
        """Along a box's sides and a cylinder's axis; of no particular length."""
        columns = [column for column in ca.horzsplit(self.box) if not column.is_zero()]
        if not self.disc.is_zero():
            columns.append(ca.cross(self.disc[:, 0], self.disc[:, 1]))
        return [self.axes @ column for column in columns]

    def support(self, direction: Expression) -> Expression:
        """How far it reaches from its centre along a unit vector, with corners rounded off [m]."""
        return self.support_within(self.axes.T @ direction)

    def support_within(self, direction: Expression) -> Expression:
        """The same along a unit vector in the link's axes [m]."""
        reach = 0.0
        for column in ca.horzsplit(self.box):
            if not column.is_zero():
                size = ca.sumsqr(column)
                reach += ca.sqrt(ca.dot(column, direction) ** 2 + ROUNDING**2 * size)
        if not self.disc.is_zero():
            size = ca.sumsqr(self.disc[:, 0])
            reach += ca.sqrt(ca.sumsqr(self.disc.T @ direction) + ROUNDING**2 * size)
        if not self.ball.is_zero():  # a row that is off has no direction, and a derivative all the same
            size = ca.sumsqr(self.ball[:, 0])
            reach += ca.sqrt(ca.sumsqr(self.ball.T @ direction) + ROUNDING**2 * size)
        return reach

    def apart(self, other: PlacedShape, direction: Expression) -> Expression:
        """How far another one is from this one along a unit vector [m]."""
        between = ca.dot(direction, other.centre - self.centre)
        return between - self.support(direction) - other.support(direction)

    def apart_along(self, other: PlacedShape, numbers: Expression) -> Expression:
        """How far another one is from this one along the direction of a meeting's numbers [m]."""
        mine, its = numbers[1:4], numbers[4:7]
        from_mine, from_its = self.axes @ mine, other.axes @ its
        between = ca.dot(from_mine + from_its, other.centre - self.centre)
        within = self.support_within(mine + self.axes.T @ from_its)
        return between - within - other.support_within(other.axes.T @ from_mine + its)


def placed_shape(shape: ConvexShape, pose: Pose) -> PlacedShape:
    """A shape of a link at the link's pose."""
    place = shape.link_from_shape
    turn = _matrix(shape) @ ca.DM([list(row) for row in place.rotation])
    return PlacedShape(
        pose.point(vector(place.translation)),
        pose.rotation,
        turn @ ca.diag(vector(shape.half_sides)),
        turn[:, :2] * shape.disc,
        turn * shape.ball,
    )


def _matrix(shape: ConvexShape) -> Expression:
    return ca.vertcat(*[ca.horzcat(*row) for row in shape.stretch])
