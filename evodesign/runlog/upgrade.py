"""Messages of every format as records of this one.

Format 1 told a case by a height and the names of person and load, and called allocations policies:

    format 1                                           format 2
    heights: {height_m, human_name, payload_name, ..}  cases: {case: {person, payload, task}, ..}
    postures at a height: agents, disturbed            instants: {time_s: 0, agents, disturbed}
    policy.NAME                                        allocation.NAME
    [[design.policy]], [solver] seeds                  [[design.allocation]], [solver] start_portfolio

Formats 1 and 2 told wrenches by part and side:

    format 2                                           format 3
    hand_wrenches: {left: ..}, foot_wrenches: {..}     wrenches: {left_hand: .., left_foot: ..}

Headers of formats 1 and 2 may lack the method that solved: it was IPOPT then.

A message tells its format itself, a header by its number and another one by its heights, so it can be read
whatever became of its segment's header.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any, Final

import msgspec

from evodesign.runlog.channels import RECORDS, RUN

IPOPT: Final = "ipopt"
"""Who solved before runs told."""

RENAMED_KEYS: Final = {
    re.compile(r"\bseeds(?=[ \t]*=[ \t]*(true|false)\b)"): "start_portfolio",
    re.compile(
        r"^([ \t]*(?:(?:\[+[ \t]*)?design[ \t]*\.[ \t]*)?)policy(?=[ \t]*[].=])", re.MULTILINE
    ): r"\1allocation",
}
"""Keys of problem and population files, told from equal names of joints and groups by what they hold."""


def record_of(topic: str, data: bytes) -> msgspec.Struct:
    """The record that a message holds.

    Raises:
        msgspec.MsgspecError, UnicodeDecodeError: it holds none of its topic.
    """
    if topic != RUN:
        try:
            return msgspec.json.decode(data, type=RECORDS[topic])
        except msgspec.ValidationError:
            pass  # it may be of an earlier format
    return msgspec.convert(upgraded(msgspec.json.decode(data)), RECORDS[topic])


def upgraded(message: Any) -> Any:
    """A decoded message as this format has it; what needs no change stays as it is.

    A header keeps the number of its format, which tells what was read.
    """
    match message:
        case {
            "format_version": 1,
            "problem": {"files": dict(files), **source},
            "parameters": list(parameters),
        }:
            files = {name: _with_new_keys(text) for name, text in files.items()}
            text = _with_new_keys(source.get("text"))
            problem = {**source, "text": text, "files": files, "method": IPOPT}
            return {**message, "problem": problem, "parameters": [_renamed(each) for each in parameters]}
        case {"format_version": int(), "problem": {"path": _} as problem}:
            return {**message, "problem": {"method": IPOPT, **problem}}
        case {"assessment": {"heights": list(heights), "design": dict(design), **rest}}:
            values = {_name(name): value for name, value in design.items()}
            cases = [_case(each) for each in heights]
            return {**message, "assessment": {**rest, "design": values, "cases": cases}}
        case {"evaluation": number, "heights": list(heights)}:
            return {"evaluation": number, "cases": [_by_contact(_case(each)) for each in heights]}
        case {"evaluation": _, "cases": list(cases)}:
            return {**message, "cases": [_by_contact(each) for each in cases]}
    return message


def _by_contact(case: Any) -> Any:
    """The postures of a case with wrenches by contact."""
    match case:
        case {"instants": list(instants)}:
            return {**case, "instants": [_instant(each) for each in instants]}
    return case


def _instant(told: Any) -> Any:
    match told:
        case {"agents": dict(agents), **rest}:
            disturbed = {"disturbed": _each(_agents, rest.pop("disturbed"))} if "disturbed" in rest else {}
            return {**rest, "agents": _agents(agents), **disturbed}
    return told


def _agents(told: Any) -> Any:
    return _each(_agent, told)


def _each(change: Callable[[Any], Any], told: Any) -> Any:
    return {name: change(each) for name, each in told.items()} if isinstance(told, dict) else told


def _agent(told: Any) -> Any:
    match told:
        case {"hand_wrenches": dict(hands), "foot_wrenches": dict(feet), **rest}:
            by_contact = {f"{side}_foot": wrench for side, wrench in feet.items()}
            by_contact |= {f"{side}_hand": wrench for side, wrench in hands.items()}
            return {**rest, "wrenches": by_contact}
    return told


def _case(told: Any) -> Any:
    """How a case ended, or its postures."""
    match told:
        case {"height_m": height, **rest}:
            names = {"person": rest.pop("human_name", ""), "payload": rest.pop("payload_name", "")}
            case = {**names, "task": {"kind": "hold", "height_m": height}}
            return {"case": case, **({"instants": [{"time_s": 0.0, **rest}]} if "agents" in rest else rest)}
    return told


def _renamed(parameter: Any) -> Any:
    match parameter:
        case {"name": str(name)}:
            return {**parameter, "name": _name(name)}
    return parameter


def _name(parameter: str) -> str:
    return re.sub(r"^policy\.", "allocation.", parameter)


def _with_new_keys(text: Any) -> Any:
    for key, now in RENAMED_KEYS.items() if isinstance(text, str) else ():
        text = key.sub(now, text)
    return text
