"""`validate`: our person beside people who were measured."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from evodesign.cli.options import Json
from evodesign.errors import InputError
from evodesign.files import make_folder

if TYPE_CHECKING:
    from collections.abc import Sequence

    from evodesign.human.anthropometry import Person
    from evodesign.validation.compare import ComparedCase
    from evodesign.validation.measured import MeasuredCase


def validate(
    file: Annotated[
        Path | None,
        typer.Argument(
            metavar="FILE",
            help="A file of your own: a c3d, or a CSV of joint places and forces as docs/trust.md describes.",
            show_default="the lifts that come with evodesign",
        ),
    ] = None,
    stature: Annotated[
        float | None, typer.Option(metavar="M", help="Of the person in FILE [m].", show_default="none")
    ] = None,
    mass: Annotated[
        float | None, typer.Option(metavar="KG", help="Of the person in FILE [kg].", show_default="none")
    ] = None,
    sex: Annotated[
        str | None,
        typer.Option(metavar="SEX", help="Of the person in FILE: male or female.", show_default="none"),
    ] = None,
    points: Annotated[
        Path | None,
        typer.Option(
            metavar="TOML",
            help="Which points of a c3d FILE are which joints, and its axes: docs/trust.md.",
            show_default="common names",
        ),
    ] = None,
    fit: Annotated[
        bool, typer.Option("--fit", help="Also print the person of FILE as a table for a problem file.")
    ] = False,
    json: Json = False,
    plot: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Also write figures: stick figures from the side, moments by height (SVG and PNG).",
        ),
    ] = None,
) -> None:
    """People who were measured, beside our statics in their postures and our predictions of them."""
    from evodesign.cli.output import console, print_json, print_lines, show_notes
    from evodesign.cli.progress import counted
    from evodesign.validation.compare import compare

    cases = _cases(file, stature, mass, sex, points)
    if fit and (file is None or json):
        raise InputError("--fit", "", "a FILE, without --json", "no FILE" if file is None else "--json")
    if plot is not None:
        make_folder(plot, "--plot")
    with counted("lifts", len(cases)) as step:
        compared = compare(cases, lambda _: step())
    from evodesign.validation.holds import compare_holds

    holds = compare_holds() if file is None else []
    if plot is not None:
        from evodesign.report.figures.validation import write_validation_figures  # matplotlib takes its time

        show_notes(f"written: {path}" for path in write_validation_figures(compared, plot))
    if json:
        from evodesign.validation.agreement import validation_json

        print_json(validation_json(compared, holds))
        return
    from evodesign.cli.tables.validation import validation_tables

    for table in validation_tables(compared, holds):
        console().print(table)
    if fit:
        print_lines(*_fitted(compared))
    if file is None:
        print_lines("Each man of the box lift is predicted without his own data: docs/trust.md.")


def _fitted(compared: Sequence[ComparedCase]) -> list[str]:
    """The person of a recording as a table, with how far figures agree before and after."""
    from evodesign.validation.compare import compare
    from evodesign.validation.fit import fit, fit_lines, fitted_person

    person = compared[0].case.person
    found = fit(person, compared)
    cases = [replace(each.case, person=fitted_person(person, found)) for each in compared]
    return fit_lines(person, found, compared, compare(cases))


def _cases(
    file: Path | None, stature: float | None, mass: float | None, sex: str | None, points: Path | None
) -> tuple[MeasuredCase, ...]:
    """The shipped cases, or those of a file."""
    from evodesign.validation.measured import cases_of, shipped_cases

    if file is None:
        for option, given in (("--stature", stature), ("--mass", mass), ("--sex", sex)):
            if given is not None:
                raise InputError(option, "", "a FILE, whose person it describes", "none")
        if points is not None:
            raise InputError("--points", "", "a c3d FILE, whose points it names", "none")
        return shipped_cases()
    from evodesign.validation.c3d import is_c3d, read_c3d
    from evodesign.validation.c3d_points import PointsFile, read_points
    from evodesign.validation.recording import read_recording

    person = _person(stature, mass, sex)
    if is_c3d(file):
        named = PointsFile() if points is None else read_points(points)
        return tuple(cases_of(file.stem, person, read_c3d(file, person, named, str(points))))
    if points is not None:
        raise InputError("--points", "", "a c3d FILE, whose points it names", f"'{file}'")
    return tuple(cases_of(file.stem, person, read_recording(file, person)))


def _person(stature: float | None, mass: float | None, sex: str | None) -> Person:
    from evodesign.human.anthropometry import Person
    from evodesign.human.anthropometry_tables import Sex, ShoulderWidth

    if stature is None or mass is None or sex is None:
        given = {"--stature": stature, "--mass": mass, "--sex": sex}
        missing = next(option for option, value in given.items() if value is None)
        raise InputError(missing, "", "this option beside FILE", "nothing")
    if sex not in [*Sex]:
        raise InputError("--sex", "", " or ".join(Sex), f"'{sex}'")
    try:
        return Person(stature, mass, Sex(sex), ShoulderWidth.JOINT_CENTRES)
    except InputError as error:
        option = {"stature_m": "--stature", "mass_kg": "--mass"}[error.key]
        raise InputError(option, "", error.wanted, error.found) from error
