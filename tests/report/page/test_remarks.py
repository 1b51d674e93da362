"""Where a reader should look: each remark of the card stands where the log gives cause for it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import msgspec
import pytest

from evodesign.records import CaseDetail
from evodesign.report.page import page_content, page_html
from evodesign.report.page.content import ActuatorContent, ClearanceContent, Content, HardwareContent
from evodesign.runlog.run import RunLog
from evodesign.tree.words import in_words
from tests.report.page.chromium import Tab
from tests.report.page.reading import open_page
from tests.report.page.test_limits import shown_case

pytestmark = [pytest.mark.needs_chromium, pytest.mark.slow]

REMARKS = """JSON.stringify([...document.querySelectorAll('[data-remark]')].map(one =>
    [one.dataset.remark, one.textContent]))"""


def remarks(tab: Tab) -> list[tuple[str, str]]:
    return [(kind, text) for kind, text in json.loads(tab.value(REMARKS))]


def test_limits_and_joints_that_carry_nothing_are_those_of_the_posture(page: Tab, real_run: RunLog) -> None:
    found = remarks(page)
    number = page.value("window.evodesign.state.selected")
    (logged,) = (each for each in real_run.details if each.evaluation == number)
    height = shown_case(page)["case"]["task"]["height_m"]
    (case,) = (each for each in logged.cases if each.height_m == height)
    (limit,) = (text for kind, text in found if kind == "limits")
    dearest = max(case.limits, key=lambda each: abs(each.change_n_m))
    assert limit.startswith(f"{len(case.limits)} limit")
    assert f"saves {abs(dearest.change_n_m):.2g} N m of effort" in limit
    idle = [text for kind, text in found if kind == "idle"]
    for agent, who in (("robot", "Robot"), ("human", "Person")):
        torques = case.agents[agent].torques_n_m
        most = max(map(abs, torques.values()))
        nothing = [joint for joint, torque in torques.items() if abs(torque) <= 1e-3 * most]
        told = [text for text in idle if text.startswith(who)]
        assert len(told) == bool(nothing)
        for text in told:
            assert f"{len(nothing)} of {len(torques)}" in text
            assert in_words(nothing[0]) in text
    assert not {"hand", "fallback", "temperature", "parts", "actuator"} & {kind for kind, _ in found}


def twisted(case: CaseDetail) -> CaseDetail:
    """A case in which the robot's hands pass a moment."""
    (instant,) = case.instants
    robot = instant.agents["robot"]
    wrenches = robot.wrenches | {"left_hand": (0.0, 0.0, -50.0, 1.0, -4.9, 0.0)}
    agents = instant.agents | {"robot": msgspec.structs.replace(robot, wrenches=wrenches)}
    return msgspec.structs.replace(case, instants=(msgspec.structs.replace(instant, agents=agents),))


def changed(content: Content) -> Content:
    """A content whose first posture gives cause for every remark."""
    actuator: dict[str, Any] = dict.fromkeys(ActuatorContent.__struct_fields__, 1.0) | {
        "name": "knee",
        "model": "",
        "count": 2,
        "joint": "l_knee",
        "asked_by": "",
        "price_eur": None,
        "share": 1.2,
        "winding_c": 118.0,
        "winding_limit_c": 120.0,
    }
    hardware = HardwareContent(
        actuators=(ActuatorContent(**actuator),),
        walls=(),
        governs=(),
        mass_kg={"actuators": 1.0, "structure": 0.0, "rest": 1.0, "total": 2.0},
        least_clearance={"parts": ["l_hip_1", "l_hip_2"], "clearance_m": -0.002},
    )
    designs = {}
    for number, design in content.designs.items():
        if design.postures:
            back = [msgspec.structs.replace(one, back_n=3600) for one in design.efforts]
            near = [ClearanceContent(first="robot l_hand", second="load", distance_m=1e-3)] * len(back)
            cases = [msgspec.structs.replace(one, fallbacks=3) for one in design.cases]
            design = msgspec.structs.replace(
                design,
                postures=tuple(map(twisted, design.postures)),
                hardware=hardware,
                efforts=(*back,),
                clearances=(*near,),
                cases=(*cases,),
            )
        designs[number] = design
    assert content.bodies is not None
    hands = {
        name: msgspec.structs.replace(load, hand_moment_n_m=5.0)
        for name, load in content.bodies.payloads.items()
    }
    return msgspec.structs.replace(
        content, designs=designs, bodies=msgspec.structs.replace(content.bodies, payloads=hands)
    )


def test_whatever_gives_cause_for_a_remark_has_one(chromium: Tab, real_run: RunLog, tmp_path: Path) -> None:
    path = tmp_path / "report.html"
    path.write_text(page_html(changed(page_content(real_run))), encoding="utf-8")
    chromium.events.clear()
    open_page(chromium, path)
    told = dict(remarks(chromium))
    assert told["parts"] == "Parts do not fit: l_hip_1 and l_hip_2 lack 2 mm."
    assert told["actuator"] == "Actuators of knee are used at 120 %."
    assert told["temperature"] == "Windings of knee reach 118 \u00b0C of at most 120 \u00b0C."
    assert told["fallback"].endswith("IPOPT solved 3 times instead.")
    assert told["bodies"] == "Nearest bodies: robot l_hand and load, 1 mm apart."
    assert told["back"].startswith("Back: L5/S1 is compressed by 3.6 kN")
    assert told["hand"] == "Robot: moment on a hand 4.9 N m of at most 5 N m."
    assert chromium.complaints() == []
