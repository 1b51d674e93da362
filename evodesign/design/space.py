"""What may change: lengths, densities and walls of groups of links, actuators of joints, and allocations.

A design is a value per parameter; a genome is the same point in the unit cube. The values may be symbolic,
so that one posture program serves every design.

Source: Sartore et al. 2022, Section III-A: pi = (l_m1, ..., rho_1, ...).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from evodesign.body.placement import Scalar
from evodesign.design.parameter import (
    ALLOCATIONS,
    DesignParameter,
    ParameterKind,
)
from evodesign.design.walls import Wall, check_walls, walls_of_links
from evodesign.errors import ModelError
from evodesign.hardware.actuators import Actuator
from evodesign.records import Genome, Parameter, design_of
from evodesign.tree.equip import with_actuators, with_walls
from evodesign.tree.joint_changes import unchanged_value, with_changes
from evodesign.tree.model import Tree
from evodesign.tree.resize import Growth, growth_of, resize
from evodesign.tree.sections import with_sections
from evodesign.tree.symmetry import mirror_of
from evodesign.tree.welded import without_frames

TYPICAL = 10.0
"""What is asked of a sized actuator [N m] as long as nothing better is known."""


@dataclass(frozen=True, slots=True)
class DesignSpace:
    """All parameters of a problem, and the walls of links.

    Programs and trees are given a value of every parameter; genomes have a coordinate for each that is free.
    """

    parameters: tuple[DesignParameter, ...]
    walls: tuple[Wall, ...] = ()

    @property
    def free(self) -> tuple[DesignParameter, ...]:
        """Those that are not fixed, in the order of the genome's coordinates."""
        return tuple(parameter for parameter in self.parameters if not parameter.is_fixed)

    @property
    def records(self) -> tuple[Parameter, ...]:
        """The free parameters as they are remembered."""
        return tuple(parameter.record for parameter in self.free)

    def check(self, tree: Tree) -> None:
        """Refuse parameters that the tree cannot follow.

        Raises:
            ModelError: naming the link.
        """
        self.resized(tree, self.given(self.unscaled(tree), {}))
        shortest = self.resized(tree, [p.lower for p in self.parameters])
        thickest = {link: p.upper for p in self._of(ParameterKind.WALL) for link in p.links}
        fixed = {link: wall.thickness for wall in self.walls if wall.thickness for link in wall.links}
        check_walls(shortest, self.walls, {**thickest, **fixed})
        for parameter in self.parameters:
            if parameter.kind is ParameterKind.LENGTH:
                for link in parameter.links:
                    growth_of(tree, link)

    def check_mirror(self, tree: Tree) -> None:
        """Refuse parameters that make a mirror-symmetric tree unequal.

        Raises:
            ModelError: naming a link whose mirror image is not in its group, or what in the tree differs,
                before or after resizing.
        """
        mirror = mirror_of(tree)
        for parameter in self.parameters:
            for what, names, partners in (
                ("links", parameter.links, mirror.links),
                ("joints", parameter.joints, mirror.joints),
                ("joints", tuple(each.joint for each in parameter.changes), mirror.joints),
            ):
                for name in names:
                    if partners[name] not in names:
                        found = f"'{name}' without '{partners[name]}'"
                        raise ModelError(
                            tree.name, f"{parameter.name}.{what}", f"both {what} of a pair", found
                        )
        changed = [
            parameter.lower + (0.6 + 0.01 * number) * (parameter.upper - parameter.lower)
            if parameter.changes
            else value * (1.1 + 0.01 * number)
            for number, (parameter, value) in enumerate(
                zip(self.parameters, self.unscaled(tree), strict=True)
            )
        ]
        try:
            mirror_of(without_frames(self.resized(tree, changed), ()))
        except ModelError as error:
            wanted = "parameters that keep the robot its own mirror image"
            raise ModelError(tree.name, "design", wanted, f"others ({error})") from error

    @property
    def margins(self) -> tuple[int, ...]:
        """Places of the margins among the parameters."""
        return tuple(i for i, each in enumerate(self.parameters) if each.kind is ParameterKind.MARGIN)

    def given(self, values: Sequence[float], rated: Mapping[str, float]) -> tuple[float, ...]:
        """What programs and `resized` are given: rated torques [N m] in place of margins.

        Args:
            values: of a design.
            rated: of its sized actuators, by the parameter's name; others are as if `TYPICAL` were asked.
        """
        margins = self.margins
        return tuple(
            rated.get(parameter.name, value * TYPICAL) if place in margins else value
            for place, (parameter, value) in enumerate(zip(self.parameters, values, strict=True))
        )

    def _of(self, kind: ParameterKind) -> list[DesignParameter]:
        return [parameter for parameter in self.parameters if parameter.kind is kind]

    def family(self, tree: Tree) -> Family:
        """The trees of all designs of an unscaled one."""
        lengths = [link for parameter in self._of(ParameterKind.LENGTH) for link in parameter.links]
        growths = {link: growth_of(tree, link) for link in lengths}
        kept = frozenset(link for each in self.parameters if each.keeps_mass for link in each.links)
        fixed = [wall for wall in self.walls if wall.thickness is not None and wall.density is not None]
        return Family(self, with_walls(tree, walls_of_links(fixed, {})), growths, kept)

    def resized(self, tree: Tree, values: Sequence[Scalar]) -> Tree:
        """The tree of a design.

        Args:
            tree: unscaled.
            values: one number or expression per parameter; of a margin, the rated torque [N m].
        """
        return self.family(tree).resized(values)

    def with_actuators(self, tree: Tree, values: Sequence[Scalar]) -> Tree:
        """The tree of a design that has no actuators yet, with them."""
        return with_actuators(tree, self.actuators(values))

    def actuators(self, values: Sequence[Scalar]) -> dict[str, Actuator]:
        """The actuators of a design, by joint name; arguments as in `resized`."""
        found: dict[str, Actuator] = {}
        for parameter, value in zip(self.parameters, values, strict=True):
            if parameter.joints:
                found |= parameter.actuators(value)
        return found

    @property
    def driven(self) -> tuple[str, ...]:
        """Names of the joints whose actuators a design chooses."""
        return tuple(joint for parameter in self.parameters for joint in parameter.joints)

    def allocations(self, values: Sequence[Scalar]) -> Mapping[str, Scalar]:
        """The allocation parameters among a design's values, by their own names."""
        pairs = zip(self.parameters, values, strict=True)
        return {p.group: value for p, value in pairs if p.kind is ParameterKind.ALLOCATION}

    @property
    def allocation_names(self) -> frozenset[str]:
        """Names of the allocation parameters that a design chooses."""
        return frozenset(p.group for p in self.parameters if p.kind is ParameterKind.ALLOCATION)

    @property
    def counts(self) -> tuple[int, ...]:
        """How many choices each coordinate of a genome has, 0 for a continuous one."""
        return tuple(len(parameter.choices) for parameter in self.free)

    def unscaled(self, tree: Tree) -> tuple[float, ...]:
        """The file's robot as a design: multipliers one, densities averaged over groups, usual allocation.

        Of walls and actuators the file says nothing: theirs are in the middle of their bounds or choices.
        """
        return tuple(self._unscaled_value(parameter, tree) for parameter in self.parameters)

    def _unscaled_value(self, parameter: DesignParameter, tree: Tree) -> float:
        if parameter.kind in (ParameterKind.LENGTH, ParameterKind.SECTION):
            return 1.0
        if parameter.changes:
            return unchanged_value(tree, parameter.changes[0])
        if parameter.kind is ParameterKind.ALLOCATION:
            return ALLOCATIONS[parameter.group].usual
        if parameter.joints or parameter.kind is ParameterKind.WALL:
            return parameter.record.value_at(0.5)
        links = [tree.link(name, f"{parameter.name}.links") for name in parameter.links]
        volume = sum(float(link.volume) for link in links)
        return sum(float(link.inertia.mass) for link in links) / volume if volume else 0.0

    def values(self, genome: Genome) -> tuple[float, ...]:
        """Parameter values of a genome."""
        return self.values_of(design_of(self.records, genome))

    def genome(self, values: Sequence[float]) -> Genome:
        """The genome of parameter values; coordinates outside [0, 1] mean values outside the bounds.

        A value that is no choice becomes the nearest one; who takes values from a user refuses it first.
        """
        pairs = zip(self.parameters, values, strict=True)
        return tuple(parameter.coordinate(value) for parameter, value in pairs if not parameter.is_fixed)

    def named(self, values: Sequence[float]) -> Mapping[str, float]:
        """Values of the free parameters by full name: a design as it is logged."""
        pairs = zip(self.parameters, values, strict=True)
        return {parameter.name: value for parameter, value in pairs if not parameter.is_fixed}

    def values_of(self, design: Mapping[str, float]) -> tuple[float, ...]:
        """A value per parameter of a design by name."""
        return tuple(each.lower if each.is_fixed else design[each.name] for each in self.parameters)


@dataclass(frozen=True, slots=True)
class Family:
    """The trees of all designs of a robot; what they have in common is worked out once.

    Args:
        space: of the designs.
        tree: unscaled, with the walls that all designs have.
        growths: how each link of a length parameter grows.
        kept: links that keep their masses whatever their length.
    """

    space: DesignSpace
    tree: Tree
    growths: Mapping[str, Growth]
    kept: frozenset[str]

    def resized(self, values: Sequence[Scalar]) -> Tree:
        """The tree of a design; values as in `DesignSpace.resized`."""
        return self.space.with_actuators(self.without_actuators(values), values)

    def without_actuators(self, values: Sequence[Scalar]) -> Tree:
        """The same tree with joints that nothing drives."""
        by_kind: dict[ParameterKind, dict[str, Scalar]] = {kind: {} for kind in ParameterKind}
        for parameter, value in zip(self.space.parameters, values, strict=True):
            by_kind[parameter.kind].update(dict.fromkeys(parameter.links, value))
        tree = with_walls(self.tree, walls_of_links(self.space.walls, by_kind[ParameterKind.WALL]))
        lengths, densities = by_kind[ParameterKind.LENGTH], by_kind[ParameterKind.DENSITY]
        tree = resize(tree, lengths, densities, self.growths, self.kept)
        pairs = [*zip(self.space.parameters, values, strict=True)]
        sections = [(section, value) for parameter, value in pairs for section in parameter.sections]
        if sections:
            tree = with_sections(tree, sections)
        changes = [(change, value) for parameter, value in pairs for change in parameter.changes]
        return with_changes(tree, changes) if changes else tree
