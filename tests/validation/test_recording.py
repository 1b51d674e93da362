"""A user's file: what is read, and what is refused, each time in one sentence with exit code 2."""

from __future__ import annotations

import json
import math
import re
import tomllib
from pathlib import Path

import pytest

from evodesign.errors import InputError
from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex, ShoulderWidth
from evodesign.human.measured_posture import measured_posture
from evodesign.validation.measured import BIN, cases_of
from evodesign.validation.posed import PosedPerson
from evodesign.validation.recording import read_frames
from tests.cli.here import evodesign

PERSON = Person(1.7, 70.0, Sex.FEMALE)
PLACES = {"hip": (0.0, 0.9), "shoulder": (0.1, 1.3), "elbow": (0.15, 1.05), "wrist": (0.3, 0.95)}
LEGS = {"ankle": (0.0, 0.08), "knee": (0.02, 0.5)}
PLATE = {"plate_force_x_n": 3.0, "plate_force_z_n": 786.7, "plate_x_m": 0.06}
OF_PERSON = ("--stature", 1.7, "--mass", 70, "--sex", "female")


def columns(places: dict[str, tuple[float, float]], **more: float) -> dict[str, float]:
    found = {f"{name}_{axis}_m": xz[i] for name, xz in places.items() for i, axis in enumerate("xz")}
    return {**found, **more}


def text_of(*rows: dict[str, object]) -> str:
    lines = [",".join(rows[0]), *(",".join(map(str, row.values())) for row in rows)]
    return "# a remark\n" + "\n".join(lines) + "\n"


HELD: dict[str, object] = {**columns(PLACES), "hand_force_n": 98.1}


def test_frames_are_read_by_recording() -> None:
    rows = [{"recording": who, "time_s": t, **HELD, "l5s1_n_m": 60.0 + t} for who in "ab" for t in (0, 1)]
    found = read_frames(text_of(*rows), "own.csv", PERSON)
    assert [*found] == ["a", "b"]
    frame = found["b"][1]
    assert (frame.hand_force, frame.wrist, frame.moments, frame.plate) == (98.1, 0.95, {"l5s1": 61.0}, None)
    assert frame.places == PLACES


def test_a_plate_tells_the_weight_in_the_hands() -> None:
    row: dict[str, object] = {**columns({**PLACES, **LEGS}), **PLATE}
    (frame,) = read_frames(text_of(row), "own.csv", PERSON)["recording"]
    assert frame.hand_force == pytest.approx(786.7 - 70.0 * 9.81)
    assert frame.plate is not None
    assert (frame.plate.forward, frame.plate.up, frame.plate.x) == (3.0, 786.7, 0.06)


def test_cases_are_ranges_of_height_with_and_without_the_load() -> None:
    rows = [
        {**HELD, "wrist_z_m": z, "hand_force_n": force}
        for z, force in ((0.4, 0.0), (0.41, 90.0), (0.44, 100.0), (0.7, 100.0))
    ]
    cases = [*cases_of("own", PERSON, read_frames(text_of(*rows), "own.csv", PERSON))]
    assert [(case.hands, case.range, len(case.frames)) for case in cases] == [
        ("box", "0.30-0.45", 2),
        ("box", "0.60-0.75", 1),
        ("empty", "0.30-0.45", 1),
    ]
    assert pytest.approx(0.15) == BIN
    assert not cases[0].has_legs


def without(*names: str) -> dict[str, object]:
    return {name: value for name, value in HELD.items() if name not in names}


REFUSED = [
    (text_of(without("wrist_z_m")), "own.csv: wanted a column 'wrist_z_m', found none of that name"),
    (
        text_of(without("hand_force_n")),
        "own.csv: wanted a column 'plate_force_x_n' (or 'hand_force_n'), found none of that name",
    ),
    (
        text_of({**HELD, **PLATE}),
        "own.csv: wanted a column 'ankle_x_m', found none of that name",
    ),
    (text_of({**HELD, "l5s1_x_m": 0.0}), "own.csv: wanted a column 'l5s1_z_m', found none of that name"),
    (
        text_of({**without("hip_x_m"), "hips_x_m": 0.0}),
        "own.csv: wanted columns that docs/trust.md lists; did you mean 'hip_x_m'?, found 'hips_x_m'",
    ),
    (
        text_of(HELD, {**HELD, "elbow_x_m": "left"}),
        "own.csv: line 4, column elbow_x_m: wanted a number, found 'left'",
    ),
    (text_of({**HELD, "hip_z_m": "nan"}), "own.csv: line 3, column hip_z_m: wanted a number, found 'nan'"),
    (
        text_of({**HELD, "hip_z_m": 1e9}),
        "own.csv: line 3, column hip_z_m: wanted a number, found '1000000000.0'",
    ),
    (
        text_of({**HELD, "shoulder_z_m": 1300.0}),
        "own.csv: line 3: wanted hip and shoulder less than 1.7 m apart, in metres, found 1299.1 m",
    ),
    (text_of(HELD) + "1,2\n", "own.csv: line 4: wanted 9 cells, found 2"),
    (
        "\n".join(text_of(HELD).splitlines()[:2]),
        "own.csv: wanted a row of numbers for each frame, found no row below the columns' names",
    ),
    ("", "own.csv: wanted a column 'hip_x_m', found none of that name"),
]


@pytest.mark.parametrize(("text", "sentence"), REFUSED)
def test_what_is_wrong_is_said_in_one_sentence(text: str, sentence: str) -> None:
    with pytest.raises(InputError) as refused:
        read_frames(text, "own.csv", PERSON)
    assert str(refused.value) == sentence


def test_the_command_refuses_with_exit_code_two(tmp_path: Path) -> None:
    bad, good = tmp_path / "bad.csv", tmp_path / "good.csv"
    bad.write_text(REFUSED[0][0], encoding="utf-8")
    good.write_text(text_of(HELD), encoding="utf-8")
    (tmp_path / "bytes.csv").write_bytes(b"\xff\xfe\x00")
    wrong: list[tuple[tuple[object, ...], str]] = [
        ((bad, *OF_PERSON), f"error: {bad}: wanted a column 'wrist_z_m', found none of that name"),
        ((good,), "error: --stature: wanted this option beside FILE, found nothing"),
        ((good, *OF_PERSON[:4]), "error: --sex: wanted this option beside FILE, found nothing"),
        ((good, *OF_PERSON[:5], "x"), "error: --sex: wanted male or female, found 'x'"),
        (("--mass", 60), "error: --mass: wanted a FILE, whose person it describes, found none"),
        (
            (tmp_path / "no.csv", *OF_PERSON),
            f"error: {tmp_path / 'no.csv'}: wanted a CSV file that can be read",
        ),
        (
            (tmp_path / "bytes.csv", *OF_PERSON),
            f"error: {tmp_path / 'bytes.csv'}: wanted a CSV file in UTF-8",
        ),
        ((good, "--stature", 17, *OF_PERSON[2:]), "error: --stature: wanted a number from 1.45 to 2.05"),
    ]
    for arguments, sentence in wrong:
        done = evodesign("validate", *arguments)
        assert (done.returncode, done.stdout) == (2, "")
        assert done.stderr.startswith(sentence)
        assert done.stderr.count("\n") == 1


def test_a_file_of_ones_own_is_compared(tmp_path: Path) -> None:
    """With a plate: the measured moment is ours where the plate balances the posture."""
    file = tmp_path / "own.csv"
    file.write_text(text_of({**columns({**PLACES, **LEGS}), **PLATE}), encoding="utf-8")
    done = evodesign("validate", file, *OF_PERSON, "--json", "--plot", tmp_path / "figures")
    assert done.returncode == 0
    found = json.loads(done.stdout)
    (case,) = found["lifts"]
    assert (case["lift"], case["hands"], case["wrists"], case["sex"]) == ("own", "box", "0.90-1.05", "female")
    assert case["hand_force_n"] == pytest.approx(100.0, abs=0.1)
    assert set(case["predicted"]) == {"measured", "least_torque"}
    assert {each["quantity"] for each in found["agreement"]} == {"L5/S1", "five angles"}
    assert found["holds"] == []
    assert sorted(path.name for path in (tmp_path / "figures").iterdir()) == [
        "l5s1_moment.png", "l5s1_moment.svg", "postures_side.png", "postures_side.svg"
    ]  # fmt: skip
    table = evodesign("validate", file, *OF_PERSON)
    assert table.returncode == 0
    assert "own: moment at L5/S1 [N m], means by height" in table.stdout


def test_a_person_is_fitted_to_a_recording(tmp_path: Path) -> None:
    """Described as a woman of 1.70 m and 70 kg, she has 1.63 m and 61.2 kg, and leans 7 degrees more."""
    her = PosedPerson(Person(1.63, 61.2, Sex.FEMALE, ShoulderWidth.JOINT_CENTRES))
    mean = measured_posture(1.63).hold.mean(0.34)
    leaning = {**mean, "trunk_low": mean["trunk_low"] + math.radians(7.0)}
    places = her.places(her.model.at(her.from_angles(leaning)))
    held = {
        "plate_force_x_n": 0.0,
        "plate_force_z_n": 61.2 * 9.81 + 80.0,
        "plate_x_m": 0.05,
        "hand_force_n": 80.0,
    }
    file = tmp_path / "her.csv"
    file.write_text(text_of({**columns({**places}), **held}), encoding="utf-8")
    done = evodesign("validate", file, *OF_PERSON, "--fit")
    assert done.returncode == 0
    table = tomllib.loads(done.stdout[done.stdout.index("[human]") :])["human"]
    assert table["stature_m"] == pytest.approx(1.63, abs=0.002)
    assert table["mass_kg"] == pytest.approx(61.2, abs=0.05)
    assert (table["sex"], table["posture"]) == ("female", "measured")
    (remark,) = (line for line in done.stdout.splitlines() if "trunk_low" in line)
    assert 3 <= int(re.findall(r"trunk_low ([+-]\d+)", remark)[0]) <= 11
    (angles,) = (line for line in done.stdout.splitlines() if line.startswith("# five angles, predicted"))
    described, fitted = map(int, re.findall(r"(\d+) degrees rms", angles))
    assert fitted <= described + 1
    refused = evodesign("validate", "--fit")
    assert (refused.returncode, refused.stderr) == (
        2,
        "error: --fit: wanted a FILE, without --json, found no FILE\n",
    )


def test_places_far_from_the_origin_and_moments_of_zero_are_compared(tmp_path: Path) -> None:
    far = {name: (x + 40.0, z) for name, (x, z) in PLACES.items()}
    file = tmp_path / "far.csv"
    file.write_text(text_of({**columns(far), "hand_force_n": 50.0, "l5s1_n_m": 0.0}), encoding="utf-8")
    done = evodesign("validate", file, *OF_PERSON, "--json")
    assert done.returncode == 0
    found = json.loads(done.stdout)
    hip = found["lifts"][0]["measured_posture"]["places_x_z_m"]["hip"]
    assert math.dist(hip, far["hip"]) < 0.1
    assert found["agreement"][0]["statics"]["slope"] is None
