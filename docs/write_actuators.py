"""Writes the tables of docs/actuators.md, and two of docs/hardware.md: `python -m docs.write_actuators`."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from evodesign.hardware.actuators import (
    PowerLaw,
    actuator_law,
    actuator_of_row,
    friction_law,
    gears_with_a_law,
)
from evodesign.hardware.catalogue import CatalogueRow, Gear, catalogue, catalogue_sources

DOCS = Path(__file__).parent
LAWS, JOINTS, ROWS, SOURCES = "laws", "joints", "rows", "sources"
PAGES = {LAWS: "hardware.md", JOINTS: "hardware.md", ROWS: "actuators.md", SOURCES: "actuators.md"}
"""The page of each table."""

FIGURES = {
    "peak": ("peak torque [N m]", "rated"),
    "mass": ("mass [kg]", "peak"),
    "motor_constant": ("motor constant K [N m/W^0.5]", "rated"),
    "inertia": ("reflected inertia [kg m^2]", "rated"),
    "speed": ("speed without load [rad/s]", "rated"),
    "stiffness": ("windup stiffness [N m/rad]", "rated"),
    "diameter": ("housing's diameter [m]", "mass"),
    "length": ("housing's length [m]", "mass"),
}
"""What a law gives, and by what."""


@dataclass(frozen=True, slots=True)
class PublishedJoint:
    """A joint of a humanoid that was built.

    Args:
        robot, joint: names.
        peak: torque [N m] of its actuator.
        actuator: what is published of it.
        mass: [kg]; None where nobody publishes it.
    """

    robot: str
    joint: str
    peak: float
    actuator: str
    mass: float | None


PUBLISHED = (
    PublishedJoint("K-Scale K-Bot", "knee", 120.0, "RobStride RS04", 1.42),
    PublishedJoint("K-Scale K-Bot", "shoulder", 60.0, "RobStride RS03", 0.88),
    PublishedJoint("Menlo Asimov 1", "knee", 75.0, "Encos EC-A4315-P2-36", 0.455),
    PublishedJoint("Menlo Asimov 1", "shoulder", 90.0, "Encos EC-A5013-H17-100", 0.64),
    PublishedJoint("Roboto Origin", "knee", 120.0, "Damiao DM-J10010L", 1.372),
    PublishedJoint("Roboto Origin", "shoulder", 27.0, "Damiao DM-J4340P", 0.375),
    PublishedJoint("Unitree G1", "knee", 139.0, "N7520-22.5", None),
    PublishedJoint("Unitree G1", "shoulder", 25.0, "N5020-16", None),
    PublishedJoint("Unitree H1", "knee", 360.0, "M107, 189 N m/kg", 360.0 / 189.0),
    PublishedJoint("Unitree H1", "shoulder", 75.0, "arm joint", None),
    PublishedJoint("Fourier N1", "knee", 95.0, "FSA 8029E", None),
    PublishedJoint("Fourier N1", "shoulder", 54.0, "FSA 6043E", None),
    PublishedJoint("PNDbotics Adam Lite", "knee", 340.0, "PND-130-7F-P", None),
    PublishedJoint("PNDbotics Adam Lite", "shoulder", 65.0, "PND-50-14A-50-S", None),
)
"""Peak torques of the makers' model files and pages: github.com/nickthelegend/thenar-jx1,
research/raw/reference_robots_raw.md; H1: github.com/nathmo/highTorqueDensityMotorReview,
research/qdd-western_specs.csv; masses as in the catalogue."""

LEAST_SPEED = {"knee": 8.0, "shoulder": 3.0}
"""Speed of the output [rad/s] below which an actuator is none for the joint."""


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown."""
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"|{'|'.join(f' {cell} ' if cell else ' ' for cell in line)}|\n" for line in lines)


def law_table() -> str:
    """Every law of every gear, with its scatter and the number of rows."""
    rows = []
    for gear in gears_with_a_law():
        for name, (words, by) in FIGURES.items():
            law: PowerLaw = getattr(actuator_law(gear), name)
            power = "" if law.exponent == 1.0 else f"^{law.exponent:.3f}"
            formula = f"{law.factor:.3g} {by}{power}"
            rows.append((gear, words, formula, f"x/÷ {law.scatter:.2f}", str(law.count)))
        if friction := friction_law(gear):
            formula = f"{friction.factor:.3g} rated^{friction.exponent:.3f}"
            words = "friction torque [N m]"
            rows.append((gear, words, formula, f"x/÷ {friction.scatter:.2f}", str(friction.count)))
    return table(("gear", "quantity", "law", "one standard deviation", "rows"), rows)


def joint_table() -> str:
    """What law and catalogue give knees and shoulders of humanoids that were built."""
    rows = []
    for joint in PUBLISHED:
        cells = [joint.robot, joint.joint, f"{joint.peak:g}", joint.actuator]
        cells.append("not published" if joint.mass is None else f"{joint.mass:.2f}")
        for gear in gears_with_a_law():
            cells.append(f"{actuator_law(gear).mass(joint.peak):.2f}")
            lightest = _lightest(joint, Gear(gear))
            cells.append("none" if lightest is None else f"{lightest.model}, {lightest.mass_kg:.2f}")
        rows.append(cells)
    head = ["robot", "joint", "peak [N m]", "its actuator", "its mass [kg]"]
    for gear in gears_with_a_law():
        words = gear.replace("_", " ")
        head += [f"{words}: law [kg]", f"{words}: lightest row [kg]"]
    return table(head, rows)


def _lightest(joint: PublishedJoint, gear: Gear) -> CatalogueRow | None:
    """The lightest row with enough torque and speed."""
    strong = [
        row
        for row in catalogue().values()
        if row.gear is gear
        and not row.separate_drive
        and row.peak_torque_n_m >= joint.peak
        and (row.speed or 0.0) >= LEAST_SPEED[joint.joint]
    ]
    return min(strong, key=lambda row: row.mass_kg, default=None)


def row_table() -> str:
    """Every row, and how many times its figures the law of its gear gives."""
    head = ("model", "maker", "gear", "rated [N m]", "peak [N m]", "mass [kg]", *_COMPARED, "source")
    return table(head, (_row(row) for row in catalogue().values()))


_COMPARED = ("peak", "mass", "K", "inertia", "speed", "diameter", "length")


def _row(row: CatalogueRow) -> list[str]:
    law = actuator_law("strain_wave" if row.gear is Gear.STRAIN_WAVE else "planetary")
    rated, housing = row.rated_torque_n_m, row.housing or (None, None)
    by_rated = actuator_of_row(row, law).rated
    pairs = (
        (None if rated is None else row.peak_torque_n_m, law.peak(by_rated)),
        (row.mass_kg, law.mass(row.peak_torque_n_m)),
        (row.motor_constant, law.motor_constant(by_rated)),
        (row.reflected_inertia, law.inertia(by_rated)),
        (row.speed, law.speed(by_rated)),
        (housing[0], law.diameter(row.mass_kg)),
        (housing[1], law.length(row.mass_kg)),
    )
    ratios = ["" if given is None else f"{of_law / given:.2f}" for given, of_law in pairs]
    gear = "" if row.gear is None else row.gear.replace("_", " ")
    figures = ["" if rated is None else f"{rated:g}", f"{row.peak_torque_n_m:g}", f"{row.mass_kg:.3g}"]
    return [row.model, row.maker, gear, *figures, *ratios, row.source]


def source_table() -> str:
    """What the rows' sources stand for."""
    counts = [row.source for row in catalogue().values()]
    of_rows = ((name, text) for name, text in catalogue_sources().items() if name in counts)
    return table(("source", "rows", "is"), ((name, str(counts.count(name)), text) for name, text in of_rows))


TABLES = {LAWS: law_table, JOINTS: joint_table, ROWS: row_table, SOURCES: source_table}


def parts(name: str) -> tuple[str, str, str]:
    """A page before a table, the table, and the page behind it."""
    text = (DOCS / PAGES[name]).read_text(encoding="utf-8")
    before, rest = text.split(f"<!-- {name} -->\n\n")
    shown, after = rest.split(f"\n<!-- end of {name} -->\n")
    return f"{before}<!-- {name} -->\n\n", shown, f"\n<!-- end of {name} -->\n{after}"


def main() -> None:
    """Put the tables in the place of what the pages show."""
    for name, written in TABLES.items():
        before, _, after = parts(name)
        (DOCS / PAGES[name]).write_text(before + written() + after, encoding="utf-8")


if __name__ == "__main__":
    main()
