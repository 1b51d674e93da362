"""`reproduce` and `baseline` from the command line, on problems small enough for a test."""

from __future__ import annotations

import csv
import json
import math
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from evodesign.cli.baseline import baseline
from evodesign.cli.reproduce import reproduce
from evodesign.errors import InputError
from evodesign.evaluation.progress import PrecomputeProgress
from evodesign.report.opened_design import open_design
from evodesign.runlog.run import read_run

pytestmark = pytest.mark.slow

SMALL = "\n[solver]\nsymmetry = 'on'\nstart_portfolio = false\n"
QUICK = "\n[solver]\nsymmetry = 'off'\nstart_portfolio = false\n"
"""Nothing is worked out beforehand; solves are few."""


@pytest.fixture(scope="module")
def folder(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The paper's two problems at one height, quick to make ready, with the files that they name."""
    base = tmp_path_factory.mktemp("paper")
    for place in ("populations", "problems/robots"):
        (base / place).parent.mkdir(parents=True, exist_ok=True)
        (base / place).symlink_to(repository / place)
    for name, change in (("sartore2022.toml", QUICK), ("sartore2022_as_published.toml", "")):
        text = (repository / "problems" / name).read_text().replace("[0.8, 1.0, 1.2, 1.5]", "[1.0]")
        text = text.replace("length_bounds = false", "length_bounds = true")
        (base / "problems" / name).write_text(text + change)
    return base


def test_the_paper_is_reproduced_with_verdicts_and_figures(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    to, limited = tmp_path / "out", folder / "problems" / "sartore2022.toml"
    published = folder / "problems" / "sartore2022_as_published.toml"
    effort = {
        "paper": 2022,
        "starts": 1,
        "evaluations": 2,
        "seed": 1,
        "minutes": 10.0,
        "jobs": 1,
        "pool": "serial",
    }
    reproduce(to, problem=limited, published=published, **effort, json=True)
    shown = json.loads(capsys.readouterr().out)
    verdicts = {(claim["subject"], claim["by"]): claim["reproduced"] for claim in shown["claims"]}
    assert len(verdicts) == 7
    assert verdicts["Table II", "published setting"] is False
    assert shown["published"]["torque_difference"] < 1e-5
    assert "joint limits" in shown["published"]["broken_limits"]
    stricter = shown["stricter"]["original"]
    assert list(stricter) == ["with limits", "and grips", "and collisions"]
    assert stricter["with limits"] == shown["torque_norms"]["original"]["with limits"]
    assert all(rows and rows[0]["human"] > 0.0 for rows in stricter.values())
    assert [row["height_m"] for row in shown["torque_norms"]["original"]["with limits"]] == [1.0]
    (measured,) = shown["torque_norms"]["original"]["measured person"]
    (least,) = shown["torque_norms"]["original"]["with limits"]
    assert measured["human"] > 2.0 * least["human"]
    assert shown["torque_norms"]["optimised"]["paper"][0]["human"] == 192.4057
    assert shown["found"]["gradient"]["statuses"] == {"infeasible": 1} or shown["found"]["gradient"]["cost"]
    assert len(read_run(to / "evolution").evaluations) == 2
    assert sorted(path.name for path in to.iterdir() if path.suffix == ".png") == [
        "human_torques.png",
        "postures_evolution.png",
        "postures_gradient.png",
        "postures_original.png",
        "postures_published_optimised.png",
        "postures_published_original.png",
        "robot_torques.png",
    ]
    robot = ET.parse(to / "original.urdf").getroot()
    assert robot.tag == "robot"
    with pytest.raises(InputError, match="a new or empty folder"):
        reproduce(to, problem=limited, published=limited, **effort, json=True)


@pytest.mark.usefixtures("few_designs_meet")
def test_the_sequel_is_reproduced_with_its_robots_and_a_search(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """With one person, one load and one height of three."""
    text = (Path(__file__).parents[2] / "problems" / "sartore2023.toml").read_text()
    people, loads = text.split("[[human]]\n"), text.split("[[payload]]\n")
    one = people[0] + "[[human]]\n" + people[1] + "[[payload]]\n" + loads[3]
    small = folder / "problems" / "sequel.toml"
    small.write_text(
        one.replace("[0.8, 1.0, 1.2]", "[1.0]").replace("population = 48", "population = 4") + SMALL
    )
    to = tmp_path / "out"
    given = {"problem": str(small), "paper": 2023, "evaluations": 4, "jobs": 1, "pool": "serial"}
    reproduce(to, published=None, starts=None, seed=1, minutes=10.0, json=True, **given)
    shown = json.loads(capsys.readouterr().out)
    robots, search = shown["robots"], shown["search"]
    assert {name: robot["held"] for name, robot in robots.items()} == dict.fromkeys(robots, 1)
    assert robots["ga"]["fitness"] == pytest.approx(100.0 / robots["ga"]["cost"])
    assert robots["log_1"]["logged_fitness"] == pytest.approx(0.18622, abs=1e-5)
    assert robots["nl"]["mass"] == pytest.approx(robots["unscaled"]["mass"], abs=1e-3)
    for robot in robots.values():  # one height of one pair, so that the cost can be had from the means
        assert robot["cost"] == pytest.approx(robot["robot_torque"] / 160.0 + robot["human_torque"])
    stricter = {name: robot["with_grips_and_collisions"] for name, robot in robots.items()}
    built = {name: robot["bodies_apart"] >= 0.0 for name, robot in stricter.items()}
    assert {name: robot["held"] for name, robot in stricter.items()} == {
        n: int(yes) for n, yes in built.items()
    }
    assert built["unscaled"]
    assert not built["log_6"], "its chest is in the pelvis"
    assert stricter["ga"]["mass"] == robots["ga"]["mass"]
    assert stricter["unscaled"]["cost"] != robots["unscaled"]["cost"]
    run = read_run(to / "search")
    assert len(run.evaluations) == search["evaluations"] == 4
    chosen = run.evaluations[search["evaluation"]].assessment
    assert chosen.objectives["paper2023_cost"] == pytest.approx(robots["search"]["cost"], rel=1e-6)
    verdicts = {claim["subject"]: claim["reproduced"] for claim in shown["claims"]}
    assert len(verdicts) == 6
    assert verdicts["torques of its log"] is False
    assert sorted(path.name for path in to.glob("*.urdf")) == sorted(f"{name}.urdf" for name in robots)


@pytest.mark.usefixtures("few_designs_meet")
def test_the_robots_of_2025_are_compared_beside_all_people_and_with_two_searches(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """With the load at one height; costs are computed again from the table of torques."""
    text = (Path(__file__).parents[2] / "problems" / "sartore2025.toml").read_text()
    small = folder / "problems" / "third.toml"
    small.write_text(text.replace("[0.8, 1.0, 1.2, 1.5]", "[1.0]") + SMALL)
    to = tmp_path / "out"
    given = {"problem": str(small), "paper": 2025, "evaluations": 4, "jobs": 1, "pool": "serial"}
    reproduce(to, published=None, starts=None, seed=1, minutes=10.0, json=True, **given)
    shown = json.loads(capsys.readouterr().out)
    robots = shown["robots"]
    assert list(robots) == ["iCub", "A", "B", "C", "by_cost", "by_front"]
    assert {round(each["mass"], 6) for each in robots.values()} == {58.573865}
    with (to / "robots.csv").open(newline="") as stream:
        rows = [*csv.DictReader(stream)]
    assert len(rows) == len(robots) * 4
    for row in rows:
        (held,) = robots[row["robot"]]["by_person"][row["person"]]
        assert [held["robot"], held["human"], held["back"]] == [
            float(row[key]) for key in ("robot_torque_n_m", "human_torque_n_m", "back_compression_n")
        ]
        if row["person"] == "least torque":
            assert robots[row["robot"]]["cost"] == pytest.approx(
                held["human"] ** 2 + 1e-6 * held["robot"] ** 2
            )
        if row["person"] == "male P95":
            assert held["back"] > 1000.0 > robots[row["robot"]]["by_person"]["female P5"][0]["back"]
    verdicts = [(claim["subject"], claim["by"]) for claim in shown["claims"]]
    assert len(set(verdicts)) == len(verdicts) == 11
    for name, search in shown["searches"].items():
        run = read_run(to / name)
        assert len(run.evaluations) == search["evaluations"] == 4
        design = run.evaluations[search["evaluation"]].assessment.design
        assert design.items() <= robots[name]["parameters"].items()
    assert {path.suffix for path in to.iterdir() if path.is_file()} == {".csv", ".png", ".svg", ".urdf"}
    assert {path.stem for path in to.glob("*.urdf")} == set(robots)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"paper": 2021}, "--paper: wanted 2022 or 2023 or 2025, found 2021"),
        ({"paper": 2025, "problem": "sartore2022"}, "objectives: wanted paper2025_cost, found paper_cost"),
        ({"paper": 2025, "published": "sartore2022"}, "--published: wanted no such option with --paper 2025"),
        ({"paper": 2023, "starts": 5}, "--starts: wanted no such option with --paper 2023, found 5"),
        ({"paper": 2023, "published": "sartore2022"}, "--published: wanted no such option"),
        ({"paper": 2023, "problem": "sartore2022"}, "objectives: wanted paper2023_cost and robot_torque"),
        ({"paper": 2022, "problem": "sartore2023"}, "objectives: wanted one objective to reproduce, found 2"),
    ],
)
def test_a_reproduction_refuses_what_it_cannot_do(
    given: dict[str, object], words: str, tmp_path: Path
) -> None:
    usual = {"problem": None, "published": None, "starts": None, "evaluations": 1, "seed": 1, "minutes": 1.0}
    with pytest.raises(InputError, match=words):
        reproduce(tmp_path / "out", **{**usual, **given}, jobs=1, pool="serial", json=True)
    assert not (tmp_path / "out").exists()


def test_a_baseline_counts_how_its_starts_ended(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (folder / "problems" / "sartore2022.toml").read_text()
    text = text.replace("[baseline]\n", "[baseline]\niterations = 3\n").replace("'off'", "'on'")
    small = folder / "problems" / "small.toml"
    small.write_text(text)
    baseline(small, starts=2, seed=1, run=tmp_path / "run", jobs=1, pool="serial")
    assert "how the 2 starts ended: iteration limit 2" in capsys.readouterr().out
    baseline(small, starts=2, seed=1, run=tmp_path / "again", jobs=1, pool="serial", json=True)
    assert json.loads(capsys.readouterr().out)["statuses"] == {"iteration limit": 2}


def test_a_design_of_a_baseline_is_where_its_start_ended(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Shown with its logged design, and solved anew from its start where the log holds no postures."""
    baseline(
        folder / "problems" / "sartore2022.toml", 3, 1, tmp_path / "run", jobs=1, pool="serial", json=True
    )
    run = read_run(tmp_path / "run")
    logged = {detail.evaluation for detail in run.details}
    number = next(e.number for e in run.evaluations if e.number not in logged)
    told: list[str] = []

    class Notes(PrecomputeProgress):
        def note(self, sentence: str) -> None:
            told.append(sentence)

    opened = open_design(run, number, 1, Notes())
    norms = {h.case.task.height_m: h.robot_torque_norm for h in opened.evaluation.assessment.cases}
    for height in opened.cases:
        norm = math.hypot(*height.agents["robot"].torques_n_m.values())
        assert norm == pytest.approx(norms[height.case.task.height_m], rel=1e-9)
    problem = opened.rebuilt.problem
    arm = opened.scene_set().robot.link_by_name["l_upper_arm"].inertia.mass
    values = list(opened.evaluation.assessment.design.values())
    tree = problem.space.resized(problem.scene.robot.tree, values)
    assert arm == tree.link_by_name["l_upper_arm"].inertia.mass
    assert "solved anew" in told[0]
