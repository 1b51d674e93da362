"""The robot icub_shapes: from the table of figures beside this file to a tree, and to its URDF.

    python problems/robots/write_icub.py

A name that begins with `l_` stands for a pair, whose other half is the mirror image about the plane y = 0:

    xyz -> (x, -y, z)      rpy -> (-r, p, -y)      axis of rotation -> (-ax, ay, -az), same limits
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TypeVar

import msgspec

from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Shape, Solid, Sphere
from evodesign.tree.model import Joint, JointKind, Link, Tree
from evodesign.tree.urdf_write import urdf_text

HERE = Path(__file__).parent
TABLE = HERE / "icub_table.toml"
URDF = HERE / "icub_shapes.urdf"

Triple = tuple[float, float, float]
ZERO: Triple = (0.0, 0.0, 0.0)


class Row(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A named placement."""

    name: str
    xyz_m: Triple = ZERO
    rpy_rad: Triple = ZERO

    @property
    def placement(self) -> Placement:
        """The placement as the model has it."""
        return Placement.from_xyz_rpy(self.xyz_m, self.rpy_rad)


class FrameRow(Row, frozen=True, tag_field="shape", tag="frame"):
    """A link without mass."""


class SphereRow(Row, frozen=True, tag_field="shape", tag="sphere"):
    """A link that is a ball."""

    mass_kg: float
    radius_m: float

    @property
    def form(self) -> Shape:
        """The shape as the model has it."""
        return Sphere(self.radius_m)


class CylinderRow(Row, frozen=True, tag_field="shape", tag="cylinder"):
    """A link that is a cylinder."""

    mass_kg: float
    radius_m: float
    length_m: float

    @property
    def form(self) -> Shape:
        """The shape as the model has it."""
        return Cylinder(self.radius_m, self.length_m)


class BoxRow(Row, frozen=True, tag_field="shape", tag="box"):
    """A link that is a box."""

    mass_kg: float
    size_m: Triple

    @property
    def form(self) -> Shape:
        """The shape as the model has it."""
        return Box(*self.size_m)


class FixedRow(Row, frozen=True, tag_field="kind", tag="fixed"):
    """A weld."""

    parent: str
    child: str


class RevoluteRow(FixedRow, frozen=True, tag_field="kind", tag="revolute"):
    """A hinge with limits."""

    axis: Triple
    lower_rad: float
    upper_rad: float


LinkRow = FrameRow | SphereRow | CylinderRow | BoxRow
JointRow = FixedRow | RevoluteRow
AnyRow = TypeVar("AnyRow", bound=Row)


class Table(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The middle and the left side of a robot."""

    name: str
    link: tuple[LinkRow, ...]
    joint: tuple[JointRow, ...]


def read_table(text: str) -> Table:
    """The table of a TOML text."""
    return msgspec.toml.decode(text, type=Table)


def robot(table: Table) -> Tree:
    """The whole robot: the table's rows, each of the left side followed by its mirror image."""
    links = tuple(_link(row) for row in _with_mirror_images(table.link))
    joints = tuple(_joint(row) for row in _with_mirror_images(table.joint))
    return Tree(table.name, links, joints)


def _with_mirror_images(rows: tuple[AnyRow, ...]) -> Iterator[AnyRow]:
    for row in rows:
        yield row
        if row.name.startswith("l_"):
            yield _mirrored(row)


def _mirrored(row: AnyRow) -> AnyRow:
    (x, y, z), (roll, pitch, yaw) = row.xyz_m, row.rpy_rad
    image = msgspec.structs.replace(
        row, name=_other_side(row.name), xyz_m=(x, -y, z), rpy_rad=(-roll, pitch, -yaw)
    )
    if isinstance(row, FixedRow):
        ends = {"parent": _other_side(row.parent), "child": _other_side(row.child)}
        image = msgspec.structs.replace(image, **ends)
    if isinstance(row, RevoluteRow):
        image = msgspec.structs.replace(image, axis=(-row.axis[0], row.axis[1], -row.axis[2]))
    return image


def _other_side(name: str) -> str:
    return f"r_{name.removeprefix('l_')}" if name.startswith("l_") else name


def _link(row: LinkRow) -> Link:
    if isinstance(row, FrameRow):
        return Link(row.name)
    return Link(row.name, solids=(Solid(row.form, row.placement, row.mass_kg / row.form.volume),))


def _joint(row: JointRow) -> Joint:
    if isinstance(row, RevoluteRow):
        ends = (row.lower_rad, row.upper_rad)
        return Joint(
            row.name, JointKind.REVOLUTE, row.parent, row.child, row.placement, row.axis, ends[0], ends[1]
        )
    return Joint(row.name, JointKind.FIXED, row.parent, row.child, row.placement)


def main() -> None:
    """Write the URDF beside the table."""
    tree = robot(read_table(TABLE.read_text(encoding="utf-8")))
    URDF.write_text(urdf_text(tree), encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
