"""Coupled joints: some of a person's joints share a range or a movement, as the spine does.

    lower <= sum of positions <= upper        q_i = s_i sum of positions

A person who asks for nothing of the kind (`[human] joint_ranges`) has no such rows. In a symmetric half,
joints that stand at zero are left out of their sums. Of joints that move together (a rhythm) the sum is the
variable (`posture.symmetry`), so that there is nothing to say of them in a program; the check compares.

Source: `human.coupled_joints`.
"""

from __future__ import annotations

from collections.abc import Iterator

from evodesign.posture.limit_groups import LimitGroup
from evodesign.posture.terms.base import Body, BodyTerm, Bound, MeasuredBody, Residual, Row


def rows(body: Body) -> Iterator[Row]:
    """A row for each shared range of which some joint is a variable [rad]."""
    place = {name: number for number, name in enumerate(body.form.joints)}
    for each in body.agent.coupled_joints:
        positions = [body.values["joints"][place[name]] for name in each.joints if name in place]
        if positions:
            limits, found, group = (each.lower, each.upper), ("coupled_joints",), LimitGroup.JOINT_LIMITS
            lower, upper = (
                (Bound("range that joints share", limit, "rad", at_most, part=each.name),)
                for limit, at_most in zip(limits, (False, True), strict=True)
            )
            shared = sum(positions)
            yield Row(
                each.name, shared, *limits, found, group=group, posture_only=True, least=lower, most=upper
            )


def residuals(body: MeasuredBody) -> Iterator[Residual]:
    """By how much the worst shared range is exceeded, and the worst joint differs from its share."""
    beyond = [0.0]
    for each in body.agent.coupled_joints:
        together = sum(body.posture.joints.get(name, 0.0) for name in each.joints)
        beyond += [each.lower - together, together - each.upper]
    if body.agent.coupled_joints:
        group, words = LimitGroup.JOINT_LIMITS, "the range that joints share"
        yield Residual("coupled_joints", max(beyond), "rad", words, group, posture_only=True)
    if body.agent.rhythms:
        words = "the shares of joints that move together"
        yield Residual("rhythm", max(_off_rhythm(body)), "rad", words, posture_only=True)


def _off_rhythm(body: MeasuredBody) -> Iterator[float]:
    """How far each joint that moves with others is from its share [rad]."""
    for each in body.agent.rhythms:
        positions = [body.posture.joints[name] for name in each.joints]
        for share, position in zip(each.shares, positions, strict=True):
            yield abs(position - share * sum(positions))


COUPLED_JOINTS = BodyTerm("coupled_joints", rows=rows, residuals=residuals)
