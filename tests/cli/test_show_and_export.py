"""`show` and `export` on runs of the real problem, on runs with hostile names, and on odd runs."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path

import msgspec
import pytest
from mcap.reader import make_reader

from evodesign.cli.export import export
from evodesign.cli.output import rounded
from evodesign.cli.report import report
from evodesign.cli.show import show
from evodesign.cli.tables.people import EFFORT_TITLE
from evodesign.errors import EvodesignError, InputError, RunError
from evodesign.evaluation.evaluate import Evaluator
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.records import (
    Assessment,
    Detail,
    Evaluation,
    Objective,
    ProblemSource,
    RunHeader,
    Sense,
    Status,
)
from evodesign.runlog.header import header_of
from evodesign.runlog.run import read_run
from evodesign.runlog.writer import RunWriter
from evodesign.tree.words import in_words
from tests.report.page.reading import check_as_shown, embedded
from tests.report.scenes import hold_json, random_detail
from tests.runlog.toys import toy_detail, toy_evaluations, toy_header

pytestmark = pytest.mark.slow


def write_run(
    place: Path, header: RunHeader, evaluations: Sequence[Evaluation], details: Sequence[Detail]
) -> Path:
    with RunWriter(place, header) as log:
        known = {detail.evaluation: detail for detail in details}
        for evaluation in evaluations:
            if evaluation.number in known:
                log.write(known[evaluation.number])
            log.write(evaluation)
    return place


def header_for(problem: DesignProblem) -> RunHeader:
    return header_of(problem, problem.settings("random", 4, 1), budget=4)


@pytest.fixture(scope="module")
def evaluator(native: DesignProblem, known: Precomputed) -> Evaluator:
    """What commands that solve a design anew find ready."""
    return Evaluator(native, known)


@pytest.fixture(scope="module")
def run(native: DesignProblem, evaluator: Evaluator, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of two designs: the first with its postures, the second without."""
    evaluations, details = [], []
    for number, genome in enumerate(native.start[:2]):
        assessed = evaluator.assess(genome)
        evaluations.append(
            Evaluation(
                number=number,
                generation=0,
                genome=genome,
                assessment=assessed.assessment,
                seconds=0.1,
                worker="here",
            )
        )
        details.append(Detail(evaluation=number, cases=assessed.cases))
    assert all(detail.cases for detail in details)
    return write_run(tmp_path_factory.mktemp("runs") / "real", header_for(native), evaluations, details[:1])


def cells(text: str) -> list[list[str]]:
    """The rows of all tables in a printed card."""
    return [[cell.strip() for cell in line.split("│")[1:-1]] for line in text.splitlines() if line[:1] == "│"]


def test_card_shows_the_logged_numbers(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    show(run, 0)
    text = capsys.readouterr().out
    logged = read_run(run)
    evaluation, detail = logged.evaluations[0], logged.details[0]
    rows = cells(text)
    assert text.splitlines()[0] == "point-grasp: design 0"
    for objective in logged.header.objectives:
        value = evaluation.assessment.objectives[objective.name]
        assert [row[1] for row in rows if row[0].startswith(f"{objective.name} [")] == [rounded(value)]
    for name, value in evaluation.assessment.design.items():
        assert [row[1] for row in rows if row[0] == name] == [rounded(value)]
    for outcome in evaluation.assessment.cases:
        expected = [rounded(outcome.robot_torque_norm), rounded(outcome.human_torque_norm)]
        assert [row[1:3] for row in rows if row[0] == rounded(outcome.case.task.height_m)] == [expected]
    for agent in ("robot", "human"):
        torques = [height.agents[agent].torques_n_m for height in detail.cases]
        joints = {in_words(joint): joint for joint in torques[0]}
        shown = {joints[row[1]]: row[2:] for row in rows if row[0] == agent and row[1] in joints}
        assert len(shown) == 6
        peaks = {joint: max(abs(at[joint]) for at in torques) for joint in torques[0]}
        assert min(peaks[joint] for joint in shown) >= max(
            peak for joint, peak in peaks.items() if joint not in shown
        )
        for joint, values in shown.items():
            assert values == [rounded(at[joint]) for at in torques]
        feet = [height.agents[agent].wrenches["left_foot"] for height in detail.cases]
        expected = [rounded(sum(part**2 for part in wrench[:3]) ** 0.5) for wrench in feet]
        assert [row[2:] for row in rows if row[:2] == [agent, "left foot"]] == [expected]


def test_card_and_json_say_what_the_postures_ask_of_the_person(
    run: Path, problem: DesignProblem, capsys: pytest.CaptureFixture[str]
) -> None:
    show(run, 0, jobs=1, json=True, plot=None)
    told = json.loads(capsys.readouterr().out)["ergonomics"]
    details = read_run(run).details[0].cases
    person = problem.scene.human
    for one, detail in zip(told, details, strict=True):
        torque = detail.agents["human"].torques_n_m[one["hardest_joint"]]
        both = person.strengths[one["hardest_joint"]]
        way = both.negative if torque < 0.0 else both.positive
        assert one["movement"] == way.movement
        assert one["effort"] == pytest.approx(abs(torque) / way.moment)
        assert one["held_kg"] == pytest.approx(2.5, abs=1e-3), "half of 5 kg, with point grasps"
        assert one["hands_height_m"] == pytest.approx(detail.case.task.height_m + 0.0125, abs=1e-4)
        assert one["lifting_index"] == pytest.approx(one["held_kg"] / one["recommended_weight_kg"])
    show(run, 0)
    text = capsys.readouterr().out
    first, second = text.split(EFFORT_TITLE)
    rows, others = (
        {row[0]: row[1:] for row in cells(part) if row[0].endswith(" m")} for part in (first, second)
    )
    assert set(rows) == set(others) == {f"{detail.case.task.height_m:g} m" for detail in details}
    for one, detail in zip(told, details, strict=True):
        row = rows[f"{detail.case.task.height_m:g} m"]
        back, shear, load, _, *scores, tires = others[f"{detail.case.task.height_m:g} m"]
        assert (float(back), float(shear)) == pytest.approx(
            (one["back_compression_n"] / 1000.0, one["back_shear_n"] / 1000.0), abs=6e-3
        )
        assert (load, tires) == (f"{one['load_torque_n_m']:.1f}", in_words(one["endurance_joint"]))
        assert scores == [str(one[worksheet]["whole"]) for worksheet in ("rula", "reba")]
        assert row[0].startswith(one["hardest_joint"])
        assert row[1:3] == [f"{one['effort']:.1%}", f"{one['hands_ahead_m']:.2f}"]
        assert row[-2:] == [f"{one['recommended_weight_kg']:.1f}", f"{one['lifting_index']:.2f}"]


def test_json_is_the_log(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    show(run, 0, jobs=1, json=True, plot=None)
    captured = capsys.readouterr()
    assert captured.err == ""
    found = json.loads(captured.out)
    logged = read_run(run)
    assessment = logged.evaluations[0].assessment
    assert found["run"] == str(run)
    assert found["id"] == 0
    assert found["objectives"] == assessment.objectives
    assert found["parameters"] == assessment.design
    assert found["heights"] == [hold_json(outcome) for outcome in assessment.cases]
    assert found["postures"] == [hold_json(detail) for detail in logged.details[0].cases]
    assert found["reach"] == json.loads(msgspec.json.encode(assessment.reach))


def test_design_without_logged_postures_is_solved_anew(
    run: Path, problem: DesignProblem, evaluator: Evaluator, capsys: pytest.CaptureFixture[str]
) -> None:
    show(run, 1, jobs=1, json=True, plot=None)
    captured = capsys.readouterr()
    assert captured.err == "note: the log holds no postures of design 1, so it is solved anew\n"
    expected = evaluator.assess(problem.start[1]).cases
    assert json.loads(captured.out)["postures"] == [hold_json(detail) for detail in expected]


def test_a_report_shows_postures_of_designs_that_are_asked_for_and_not_in_the_log(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    report(run, tmp_path / "page.html", "1", jobs=1)
    assert "note: the log holds no postures of design 1, so it is solved anew\n" in capsys.readouterr().err
    show(run, 1, jobs=1, json=True, plot=None)
    solved = json.loads(capsys.readouterr().out)["postures"]
    page = embedded((tmp_path / "page.html").read_text(encoding="utf-8"))
    check_as_shown(
        {"postures": [hold_json(detail) for detail in page.designs[1].postures]}, {"postures": solved}
    )


def test_plot_writes_five_figures_twice(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    show(run, 0, jobs=1, json=False, plot=tmp_path / "new" / "figures")
    names = sorted(path.name for path in (tmp_path / "new" / "figures").iterdir())
    stems = ("postures", "postures_front", "postures_side", "torques", "torques_by_joint")
    assert names == sorted(f"{stem}.{kind}" for stem in stems for kind in ("png", "svg"))
    assert capsys.readouterr().err.count("written: ") == 10


def test_export_writes_the_logged_postures(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    export(run, 0, tmp_path / "design", jobs=1)
    printed = capsys.readouterr().out.split()
    assert sorted(printed) == sorted(str(path) for path in (tmp_path / "design").iterdir())
    told = json.loads((tmp_path / "design" / "postures.json").read_text())
    assert told["postures"] == [hold_json(detail) for detail in read_run(run).details[0].cases]


HOSTILE = "<script>alert(1)</script>[bold]../x"


@pytest.fixture(scope="module")
def hostile(problem: DesignProblem, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run whose problem, robot, joints and parameters have names that mean something elsewhere."""
    text = problem.source.text.replace('"point-grasp"', f'"{HOSTILE}"')
    text = text.replace('name = "upper_arm"', 'name = "../x"').replace(
        'name = "thigh"', f'name = "{HOSTILE}"'
    )
    text = text.replace('start = "../populations/icub.toml"', "")
    text = text.replace('"l_elbow"', '"=l_$el_bow$<b>"').replace('"r_elbow"', '"=r_$el_bow$<b>"')
    urdf = problem.source.files["robots/icub_shapes.urdf"]
    urdf = urdf.replace('name="icub_shapes"', 'name="&lt;script&gt;../x"')
    for side in ("l", "r"):
        urdf = urdf.replace(f'"{side}_elbow"', f'"={side}_$el_bow$&lt;b&gt;"')
    source = ProblemSource(path="x.toml", text=text, files={"robots/icub_shapes.urdf": urdf})
    spoilt = build_problem(source)
    assert spoilt.scene.robot.tree.name == "<script>../x"
    detail = random_detail(spoilt, 8)
    genome = (0.5,) * len(spoilt.space.parameters)
    assessment = Assessment(
        design=dict(spoilt.space.named(spoilt.space.values(genome))),
        objectives={"robot_torque": 1.0, "human_torque": 2.0, "reach_height": 1.25},
        violation=0.0,
        status=Status.SOLVED,
        reason="[red]<script>",
    )
    evaluation = Evaluation(
        number=0, generation=0, genome=genome, assessment=assessment, seconds=0.1, worker="here"
    )
    place = tmp_path_factory.mktemp("hostile") / "run"
    return write_run(place, header_for(spoilt), [evaluation], [detail])


def test_hostile_names_are_text_on_the_terminal(hostile: Path, capsys: pytest.CaptureFixture[str]) -> None:
    show(hostile, 0)
    text = capsys.readouterr().out
    assert text.splitlines()[0] == f"{HOSTILE}: design 0"
    names = [row[0] for row in cells(text)]
    assert "length.../x" in names
    assert f"length.{HOSTILE}" in names
    shown = {row[1] for row in cells(text) if row[0] == "robot"}
    assert shown & {"=l_$el_bow$<b>", "=r_$el_bow$<b>", "l_knee"}


def test_hostile_names_stay_names_in_files(hostile: Path, tmp_path: Path) -> None:
    show(hostile, 0, jobs=1, json=True, plot=tmp_path / "figures")
    export(hostile, 0, tmp_path / "design", jobs=1)
    assert {path.name for path in tmp_path.iterdir()} == {"figures", "design"}
    for path in [*(tmp_path / "figures").iterdir(), *(tmp_path / "design").iterdir()]:
        assert re.fullmatch(r"[A-Za-z_]+\.[a-z]+", path.name)
    for path in (tmp_path / "figures").glob("*.svg"):
        assert "<script" not in path.read_text()
        ET.parse(path)
    svg = (tmp_path / "figures" / "torques_by_joint.svg").read_text()
    assert "=l_$el_bow$&lt;b&gt;" in svg
    for name in ("robot.urdf", "robot.xml"):
        text = (tmp_path / "design" / name).read_text()
        assert "<script" not in text
        assert "<script>../x" in ET.fromstring(text.encode()).attrib.values()
    assert ",'=l_$el_bow$<b>," in (tmp_path / "design/postures.csv").read_text()
    readme = (tmp_path / "design" / "README.md").read_text()
    assert f"`{HOSTILE}`" in readme.splitlines()[0]
    json.loads((tmp_path / "design" / "layout.json").read_text())
    with (tmp_path / "design" / "replay.mcap").open("rb") as stream:
        assert sum(1 for _ in make_reader(stream, validate_crcs=True).iter_messages()) == 28


def toy_run(place: Path, objectives: int = 2, count: int = 8) -> Path:
    """A run of toys with one or more objectives; every design has its postures."""
    senses = (Sense.MINIMISE, Sense.MAXIMISE)
    names = ("robot_torque", "reach_height", "third", "[bold]", "fifth")[:objectives]
    chosen = tuple(
        Objective(name=name, sense=senses[index % 2], unit="N m") for index, name in enumerate(names)
    )
    search = msgspec.structs.replace(toy_header().search, objectives=objectives)
    header = msgspec.structs.replace(toy_header(), objectives=chosen, search=search)
    evaluations = []
    for evaluation in toy_evaluations(header, count):
        found = evaluation.assessment.objectives
        values = {name: found.get(name, 1.0) for name in names} if "robot_torque" in found else {}
        assessment = msgspec.structs.replace(evaluation.assessment, objectives=values)
        evaluations.append(msgspec.structs.replace(evaluation, assessment=assessment))
    return write_run(place, header, evaluations, [toy_detail(evaluation) for evaluation in evaluations])


@pytest.mark.parametrize("objectives", [1, 2, 5])
def test_any_number_of_objectives_gives_a_card(
    objectives: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    place = toy_run(tmp_path / "run", objectives)
    for number in range(8):
        show(place, number)
        rows = cells(capsys.readouterr().out)
        named = [row[0] for row in rows[:objectives]]
        names = ["robot_torque", "reach_height", "third", "[bold]", "fifth"][:objectives]
        assert [name.split(" [")[0] for name in named] == names
        assert rows[objectives][0] == "violation [m]"


def test_infeasible_design_says_why(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    place = toy_run(tmp_path / "run", count=12)
    number = next(e.number for e in read_run(place).evaluations if not e.feasible)
    show(place, number)
    text = capsys.readouterr().out
    assert "not feasible: too high by a third" in text
    assert "infeasible: too high by a" in text


def test_run_cut_by_a_crash_shows_what_it_holds(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    place = toy_run(tmp_path / "run")
    log = place / "000.mcap"
    whole = log.read_bytes()
    for length in range(len(whole), 0, -100):
        log.write_bytes(whole[:length])
        kept = read_run(place).evaluations
        if len(kept) < 8:
            break
    assert len(kept) == 7
    show(place, kept[-1].number)
    captured = capsys.readouterr()
    assert captured.out.startswith(f"toy: design {kept[-1].number}\n")
    assert "without a footer" in captured.err
    with pytest.raises(InputError, match="0 to"):
        show(place, 7)


def test_empty_run_is_explained(tmp_path: Path) -> None:
    place = write_run(tmp_path / "run", toy_header(), [], [])
    for command in (
        lambda: show(place, 0),
        lambda: export(place, 0, tmp_path / "design", jobs=1),
    ):
        with pytest.raises(RunError, match="holds no evaluation yet"):
            command()
    assert not (tmp_path / "design").exists()


def test_places_that_cannot_be_written_are_explained(run: Path, tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.write_text("mine")
    for command, words in (
        (
            lambda: show(run, 0, jobs=1, json=False, plot=file),
            "--plot: wanted a folder that can be written",
        ),
        (lambda: export(run, 0, file, jobs=1), "--to: wanted a new or empty folder"),
        (lambda: export(run, 0, tmp_path, jobs=1), "which holds files"),
        (
            lambda: export(run, 9, tmp_path / "new", jobs=1),
            "DESIGN: wanted the number of an evaluation, 0 to 1",
        ),
    ):
        with pytest.raises(EvodesignError, match=words):
            command()
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
