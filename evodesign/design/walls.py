"""Walls that a problem gives to links: of a fixed thickness, or of one that a design chooses."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from evodesign.body.placement import Scalar
from evodesign.errors import ModelError
from evodesign.tree.equip import WallOfLink
from evodesign.tree.model import Tree


@dataclass(frozen=True, slots=True)
class Wall:
    """A wall that links share.

    Args:
        group: its name.
        links: names of the links.
        thickness: [m]; None where the design chooses it.
        material: name of what it is made of; None where a density parameter says so.
        density: of the material [kg/m^3]; None where the design chooses it.
        share: of a link's mass in the file that stays beside the wall.
        least: least thickness that can be made [m]; zero where no source gives one.
        cycles: how often a load comes and goes in the robot's life; None where nobody says.
    """

    group: str
    links: tuple[str, ...]
    thickness: float | None
    material: str | None
    density: float | None
    share: float
    least: float = 0.0
    cycles: float | None = None


def walls_of_links(walls: Iterable[Wall], chosen: Mapping[str, Scalar]) -> dict[str, WallOfLink]:
    """What each link is made of.

    Args:
        walls: of the problem.
        chosen: thickness [m] by link, where the design chooses it.
    """
    return {
        link: WallOfLink(chosen[link] if wall.thickness is None else wall.thickness, wall.density, wall.share)
        for wall in walls
        for link in wall.links
    }


def check_walls(tree: Tree, walls: Iterable[Wall], thickest: Mapping[str, float]) -> None:
    """Refuse walls that leave no room inside a solid.

    Args:
        tree: with walls and with its shortest lengths.
        walls: of the problem.
        thickest: the largest thickness [m] by link.
    Raises:
        ModelError: naming the link.
    """
    for wall in walls:
        for link in wall.links:
            least = min(float(solid.shape.least_width) for solid in tree.link_by_name[link].solids)
            if thickest[link] >= least / 2.0:
                wanted = f"less than half of the smallest dimension at its shortest, {least / 2.0:.4g} m"
                raise ModelError(tree.name, f"wall of link {link}", wanted, f"{thickest[link]:g} m")
