"""The README of the folder of CAD files: what each file is, and how its bodies agree with the URDF."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Vector
from evodesign.errors import on_one_line
from evodesign.report.cad.agreement import LinkAgreement
from evodesign.report.cad.clashes import Clash
from evodesign.report.cad.listing import millimetres, section_text, wall_text
from evodesign.report.cad.parts import LinkPart, Parts
from evodesign.report.cad.seats import Seat, SeatedLink

FILES = """\
Lengths are millimetres. The files of a link are in its own frame, that of `../robot.urdf`.

- `assembly.step`: all links at joint angles of zero in the frame of the root link, each a product of its
  name; `motor_JOINT`, the housing of each actuator about the joint's axis; `axis_JOINT`, a line of 200 mm
  along the axis of each joint that moves, its middle in the joint.
- `LINK.step` and `LINK.stl`: one link, as bodies and as triangles that fill its volume to 0.1 %.
- `drawing.svg`: outlines at zero, dimensions, and the bill of materials, for A3 paper."""

LIMITS = """\
The files hold the bodies of the mass model. They serve for a first quotation and as a start in a CAD
program, and are no finished parts:

- A hollow link is closed, its wall as thick at the ends as at the sides: it is printed in one piece with an
  opening to drain it, or made of a tube or plates and two ends.
- A motor is the cylinder of its housing. Where the problem mounts it (`mount`), the link that holds it has a
  seat: a bore of the housing's diameter, and a flange, a flat ring across the axis (table of seats). To be
  added are fits, shoulders and bolt circles, which the catalogue does not have; a cap over what a seat leaves
  open; the opening through which the motor comes into a closed link; and in the link that the motor moves
  its room and a hub. Motors without `mount` have no seats. Bearings, screws and cables are not drawn.
- Links of a joint pass through each other where the mass model lets them (last table): they have to be cut
  back before the joint can move.
- `filling` is what a hollow link holds beside its wall (cables, boards, covers), spread evenly over it. It
  has mass and no body. The mass model has no seats, so what they add to a link's body is taken from its
  filling, and what bores take is given to it.
- A density without the name of a material is an effective one: mass over the volume of the shape."""

COMPARED = """\
Mass, centre and inertia of the whole link (walls, filling and motors), integrated over the bodies of these
files, against those of `../robot.urdf`, in the link's frame; the inertia is about the centre of mass, its
difference the norm of the matrix of differences, relative. In the URDF a motor without `mount` is a ball of
its mass; "with housings" takes the cylinders that are drawn instead. A posture depends on mass and centre
alone."""


def readme_text(
    parts: Parts,
    compared: Mapping[str, LinkAgreement],
    seated: Mapping[str, SeatedLink],
    motors: Sequence[Clash],
    neighbours: Sequence[Clash],
) -> str:
    """The README as Markdown.

    Args:
        parts: of the robot.
        compared: links with the URDF, by name.
        seated: links with seats, by name.
        motors: which cut through links.
        neighbours: links that pass through each other.
    """
    sections = [
        f"# CAD files of {_code(parts.tree.name)}",
        FILES,
        *_without_bodies(parts),
        "## Before anything is made",
        LIMITS,
        *_bodies(parts, compared),
        *_motors(parts, motors),
        *_seats(parts, compared, seated),
        *_neighbours(neighbours),
    ]
    return "\n\n".join(sections) + "\n"


def _without_bodies(parts: Parts) -> list[str]:
    found = []
    if parts.meshes:
        names = ", ".join(f"{_code(name)} (`{stem}.stl`)" for name, stem in parts.meshes.items())
        why = "Meshes alone show these links, or shapes that do not make their mass"
        found.append(f"{why}, so there is an STL and no STEP of them: {names}.")
    if parts.left_out:
        names = ", ".join(_code(name) for name in parts.left_out)
        found.append(f"These links have a mass and no shape, so they are left out: {names}.")
    return found


def _bodies(parts: Parts, compared: Mapping[str, LinkAgreement]) -> list[str]:
    """What the bodies weigh; nothing where there are none."""
    if not compared:
        return []
    return [
        "## Parts",
        _parts_table(parts, compared),
        *_shared(compared),
        "## Against the URDF",
        COMPARED,
        _worst(compared),
        _mass_table(compared),
        _inertia_table(compared),
    ]


def _parts_table(parts: Parts, compared: Mapping[str, LinkAgreement]) -> str:
    heads = (
        *("link", "files", "outside [mm]", "wall [mm]", "material", "density [kg/m³]", "volume [cm³]"),
        *("mass of the body [kg]", "filling [kg]", "motors [kg]", "centre of the body [mm]"),
        "inertia of the body [kg cm²]: xx, yy, zz, xy, xz, yz",
    )
    return _table(heads, (_part_row(part, compared[part.name]) for part in parts.links))


def _part_row(part: LinkPart, found: LinkAgreement) -> tuple[str, ...]:
    solids = part.link.solids
    return (
        _code(part.name),
        f"`{part.file}`",
        " + ".join(section_text(solid.shape) for solid in solids),
        ", ".join(dict.fromkeys(wall_text(solid) for solid in solids)),
        _code(part.material) if part.material else "none named",
        ", ".join(dict.fromkeys(f"{float(solid.density):.0f}" for solid in solids)),
        f"{found.volume * 1e6:.2f}",
        f"{found.walls:.4f}",
        f"{found.filling:.4f}",
        f"{found.motors:.4f}",
        _point(found.body.center),
        _moments(found.body),
    )


def _shared(compared: Mapping[str, LinkAgreement]) -> list[str]:
    found = {name: each.shared for name, each in compared.items() if each.shared > 1e-6}
    if not found:
        return []
    named = ", ".join(f"{_code(name)} ({100.0 * share:.2f} %)" for name, share in found.items())
    return [
        "Bodies of one link that overlap stay separate in its files, as the mass model counts what they "
        f"share twice. United, these links would have so much less volume: {named}."
    ]


def _worst(compared: Mapping[str, LinkAgreement]) -> str:
    mass = max(compared, key=lambda name: abs(compared[name].mass_difference))
    center = max(compared, key=lambda name: compared[name].center_difference)
    inertia = max(compared, key=lambda name: compared[name].inertia_difference)
    housed = max(compared, key=lambda name: compared[name].housed_difference)
    return (
        f"Largest differences: mass {_percent(compared[mass].mass_difference)} % ({_code(mass)}), centre "
        f"{1000.0 * compared[center].center_difference:.4f} mm ({_code(center)}), inertia "
        f"{_percent(compared[inertia].inertia_difference)} % ({_code(inertia)}), with housings "
        f"{_percent(compared[housed].housed_difference)} % ({_code(housed)})."
    )


def _mass_table(compared: Mapping[str, LinkAgreement]) -> str:
    heads = (
        *("link", "mass [kg]", "URDF [kg]", "difference [%]"),
        *("centre [mm]", "URDF [mm]", "distance [mm]"),
    )
    rows = (
        (
            _code(name),
            f"{float(each.drawn.mass):.4f}",
            f"{float(each.urdf.mass):.4f}",
            _percent(each.mass_difference),
            _point(each.drawn.center),
            _point(each.urdf.center),
            f"{1000.0 * each.center_difference:.4f}",
        )
        for name, each in compared.items()
    )
    return _table(heads, rows)


def _inertia_table(compared: Mapping[str, LinkAgreement]) -> str:
    heads = (
        *("link", "inertia [kg cm²]: xx, yy, zz, xy, xz, yz", "URDF [kg cm²]", "difference [%]"),
        *("with housings [kg cm²]", "difference [%]"),
    )
    rows = (
        (
            _code(name),
            _moments(each.drawn),
            _moments(each.urdf),
            _percent(each.inertia_difference),
            _moments(each.housed),
            _percent(each.housed_difference),
        )
        for name, each in compared.items()
    )
    return _table(heads, rows)


def _motors(parts: Parts, clashes: Sequence[Clash]) -> list[str]:
    if not parts.motors:
        return []
    cut: dict[str, list[str]] = {}
    for clash in clashes:
        cut.setdefault(clash.part, []).append(f"{_code(clash.link)} {clash.volume * 1e6:.2f}")
    heads = (
        *("motor", "model", "rated [N m]", "peak [N m]", "diameter x length [mm]", "mass [kg]", "held by"),
        "cuts out of walls and full bodies [cm³]",
    )
    rows = (
        (
            _code(motor.name),
            _code(motor.actuator.model) if motor.actuator.model else "none named",
            f"{float(motor.actuator.rated):.2f}",
            f"{float(motor.actuator.peak):.2f}",
            " x ".join(millimetres(each) for each in motor.actuator.size),
            f"{float(motor.actuator.mass):.3f}",
            _code(motor.joint.parent),
            ", ".join(cut.get(motor.name, ["nothing"])),
        )
        for motor in parts.motors
    )
    return ["## Motors", _table(heads, rows)]


def _seats(
    parts: Parts, compared: Mapping[str, LinkAgreement], seated: Mapping[str, SeatedLink]
) -> list[str]:
    mounted = [motor for motor in parts.motors if motor.actuator.mounting is not None]
    if not mounted:
        return []
    by_motor = {seat.motor.name: seat for link in seated.values() for seat in link.seats}
    heads = (
        *("motor", "held by", "bore [mm]", "flange [mm]", "middle of the flange to that of the housing [mm]"),
        *("circumference held [%]", "all seats add to the link [kg]"),
    )
    rows = (
        (
            *(_code(motor.name), _code(motor.joint.parent)),
            *_seat_cells(by_motor.get(motor.name)),
            f"{compared[motor.joint.parent].seats:z.4f}" if motor.joint.parent in compared else "-",
        )
        for motor in mounted
    )
    return ["## Seats", _table(heads, rows)]


def _seat_cells(seat: Seat | None) -> tuple[str, ...]:
    if seat is None:
        return ("none: the rim is outside of the link", "-", "-", "0")
    ring = f"Ø{millimetres(2.0 * seat.outside)} x {millimetres(seat.thickness)}"
    return (
        f"Ø{millimetres(seat.motor.actuator.size[0])}",
        ring if seat.thickness > 0.0 else "the link",
        f"{1000.0 * seat.along:z.1f}",
        f"{100.0 * seat.held:.0f}",
    )


def _neighbours(clashes: Sequence[Clash]) -> list[str]:
    if not clashes:
        return []
    rows = ((_code(each.part), _code(each.link), f"{each.volume * 1e6:.1f}") for each in clashes)
    heads = ("link", "passes through", "their outer shapes share [cm³]")
    return ["## Links that pass through each other", _table(heads, rows)]


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(each.replace('|', chr(92) + '|') for each in line)} |" for line in lines)


def _percent(share: float) -> str:
    return f"{100.0 * share:z.3f}"


def _point(point: Vector) -> str:
    """Coordinates [m] in millimetres."""
    return ", ".join(f"{1000.0 * float(each):z.2f}" for each in point)


def _moments(inertia: Inertia) -> str:
    """The six moments [kg m^2] in kg cm^2."""
    matrix = inertia.about_center
    found = (matrix[0][0], matrix[1][1], matrix[2][2], matrix[0][1], matrix[0][2], matrix[1][2])
    return ", ".join(f"{1e4 * float(each):z.3f}" for each in found)


def _code(text: str) -> str:
    """A name as a code span on one line, which Markdown shows letter by letter."""
    return f"`{on_one_line(text).replace('`', chr(39))}`"
