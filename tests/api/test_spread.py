"""Samples of people from Python: kept, never drawn twice, gone on with after a stop."""

from __future__ import annotations

import shutil
from pathlib import Path

import msgspec
import numpy as np
import pytest

import evodesign
from evodesign.api import people
from evodesign.errors import InputError, Interrupted, RunError
from evodesign.records import Evaluation, SampledPeople
from evodesign.runlog.directory import locked
from evodesign.runlog.run import read_run
from evodesign.runlog.sampled_file import SAMPLED_FILE, read_sampled
from evodesign.runlog.writer import RunWriter
from tests.measured_people import LIFTING, SAMPLES, measured_tables


@pytest.fixture
def copied(run_with_people: Path, tmp_path: Path) -> Path:
    return shutil.copytree(run_with_people, tmp_path / "run")


def kept(directory: Path) -> SampledPeople:
    found, notes = read_sampled(read_run(directory))
    assert found is not None
    assert notes == ()
    return found


def test_the_front_of_a_search_has_met_all_people_when_it_ends(run_with_people: Path) -> None:
    run, found = evodesign.open_run(run_with_people), kept(run_with_people)
    front = {design.number for design in run.front}
    assert found.reference == 0, "the unscaled robot"
    wanted = {(sample, number) for sample in range(1, SAMPLES + 1) for number in front | {0}}
    assert {(each.sample, each.design) for each in found.designs} == wanted
    assert run.spread is not None
    assert run.spread["samples"] == SAMPLES
    for own in run.spread["designs"]:
        torques = [
            each.assessment.objectives["worst_human_torque"]
            for each in found.designs
            if each.design == own["id"]
        ]
        assert own["quantities"]["worst_human_torque"]["mean"] == pytest.approx(np.mean(torques))
        assert own["quantities"]["reach_height"]["deviation"] == pytest.approx(0.0, abs=1e-9)


def test_a_sampled_design_is_what_the_problem_with_that_person_makes_of_it(run_with_people: Path) -> None:
    run, found = evodesign.open_run(run_with_people), kept(run_with_people)
    tables = measured_tables(posture_sample=2)
    alone = evodesign.Problem.from_dict(tables, LIFTING)
    for each in (one for one in found.designs if one.sample == 2):
        design = run.design(each.design)
        assert alone.evaluate(design.parameters).assessment == each.assessment


def test_what_was_drawn_is_not_drawn_again(copied: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = (copied / SAMPLED_FILE).read_bytes()

    def fail(*arguments: object) -> None:
        raise AssertionError("something is evaluated")

    monkeypatch.setattr(people, "sampled_factory", fail)
    evodesign.resume(copied, pool="serial")
    assert (copied / SAMPLED_FILE).read_bytes() == before
    evodesign.spread(
        copied, reference=1 if kept(copied).designs[0].design != 1 else 0, designs=[], pool="serial"
    )


def test_a_larger_front_is_completed_and_another_reference_costs_nothing(copied: Path) -> None:
    front = [design.number for design in evodesign.open_run(copied).front]
    other = next(number for number in range(6) if number not in {*front, 0})
    run = evodesign.spread(copied, [other], samples=2, reference=front[0], pool="serial")
    assert run.spread is not None
    assert run.spread["reference"] == front[0]
    assert run.spread["samples"] == 2
    assert {each["id"] for each in run.spread["designs"]} == {*front, 0, other}
    again = evodesign.spread(copied, samples=SAMPLES, pool="serial").spread
    assert again is not None
    assert again["samples"] == SAMPLES, "the design that was added has all of them, too"
    assert {each["samples"] for each in again["designs"]} == {SAMPLES}


def test_a_stop_loses_nothing_and_the_rest_is_drawn_later(
    copied: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = kept(copied)
    (copied / SAMPLED_FILE).unlink()
    written: list[SampledPeople] = []
    write = people.write_sampled

    def stopped(run: object, sampled: SampledPeople) -> None:
        write(run, sampled)  # type: ignore[arg-type]
        written.append(sampled)
        if len(written) == 4:
            raise KeyboardInterrupt

    monkeypatch.setattr(people, "write_sampled", stopped)
    with pytest.raises(Interrupted, match="what had arrived is kept"):
        evodesign.spread(copied, pool="serial")
    assert len(kept(copied).designs) == 3
    monkeypatch.undo()
    evodesign.spread(copied, pool="serial")
    bare = [
        [msgspec.structs.replace(each, seconds=0.0) for each in found.designs]
        for found in (whole, kept(copied))
    ]
    assert bare[0] == bare[1]


def test_samples_leave_log_and_digest_of_a_run_as_they_are(run_with_people: Path, tmp_path: Path) -> None:
    plain = evodesign.Problem.from_dict(measured_tables(), LIFTING)
    sizes = {"algorithm": "random", "evaluations": 6, "population": 3, "seed": 2}
    other = evodesign.search(plain, tmp_path / "plain", **sizes, pool="serial")  # type: ignore[arg-type]
    assert not (tmp_path / "plain" / SAMPLED_FILE).exists()
    assert other.spread is None

    def bare(evaluations: tuple[Evaluation, ...]) -> list[Evaluation]:
        return [msgspec.structs.replace(each, seconds=0.0, worker="") for each in evaluations]

    assert bare(other.log.evaluations) == bare(read_run(run_with_people).evaluations)


def test_samples_of_other_versions_are_drawn_again(copied: Path) -> None:
    old = msgspec.structs.replace(kept(copied), versions={"evodesign": "0.0.1"})
    (copied / SAMPLED_FILE).write_bytes(msgspec.json.encode(old))
    evodesign.spread(copied, pool="serial")
    assert kept(copied).versions != old.versions


def test_what_cannot_be_drawn_is_refused_in_a_sentence(copied: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"designs of .*, which has 6, found 77"):
        evodesign.spread(copied, [77], pool="serial")
    with pytest.raises(InputError, match="how many people to draw, from 2, found 1"):
        evodesign.spread(copied, samples=1, pool="serial")
    with locked(copied), pytest.raises(RunError, match="another evodesign is writing this run"):
        evodesign.spread(copied, pool="serial")
    run = read_run(copied)
    tables = measured_tables(posture="least_torque")
    source = evodesign.Problem.from_dict(tables, LIFTING).source
    header = msgspec.structs.replace(run.header, problem=source)
    with RunWriter(tmp_path / "least", header) as log:
        for evaluation in run.evaluations:
            log.write(evaluation)
    with pytest.raises(InputError, match="found no spread in the problem"):
        evodesign.spread(tmp_path / "least", pool="serial")
    with pytest.raises(InputError, match='a person with posture = "measured"'):
        evodesign.spread(tmp_path / "least", samples=3, pool="serial")
