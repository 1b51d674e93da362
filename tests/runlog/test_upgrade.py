"""Messages of format 1 as records of this format; golden runs see to whole logs."""

from __future__ import annotations

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.records import Case, Evaluation, Hold, RunHeader
from evodesign.runlog.channels import DETAIL, EVALUATION, RUN
from evodesign.runlog.upgrade import record_of, upgraded
from tests.runlog.toys import toy_detail, toy_evaluations, toy_header

HEADER = toy_header()
EVALUATIONS = toy_evaluations(HEADER, 8)

JSON = st.recursive(
    st.none() | st.booleans() | st.floats(allow_nan=False) | st.text(max_size=4),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(("heights", "assessment", "design", "evaluation", "height_m", "problem", "x")),
            inner,
        )
    ),
    max_leaves=8,
)


def header_of(text: str, population: str) -> RunHeader:
    problem = {"path": "p.toml", "text": text, "files": {"start.toml": population}, "symmetry": None}
    old = msgspec.to_builtins(HEADER) | {"format_version": 1, "problem": problem}
    old["parameters"] = [{"name": "policy.robot_share", "lower": 0.0, "upper": 1.0, "unit": "1"}]
    found = record_of(RUN, msgspec.json.encode(old))
    assert isinstance(found, RunHeader)
    return found


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("[[design.policy]]\nname = 'x'", "[[design.allocation]]\nname = 'x'"),
        ("[[ design . policy ]]", "[[ design . allocation ]]"),
        ("[solver]\n  seeds = false", "[solver]\n  start_portfolio = false"),
        (
            "solver = { compile = false, seeds = true }",
            "solver = { compile = false, start_portfolio = true }",
        ),
        ("solver.seeds=true", "solver.start_portfolio=true"),
        ("[[design]]\npolicy = { robot_share = 0.5 }", "[[design]]\nallocation = { robot_share = 0.5 }"),
        ("[design.policy]\nrobot_share = 0.5", "[design.allocation]\nrobot_share = 0.5"),
        ("policy.robot_share = 0.5", "allocation.robot_share = 0.5"),
        ("start = 'policy.toml'  # seeds = 3", "start = 'policy.toml'  # seeds = 3"),
        ("[robot.torque_limits_n_m]\nseeds = 5.0", "[robot.torque_limits_n_m]\nseeds = 5.0"),
    ],
)
def test_keys_of_problem_and_population_files_are_told_anew(before: str, after: str) -> None:
    header = header_of(before, before)
    assert (header.problem.text, header.problem.files["start.toml"]) == (after, after)
    assert [parameter.name for parameter in header.parameters] == ["allocation.robot_share"]


def test_heights_become_cases_and_instants() -> None:
    outcome = {"height_m": 0.8, "status": "solved", "reason": "", "iterations": 3, "residual": 0.0}
    norms = {"robot_torque_norm": 1.0, "human_torque_norm": 2.0}
    old = msgspec.to_builtins(EVALUATIONS[0])
    del old["assessment"]["cases"]
    old["assessment"] |= {
        "heights": [outcome | norms | {"human_name": "tall", "disturbed": {"push": {"robot": 3.0}}}],
        "design": {"policy.robot_share": 0.5, "length.policy": 1.0},
    }
    found = record_of(EVALUATION, msgspec.json.encode(old))
    assert isinstance(found, Evaluation)
    (one,) = found.assessment.cases
    assert one.case == Case(person="tall", task=Hold(height_m=0.8))
    assert one.disturbed == {"push": {"robot": 3.0}}
    assert found.assessment.design == {"allocation.robot_share": 0.5, "length.policy": 1.0}

    now = toy_detail(EVALUATIONS[0])
    agents = msgspec.to_builtins(now.cases[0].agents)
    detail = record_of(
        DETAIL, msgspec.json.encode({"evaluation": 0, "heights": [{"height_m": 1.0, "agents": agents}]})
    )
    assert detail == now


@pytest.mark.parametrize("evaluation", EVALUATIONS)
def test_a_message_of_this_format_stays_as_it_is(evaluation: Evaluation) -> None:
    for topic, record in ((EVALUATION, evaluation), (DETAIL, toy_detail(evaluation)), (RUN, HEADER)):
        assert record_of(topic, msgspec.json.encode(record)) == record
        assert upgraded(msgspec.to_builtins(record)) == msgspec.to_builtins(record)


@given(message=JSON)
def test_what_is_no_message_is_refused_as_such_and_never_otherwise(message: object) -> None:
    for topic in (RUN, EVALUATION, DETAIL):
        with pytest.raises(msgspec.ValidationError):
            record_of(topic, msgspec.json.encode(message))
