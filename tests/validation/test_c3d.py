"""A c3d file gives what a CSV of the same motion gives, whatever its axes, units and plates."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from evodesign.errors import InputError
from evodesign.human.anthropometry import Person
from evodesign.human.anthropometry_tables import Sex, ShoulderWidth
from evodesign.human.measured_posture import measured_posture
from evodesign.validation.c3d import read_c3d
from evodesign.validation.c3d_points import BELL, Axis, Joints, LengthUnit, PointsFile, read_points
from evodesign.validation.posed import PosedPerson
from evodesign.validation.recording import read_frames
from tests.cli.here import evodesign
from tests.validation.c3d_files import plate_channels, write_c3d
from tests.validation.test_recording import columns, text_of

pytest.importorskip("ezc3d", reason="c3d files are read by ezc3d, which is an extra")

Array = NDArray[np.float64]

HER = Person(1.66, 63.0, Sex.FEMALE, ShoulderWidth.JOINT_CENTRES)
OF_HER = ("--stature", 1.66, "--mass", 63, "--sex", "female")
HALF_WIDTHS = {"ankle": 0.09, "knee": 0.09, "hip": 0.08, "shoulder": 0.17, "elbow": 0.2, "wrist": 0.2}
LABELS = {"ankle": "AJC", "knee": "KJC", "hip": "HJC", "shoulder": "SJC", "elbow": "EJC", "wrist": "WJC"}
ETAS = (0.2, 0.3, 0.45, 0.6)
FORCE = np.array([4.0, 0.0, 63.0 * 9.81 + 90.0])
PRESSED = 0.07
"""x of the centre of pressure [m]."""

TURNS = {
    "x forward, z up": np.eye(3),
    "z forward, y up": np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]),
    "y backwards, z up": np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
}
"""Rows: forward, left and up in the axes of the file, as columns."""


@pytest.fixture(scope="module")
def places() -> list[dict[str, tuple[float, float]]]:
    """Of joints at rest with the palms at four heights."""
    posed, given = PosedPerson(HER), measured_posture(HER.stature).hold
    return [dict(posed.places(posed.model.at(posed.from_angles(given.mean(eta))))) for eta in ETAS]


def points_of(places: list[dict[str, tuple[float, float]]], turn: Array) -> dict[str, Array]:
    """Both sides of all joints but the spine's, which lie in the middle."""
    found = {}
    for name in places[0]:
        xz = np.array([each[name] for each in places])
        for side, sign in {"L": 1.0, "R": -1.0}.items() if name in LABELS else {"": 0.0}.items():
            y = np.full(len(xz), sign * HALF_WIDTHS.get(name, 0.0))
            label = f"{side}{LABELS[name]}" if name in LABELS else name.upper()
            found[label] = np.column_stack([xz[:, 0], y, xz[:, 1]]) @ turn.T
    return found


def plates_of(
    count: int, turn: Array, stored: float, height: float = 0.0
) -> list[tuple[Array, Array, Array]]:
    """A plate under each foot: the left one carries 60 %, farther ahead; their axis z points down."""
    found = []
    for share, middle, x in ((0.6, 0.15, PRESSED + 0.02), (0.4, -0.15, PRESSED - 0.03)):
        corners = np.array([[0.3, -0.12], [-0.3, -0.12], [-0.3, 0.12], [0.3, 0.12]]) + np.array([0.1, middle])
        at = np.column_stack([corners, np.full(4, height)]) @ turn.T
        force = np.tile(stored * share * FORCE @ turn.T, (count, 1))
        place = np.tile(np.array([x, middle + 0.02, height]) @ turn.T, (count, 1))
        origin = np.array([0.002, -0.001, -0.04])
        found.append((plate_channels(force, place, at, origin), at, origin))
    return found


def as_csv(places: list[dict[str, tuple[float, float]]]) -> str:
    plate = {"plate_force_x_n": FORCE[0], "plate_force_z_n": FORCE[2], "plate_x_m": PRESSED}
    return text_of(*({**columns({**each}), **plate} for each in places))


@pytest.mark.parametrize("unit", ["mm", "m"])
@pytest.mark.parametrize("stored", [1.0, -1.0], ids=["reaction", "what presses"])
@pytest.mark.parametrize("axes", TURNS)
def test_a_c3d_gives_the_frames_of_a_csv(
    places: list[dict[str, tuple[float, float]]], tmp_path: Path, unit: str, stored: float, axes: str
) -> None:
    """The sum of both plates has its centre of pressure where their weighted mean is."""
    turn = TURNS[axes]
    file = write_c3d(
        tmp_path / "her.c3d", points_of(places, turn), plates_of(len(places), turn, stored), unit
    )
    own = PointsFile(middle=Joints(l5s1=("L5S1",), t12=("T12",)))
    found = read_c3d(file, HER, own, "own.toml")["her"]
    wanted = read_frames(as_csv(places), "her.csv", HER)["recording"]
    assert len(found) == len(wanted) == len(ETAS)
    for here, there in zip(found, wanted, strict=True):
        assert here.places.keys() == there.places.keys()
        for name in here.places:
            assert here.places[name] == pytest.approx(there.places[name], abs=1e-5)
        assert here.plate is not None
        assert there.plate is not None
        for name in ("forward", "up", "x"):
            assert getattr(here.plate, name) == pytest.approx(getattr(there.plate, name), rel=1e-5, abs=1e-5)
        assert here.hand_force == pytest.approx(90.0, abs=1e-2)
        assert not here.hand_measured


def test_a_person_who_faces_across_the_axes_is_turned(
    places: list[dict[str, tuple[float, float]]], tmp_path: Path
) -> None:
    angle = np.radians(30.0)
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0.0], [np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]]
    )
    file = write_c3d(tmp_path / "her.c3d", points_of(places, turn), plates_of(len(places), turn, -1.0))
    found = read_c3d(file, HER, PointsFile(), "")["her"]
    for here, there in zip(found, places, strict=True):
        assert here.places["wrist"] == pytest.approx(there["wrist"], abs=1e-5)
        assert here.plate is not None
        assert here.plate.x == pytest.approx(PRESSED, abs=1e-5)


def test_heights_count_from_the_plates(places: list[dict[str, tuple[float, float]]], tmp_path: Path) -> None:
    """Plates 0.2 m above zero, with the person on them: the moment of the forward force is the floor's."""
    lifted = [{name: (x, z + 0.2) for name, (x, z) in each.items()} for each in places]
    turn = TURNS["z forward, y up"]
    file = write_c3d(tmp_path / "her.c3d", points_of(lifted, turn), plates_of(len(places), turn, 1.0, 0.2))
    found = read_c3d(file, HER, PointsFile(), "")["her"]
    for here, there in zip(found, places, strict=True):
        assert here.places["hip"] == pytest.approx(there["hip"], abs=1e-5)
        assert here.plate is not None
        assert here.plate.x == pytest.approx(PRESSED, abs=1e-5)


def test_markers_stand_for_joints(places: list[dict[str, tuple[float, float]]], tmp_path: Path) -> None:
    """Names of Plug-in Gait behind the subject's; the hips from four markers of an upright pelvis."""
    points = points_of(places, np.eye(3))
    wide, (behind, below, inwards) = 0.24, BELL
    marked = {f"Anna:{s}{m}": points[f"{s}{j}"] for s in "LR" for m, j in (("ANK", "AJC"), ("KNE", "KJC"))}
    marked |= {f"Anna:{s}{m}": points[f"{s}{j}"] for s in "LR" for m, j in (("SHO", "SJC"), ("ELB", "EJC"))}
    for side, sign in (("L", 1.0), ("R", -1.0)):
        hip = points[f"{side}HJC"] * [1.0, 0.0, 1.0] + np.array([0.0, sign * (0.5 - inwards) * wide, 0.0])
        spine = hip + np.array([behind * wide, sign * inwards * wide, below * wide])
        marked |= {f"Anna:{side}ASI": spine, f"Anna:{side}PSI": spine - [0.16, sign * 0.07, 0.0]}
        for name, offset in (("WRA", 0.03), ("WRB", -0.03)):
            marked[f"Anna:{side}{name}"] = points[f"{side}WJC"] + np.array(
                [0.0, offset, 0.01 * np.sign(offset)]
            )
    file = write_c3d(tmp_path / "her.c3d", marked)
    frames = read_c3d(file, HER, PointsFile(hand_force_n=50.0), "")["her"]
    for here, there in zip(frames, places, strict=True):
        for name in HALF_WIDTHS:
            assert here.places[name] == pytest.approx(there[name], abs=1e-5)
        assert (here.hand_force, here.hand_measured, here.plate) == (50.0, True, None)


def test_hidden_frames_are_left_out_and_five_a_second_are_used(
    places: list[dict[str, tuple[float, float]]], tmp_path: Path
) -> None:
    many = [places[0]] * 40
    points = points_of(many, np.eye(3))
    points["LWJC"][3:6] = np.nan
    points["RHJC"][20] = 0.0
    file = write_c3d(tmp_path / "her.c3d", points, rate=20.0)
    assert len(read_c3d(file, HER, PointsFile(hand_force_n=0.0), "")["her"]) == 8
    points["LWJC"][:] = np.nan
    with pytest.raises(InputError, match="points of the wrist by a common name, such as LWJC, or named"):
        read_c3d(write_c3d(tmp_path / "her.c3d", points | {"RWJC": points["LWJC"]}), HER, PointsFile(), "")


def test_a_file_of_names_is_read(tmp_path: Path) -> None:
    file = tmp_path / "points.toml"
    file.write_text(
        'unit = "mm"\nup = "y"\nforward = "-x"\nplates = [2]\nhand_force_n = 98.1\n'
        '[left]\nhip = ["A", "B"]\n[right]\nhip = ["C"]\n[middle]\nl5s1 = ["D"]\n',
        encoding="utf-8",
    )
    given = read_points(file)
    assert (given.unit, given.up, given.forward) == (LengthUnit.MILLIMETRE, Axis.Y, Axis.MINUS_X)
    assert given.named() == {"hip": {"left": ("A", "B"), "right": ("C",)}, "l5s1": {"middle": ("D",)}}
    for axis, another in pairwise(Axis):
        assert np.linalg.norm(axis.vector) == 1.0
        assert axis.vector @ another.vector <= 0.0


def test_what_is_wrong_is_said_in_one_sentence(
    places: list[dict[str, tuple[float, float]]], tmp_path: Path
) -> None:
    points, turn = points_of(places, np.eye(3)), np.eye(3)
    legs = [name for name in points if name[1:] in ("AJC", "KJC")]
    held = PointsFile(hand_force_n=10.0)
    plates = plates_of(len(places), turn, 1.0)
    one = {name: track for name, track in points.items() if not name.startswith("R")}
    slanted = {
        name: track @ np.array([[1.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 1.0]])
        for name, track in points.items()
    }
    cases: list[tuple[Mapping[str, Array], Sequence[tuple[Array, Array, Array]], str, PointsFile, str]] = [
        (
            points,
            [],
            "mm",
            PointsFile(),
            "FORCE_PLATFORM: wanted force plates, or hand_force_n in --points FILE",
        ),
        (points, [], "inch", held, "POINT:UNITS: wanted m, cm, mm or unit in --points FILE, found 'inch'"),
        (one, [], "mm", held, "forward: wanted points of both sides of a joint, or forward in --points FILE"),
        (
            points,
            [],
            "mm",
            PointsFile(hand_force_n=1.0, left=Joints(hip=("LHJ",))),
            "own.toml: left.hip: wanted a point of the c3d file; did you mean 'LHJC'?, found 'LHJ'",
        ),
        (
            points,
            [],
            "mm",
            PointsFile(hand_force_n=1.0, up=Axis.Z, forward=Axis.MINUS_Z),
            "forward: wanted a direction across up in --points FILE, found '-z'",
        ),
        (
            points,
            plates,
            "mm",
            PointsFile(plates=(3,)),
            "plates: wanted numbers up to 2, the last plate's, found 3",
        ),
        (
            {name: track for name, track in points.items() if name not in legs},
            plates,
            "mm",
            PointsFile(),
            "knee, ankle: wanted points of knee and ankle beside plates, or plates = [] and",
        ),
        (
            slanted,
            [],
            "mm",
            held,
            "up: wanted an axis along the line from ankles to shoulders, or up in --points",
        ),
    ]
    for tracks, stands, unit, given, sentence in cases:
        file = write_c3d(tmp_path / "her.c3d", tracks, stands, unit)
        with pytest.raises(InputError) as refused:
            read_c3d(file, HER, given, "own.toml")
        assert sentence in str(refused.value)


def test_moments_of_another_unit_are_refused(
    places: list[dict[str, tuple[float, float]]], tmp_path: Path
) -> None:
    plates = plates_of(len(places), np.eye(3), 1.0)
    file = write_c3d(tmp_path / "her.c3d", points_of(places, np.eye(3)), plates, moment_unit="Nm")
    with pytest.raises(InputError, match="wanted forces in N and moments in Nmm, as its places, found 'Nm'"):
        read_c3d(file, HER, PointsFile(), "")
    wrong = [(np.vstack([c[:3], 1000.0 * c[3:]]), at, origin) for c, at, origin in plates]
    file = write_c3d(tmp_path / "her.c3d", points_of(places, np.eye(3)), wrong)
    with pytest.raises(InputError, match="wanted a centre of pressure within the plate's corners"):
        read_c3d(file, HER, PointsFile(), "")


def test_a_box_on_another_plate_is_left_out(
    places: list[dict[str, tuple[float, float]]], tmp_path: Path
) -> None:
    plates = plates_of(len(places), np.eye(3), -1.0)
    file = write_c3d(tmp_path / "her.c3d", points_of(places, np.eye(3)), plates)
    (frame, *_) = read_c3d(file, HER, PointsFile(plates=(1,), hand_force_n=0.0), "")["her"]
    assert frame.plate is not None
    assert frame.plate.up == pytest.approx(0.6 * FORCE[2], rel=1e-6)
    assert frame.plate.x == pytest.approx(PRESSED + 0.02, abs=1e-5)


@pytest.mark.slow
def test_the_command_gives_the_same_of_both_files(
    places: list[dict[str, tuple[float, float]]], tmp_path: Path
) -> None:
    csv, points = tmp_path / "her.csv", tmp_path / "points.toml"
    csv.write_text(as_csv([{k: v for k, v in each.items() if k != "t12"} for each in places]), "utf-8")
    turn = TURNS["z forward, y up"]
    c3d = write_c3d(tmp_path / "her.c3d", points_of(places, turn), plates_of(len(places), turn, -1.0))
    points.write_text('[middle]\nl5s1 = ["L5S1"]\n', encoding="utf-8")
    done = [evodesign("validate", csv, *OF_HER, "--json")]
    done.append(evodesign("validate", c3d, *OF_HER, "--points", points, "--json"))
    assert [each.returncode for each in done] == [0, 0]
    there, here = (json.loads(each.stdout) for each in done)
    assert len(here["lifts"]) == len(there["lifts"]) == len(ETAS)
    for mine, theirs in zip(here["lifts"], there["lifts"], strict=True):
        assert mine["measured_n_m"] == pytest.approx(theirs["measured_n_m"], abs=0.02)
        assert mine["measured_posture"]["moments_n_m"] == pytest.approx(
            theirs["measured_posture"]["moments_n_m"], abs=0.02
        )
        assert mine["predicted"]["measured"]["moments_n_m"] == pytest.approx(
            theirs["predicted"]["measured"]["moments_n_m"], abs=0.2
        )


def test_the_command_refuses_with_exit_code_two(tmp_path: Path) -> None:
    bad, names, unknown = tmp_path / "bad.c3d", tmp_path / "points.toml", tmp_path / "unknown.toml"
    bad.write_bytes(b"\x02P" + bytes(2000))
    names.write_text("", encoding="utf-8")
    unknown.write_text('[left]\nhips = ["LHJC"]\n', encoding="utf-8")
    wrong: list[tuple[tuple[object, ...], str]] = [
        ((bad, *OF_HER), f"error: {bad}: wanted a c3d file that ezc3d can read"),
        (
            (tmp_path / "no.c3d", *OF_HER),
            f"error: {tmp_path / 'no.c3d'}: wanted an existing file, found none",
        ),
        ((tmp_path / "a.csv", *OF_HER, "--points", names), "error: --points: wanted a c3d FILE"),
        (("--points", names), "error: --points: wanted a c3d FILE, whose points it names, found none"),
        ((bad, *OF_HER, "--points", unknown), f"error: {unknown}: left.hips: wanted"),
    ]
    for arguments, sentence in wrong:
        done = evodesign("validate", *arguments)
        assert (done.returncode, done.stdout) == (2, "")
        assert done.stderr.startswith(sentence)
        assert done.stderr.count("\n") == 1


def test_without_ezc3d_the_command_to_install_it_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("evodesign.validation.c3d_reading.find_spec", lambda name: None)
    with pytest.raises(InputError) as refused:
        read_c3d(tmp_path / "her.c3d", HER, PointsFile(), "")
    assert str(refused.value).endswith(
        "her.c3d: wanted ezc3d installed (pip install 'evodesign[measured]'), found no package 'ezc3d'"
    )


def test_damaged_files_end_in_a_sentence(
    places: list[dict[str, tuple[float, float]]], tmp_path: Path
) -> None:
    """The reader's process may crash; ours does not."""
    file = write_c3d(
        tmp_path / "her.c3d", points_of(places, np.eye(3)), plates_of(len(places), np.eye(3), 1.0)
    )
    whole, damaged, refused = file.read_bytes(), tmp_path / "damaged.c3d", 0
    random = np.random.default_rng(3)
    for _ in range(8):
        damaged.write_bytes(whole[: random.integers(20, len(whole))])
        try:
            read_c3d(damaged, HER, PointsFile(), "")
        except InputError:
            refused += 1
    assert refused >= 4
