"""What `check` finds wrong with robots that can be read: one sentence each, with key and remedy."""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Callable
from dataclasses import replace

import pytest

from evodesign.body.placement import Placement
from evodesign.errors import InputError
from evodesign.guess.preflight import preflight
from evodesign.guess.problem_text import guessed_problem
from evodesign.hardware.catalogue import catalogue
from evodesign.problem.build import DesignProblem, build_problem
from evodesign.records import ProblemSource
from evodesign.tree.frames import parent_from_child
from evodesign.tree.model import Joint, JointKind, Link, Tree
from evodesign.tree.urdf_write import urdf_text
from tests.guess.humanoid import Build, humanoid

Change = Callable[[str], str]
PATH = "mine.toml"
SOLVER = '\n[solver]\nsymmetry = "off"\n'


@functools.cache
def guessed_text() -> str:
    """What `init` would write for a humanoid, but for `[collisions]`, which only the last item mentions."""
    text = guessed_problem(humanoid(Build()), "robot.urdf").text
    (table,) = re.findall(r"(?m)^\[collisions\].*\n", text)
    return text.replace(table, "")


def problem_of(tree: Tree, change: Change = lambda text: text) -> DesignProblem:
    """The problem that `init` would write for a humanoid, with something changed in its text."""
    source = ProblemSource(
        path=PATH, text=change(guessed_text()) + SOLVER, files={"robot.urdf": urdf_text(tree)}
    )
    return build_problem(source)


@pytest.fixture
def people_untried(monkeypatch: pytest.MonkeyPatch) -> None:
    """For time: what people reach takes most of what `check` takes."""
    monkeypatch.setattr("evodesign.guess.preflight.people_hold", lambda _: "not tried, for time")


@pytest.fixture
def nothing_held(monkeypatch: pytest.MonkeyPatch, people_untried: None) -> None:
    """Nor is anything else solved."""
    monkeypatch.setattr("evodesign.guess.preflight.holds", lambda _: "not tried, for time")


def faults(problem: DesignProblem) -> list[str]:
    return [finding.fault for finding in preflight(problem) if finding.fault]


def with_joint(tree: Tree, name: str, change: Callable[[Joint], Joint]) -> Tree:
    return replace(tree, joints=tuple(change(each) if name in each.name else each for each in tree.joints))


def with_limits(tree: Tree, **limits: tuple[float, float]) -> Tree:
    """The tree whose joints of these names have these limits."""
    for name, (lower, upper) in limits.items():
        tree = with_joint(tree, name, functools.partial(replace, lower=lower, upper=upper))
    return tree


def exchanged(key: str, name: str) -> Change:
    left, right = (f'{side} = "{side}_{name}"' for side in ("left", "right"))
    return put(f"{key} = {{ {left}, {right}", f'{key} = {{ left = "right_{name}", right = "left_{name}"')


def put(old: str, new: str) -> Change:
    def change(text: str) -> str:
        assert old in text
        return text.replace(old, new, 1)

    return change


@pytest.mark.slow
def test_a_guessed_problem_passes_and_says_what_was_found() -> None:
    apart = problem_of(humanoid(Build()), put("[objectives]", "[collisions]\n\n[objectives]"))
    found = {finding.item: finding for finding in preflight(apart)}
    assert [*found] == [
        "stands on its soles",
        "faces the load",
        "has hands",
        "masses and limits",
        "has shapes",
        *(f"length.{name} + 10%" for name in ("upper_arm", "forearm", "thigh", "shank", "trunk")),
        "can be searched",
        "holds the load",
        "people reach it",
    ]
    assert not any(finding.fault for finding in found.values())
    assert found["length.thigh + 10%"].found.startswith("soles by 38 mm, +")
    assert found["length.trunk + 10%"].found.startswith("hands by 40 mm, +"), "the box is 0.4 m high"
    assert re.fullmatch(
        r"from 0\.\d\d to 1\.\d\d m; a posture at 1\.05 m is solved, \[collisions\] aside",
        found["holds the load"].found,
    )


@pytest.mark.usefixtures("nothing_held")
def test_a_parameter_that_chooses_among_models_changes_the_mass_by_that_of_the_next_one() -> None:
    """The unscaled robot has the stronger one."""
    knees, models = '["left_knee", "right_knee"]', '["X6-60", "X8-120"]'
    table = f'[[design.actuator]]\nname = "knees"\njoints = {knees}\nmodels = {models}\n'
    problem = problem_of(humanoid(Build()), lambda text: f"{text}\n{table}")
    found = {finding.item: finding.found for finding in preflight(problem) if "actuator" in finding.item}
    less = 2.0 * (catalogue()["X6-60"].mass_kg - catalogue()["X8-120"].mass_kg)
    assert found == {"actuator.knees X8-120 to X6-60": f"{less:+.2g} kg"}


@pytest.mark.usefixtures("people_untried")
def test_a_joint_that_carries_nothing_may_be_a_parameter() -> None:
    """Links without a mass are left out where nothing names them, and here a parameter does."""
    tree = humanoid(Build())
    antenna = replace(tree.joint_by_name["left_elbow"], name="antenna", parent="chest", child="antenna")
    tree = replace(tree, links=(*tree.links, Link("antenna")), joints=(*tree.joints, antenna))
    bounds = "offset_m = [-0.1, 0.1]\nalong = [0, 0, 1]"
    table = f'[[design.joint]]\nname = "antenna"\njoints = ["antenna"]\n{bounds}\n'
    assert not faults(problem_of(tree, lambda text: f"{text}\n{table}"))


def at_heights(heights: str) -> DesignProblem:
    return problem_of(
        humanoid(Build()), lambda text: re.sub(r"heights_m = .*", f"heights_m = {heights}", text)
    )


def test_heights_out_of_reach_are_named_beside_those_within() -> None:
    *_, held, people = preflight(at_heights("[1.05, 1.7]"))
    assert not held.fault
    assert " at 1.05 m is solved" in held.found
    assert held.found.endswith("; out of reach unless a design reaches farther: 1.7 m")
    assert re.fullmatch(r"from 0\.0\d to 1\.7\d m", people.found)


def test_heights_that_no_length_and_no_person_reaches_are_refused() -> None:
    robot, person = faults(at_heights("[1.05, 4.0]"))
    key = r"task\.heights_m\[1\]: wanted heights that"
    who = "the robot reaches as it is or with lengths at bounds"
    assert re.fullmatch(rf"{key} {who}, from 0\.\d\d to \d\.\d\d m, found 4", robot)
    assert re.fullmatch(rf"{key} female P5 reaches, from 0\.0\d to 1\.7\d m, found 4", person)


@pytest.mark.usefixtures("people_untried")
def test_a_robot_without_shapes_passes_and_is_told_what_is_left_out() -> None:
    tree = humanoid(Build())
    bare = replace(tree, links=tuple(Link(each.name, own_inertia=each.inertia) for each in tree.links))
    found = {finding.item: finding for finding in preflight(problem_of(bare))}
    assert not any(finding.fault for finding in found.values())
    assert (
        found["has shapes"].found == "0 of 26 links with a mass: collisions and pictures leave the robot out"
    )


@pytest.mark.usefixtures("nothing_held")
def test_a_robot_without_limits_of_joints_is_told_of_them_and_keeps_no_knees_bent() -> None:
    """As in MJCF files that leave ranges to the controller: nothing says to which side a knee bends."""
    joints = [replace(each, lower=-math.inf, upper=math.inf) for each in humanoid(Build()).joints]
    kinds = {JointKind.REVOLUTE: JointKind.CONTINUOUS}
    endless = replace(
        humanoid(Build()),
        joints=tuple(replace(each, kind=kinds.get(each.kind, each.kind)) for each in joints),
    )
    text = guessed_problem(endless, "robot.urdf").text
    assert "# no knee_flexion_deg: knees without limits may bend to either side" in text
    files = {"robot.urdf": urdf_text(endless)}
    problem = build_problem(ProblemSource(path=PATH, text=text + SOLVER, files=files))
    found = {finding.item: finding.found for finding in preflight(problem)}
    assert ", 19 joints that move, 19 of them without limits: " in found["masses and limits"]
    asked = put("# no knee", "knee_flexion_deg = 15\n# no knee")(text)
    with pytest.raises(
        InputError, match=r"knee_flexion_deg: wanted limits of 'left_knee', which say to which"
    ):
        build_problem(ProblemSource(path=PATH, text=asked + SOLVER, files=files))


@pytest.mark.usefixtures("nothing_held")
@pytest.mark.parametrize("yaw", [math.pi / 2.0, math.pi, -math.pi / 2.0])
def test_a_robot_that_looks_elsewhere_is_told_what_to_write(yaw: float) -> None:
    wrong = faults(problem_of(humanoid(Build(yaw))))
    remedy = {1: "+y", 2: "-x", 3: "-y"}[round(yaw / (math.pi / 2.0)) % 4]
    (sentence,) = [fault for fault in wrong if "robot.facing" in fault]
    assert sentence.startswith(
        f'robot.facing: wanted "{remedy}", found a robot that looks along {remedy}: knees'
    )
    turned = problem_of(humanoid(Build(yaw)), put("[robot]", f'[robot]\nfacing = "{remedy}"'))
    assert not [fault for fault in faults(turned) if "robot.facing" in fault]
    over = problem_of(humanoid(Build()), put("[robot]", f'[robot]\nfacing = "{remedy}"'))
    assert any('robot.facing: wanted "+x", found' in fault for fault in faults(over))


LYING = Placement.from_xyz_rpy((0.0, 0.0, 0.0), (0.0, math.pi / 2.0, 0.0))


@pytest.mark.usefixtures("people_untried")
@pytest.mark.parametrize(
    ("tree", "change", "sentence"),
    [
        (
            humanoid(Build()),
            put('right = "right_sole"', 'right = "left_sole"'),
            r"robot\.soles: wanted frames under two feet .*, found two of 'left_foot'",
        ),
        (
            with_joint(humanoid(Build()), "turn", lambda joint: replace(joint, parent_from_child=LYING)),
            lambda text: text,
            r"robot\.soles: wanted a robot upright on its soles .*, found its centre of mass \d+ degrees off",
        ),
        (
            humanoid(Build()),
            put('soles = { left = "left_sole"', 'soles = { left = "left_palm"'),
            r"robot\.soles: wanted soles at one height .*, found one 0\.\d\d m above the other",
        ),
        (
            with_limits(humanoid(Build()), right_knee=(-2.4, 0.05)),
            lambda text: text,
            r"robot\.urdf: wanted knees that bend to one side, found 'left_knee' and 'right_knee'",
        ),
        (
            humanoid(Build()),
            exchanged("soles", "sole"),
            r"robot\.soles: wanted the left one to the left .*, found them exchanged",
        ),
        (
            humanoid(Build()),
            exchanged("hands", "palm"),
            r"robot\.hands: wanted the left one to the left .*, found them exchanged",
        ),
        (
            humanoid(Build()),
            put('right = "right_palm"', 'right = "left_palm"'),
            r"robot\.hands: wanted frames in two hands .*, found two of 'left_hand'",
        ),
        (
            humanoid(Build()),
            put('left = "left_palm"', 'left = "chest"'),
            r"robot\.hands\.left: wanted a hand with at least 3 of robot\.joints .*, found 0 before 'chest'",
        ),
        (
            with_limits(humanoid(Build()), wrist=(0.1, 0.1)),
            lambda text: text,
            r"robot\.joints: wanted joints that can move; .*, found 'left_wrist', whose limits are both 0\.1",
        ),
        (
            with_limits(
                humanoid(Build()), shoulder_pitch=(1.2, 1.6), shoulder_roll=(-0.1, 0.1), waist=(-0.1, 0.1)
            ),
            lambda text: text,
            r"robot\.hands: wanted hands that can hold the load in front of the robot .*, found none",
        ),
        (
            humanoid(Build()),
            put('algorithm = "surrogate"', 'algorithm = "surogate"'),
            r"search: algorithm: wanted one of .*, found 'surogate'; did you mean 'surrogate'\?",
        ),
        (
            humanoid(Build()),
            lambda text: re.sub(r"heights_m = .*", "heights_m = [2.5, 3.0]", text),
            r"task\.heights_m: wanted a height that the robot reaches, from .* m, found 2\.5, 3",
        ),
    ],
    ids=[
        "soles that are one link",
        "lying down",
        "a sole on a hand",
        "a knee that bends back",
        "soles exchanged",
        "hands exchanged",
        "hands that are one link",
        "a hand on the chest",
        "a joint without a range",
        "hands behind the back",
        "a misspelt algorithm",
        "heights out of reach",
    ],
)
def test_what_cannot_be_is_one_sentence_with_key_and_remedy(
    tree: Tree, change: Change, sentence: str
) -> None:
    first, *_ = faults(problem_of(tree, change))
    assert re.match(sentence, first), first


@pytest.mark.usefixtures("people_untried")
@pytest.mark.slow
def test_a_joint_whose_zero_lies_far_outside_of_its_range_holds_what_it_held() -> None:
    """An encoder's offset of 4 rad: lower and upper limits of the elbows beyond half a turn."""

    def offset(joint: Joint) -> Joint:
        place = parent_from_child(joint, -OFFSET)
        return replace(joint, parent_from_child=place, lower=joint.lower + OFFSET, upper=joint.upper + OFFSET)

    told, plain = [], humanoid(Build())
    moved = with_joint(plain, "elbow", offset)
    assert sum(joint not in plain.joints for joint in moved.joints) == 2
    for tree in (plain, moved):
        found = {finding.item: finding.found for finding in preflight(problem_of(tree))}
        told.append(found["holds the load"])
    assert told[0] == told[1]


OFFSET = 4.0
