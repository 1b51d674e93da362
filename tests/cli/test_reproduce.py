"""`reproduce` and `baseline` from the command line, on problems small enough for a test."""

from __future__ import annotations

import json
import math
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from evodesign.cli.baseline import baseline
from evodesign.cli.reproduce import reproduce
from evodesign.errors import InputError
from evodesign.problem.progress import PrecomputeProgress
from evodesign.report.opened_design import open_design
from evodesign.runlog.run import read_run

pytestmark = pytest.mark.slow

QUICK = "\n[solver]\nsymmetry = 'off'\nstart_portfolio = false\ncompile = false\n"
"""Nothing is worked out beforehand; solves take longer, of which there are few."""


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
    effort = {"starts": 1, "evaluations": 2, "seed": 1, "minutes": 10.0, "jobs": 1, "pool": "serial"}
    reproduce(to, limited, published, **effort, json=True)
    shown = json.loads(capsys.readouterr().out)
    verdicts = {(claim["subject"], claim["by"]): claim["reproduced"] for claim in shown["claims"]}
    assert len(verdicts) == 7
    assert verdicts["Table II", "published setting"] is False
    assert shown["published"]["torque_difference"] < 1e-5
    assert "joint limits" in shown["published"]["broken_limits"]
    assert [row["height_m"] for row in shown["torque_norms"]["original"]["with limits"]] == [1.0]
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
        reproduce(to, limited, limited, **effort, json=True)


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
