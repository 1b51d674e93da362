"""What stands in the page, as it is handed to its scripts: JSON in columns, units in the names.

Numbers are the log's; those of designs that can be opened have seven significant digits. A number that
does not exist is None.

Beyond 300 lines: the page's data, one record after the other, with no function.
"""

from __future__ import annotations

from typing import Any

from msgspec import Struct

from evodesign.records import (
    CaseDetail,
    CaseOutcome,
    Constraint,
    Generation,
    Objective,
    Parameter,
    Task,
    WeakestPush,
)


class Part(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Base of the page's parts."""


class Facts(Part, frozen=True):
    """The run in figures, for the page's head and foot."""

    problem: str
    directory: str
    algorithm: str
    population: int
    seed: int
    budget: int
    started: str
    versions: dict[str, str]
    git: str | None
    evaluations: int
    feasible: int
    front: int
    seconds: float
    problem_text: str


class Points(Part, frozen=True):
    """Evaluations in columns, by number; `kind` is `front`, `feasible` or `infeasible`.

    `violation` is as in `evodesign.violations`, in metres where the problem has no constraints.
    """

    number: list[int]
    kind: list[str]
    objectives: dict[str, list[float | None]]
    constraints: dict[str, list[float | None]]
    parameters: dict[str, list[float]]
    violation: list[float | None]
    lowest_m: list[float | None]
    highest_m: list[float | None]
    or_lower: list[bool]
    reason: list[str]


class Mark(Part, frozen=True):
    """A marked design; `kind` is `unscaled`, `best`, `gain`, `knee`, `asked` or `near`."""

    number: int
    kind: str
    label: str


class CauseContent(Part, frozen=True):
    """A cause of failure, how many designs failed by it, and the first one's reason."""

    cause: str
    count: int
    example: int
    reason: str


class ShapeBody(Part, frozen=True):
    """A solid or a look in its link's frame.

    Attributes:
        kind: `sphere` (size: radius), `cylinder` (radius, length along z) or `box` (x, y, z) [m].
        rotation: nine numbers, rows of link_from_shape.
        position: of the centre in the link's frame [m].
    """

    kind: str
    size: tuple[float, ...]
    rotation: tuple[float, ...]
    position: tuple[float, ...]


class SurfaceBody(Part, frozen=True):
    """Triangles that meshes of links share, in the coordinates of their file; see `tree.surface`.

    Attributes:
        low: least coordinates of the vertices.
        step: what one of `points` stands for, along each axis.
        points: x, y, z of each vertex in steps, as base64 of 16-bit numbers.
        triangles: three vertices each, likewise.
    """

    low: tuple[float, ...]
    step: tuple[float, ...]
    points: str
    triangles: str


class MeshBody(Part, frozen=True):
    """A surface in a link's frame.

    Attributes:
        surface: its index among all.
        linear: nine numbers, rows of the map from the surface's coordinates: scale, rotation and stretch.
        position: of the surface's origin in the link's frame [m].
    """

    surface: int
    linear: tuple[float, ...]
    position: tuple[float, ...]


class LinkBody(Part, frozen=True, omit_defaults=True):
    """A link's mass [kg], and the shapes or meshes that show it."""

    name: str
    mass_kg: float
    shapes: tuple[ShapeBody, ...]
    meshes: tuple[MeshBody, ...] = ()


class JointBody(Part, frozen=True):
    """A joint; links by their index in the tree, parents before children.

    Attributes:
        kind: `fixed`, `revolute`, `continuous` or `prismatic`.
        rotation: nine numbers, rows of parent_from_child at joint position zero.
        position: of the child's origin in the parent's frame [m].
        axis: unit vector in the child's frame.
    """

    name: str
    kind: str
    parent: int
    child: int
    rotation: tuple[float, ...]
    position: tuple[float, ...]
    axis: tuple[float, ...]


class TreeBody(Part, frozen=True):
    """An agent: its tree, and the links that are its soles, by side; their length and width."""

    links: tuple[LinkBody, ...]
    joints: tuple[JointBody, ...]
    soles: dict[str, int]
    sole_size_m: tuple[float, float]


class LoadBody(Part, frozen=True):
    """A load; its size is depth (robot to person), width, height.

    `hand_moment_n_m` bounds each component of the moment that a hand passes; None where nothing does.
    """

    size_m: tuple[float, ...]
    mass_kg: float
    hand_moment_n_m: float | None = None


class AgentContent(Part, frozen=True):
    """Who holds the load: `robot` or `person`, in a frame turned about z by quarters against the world's.

    Attributes:
        designed: whether designs change it.
    """

    name: str
    role: str
    quarters: int
    designed: bool


class Bodies(Part, frozen=True):
    """Everybody who holds a load, and the loads, and which robot links some parameter changes.

    Attributes:
        robot: that designs change.
        agents: of every case, in the order of the log.
        others: who is beside it by agent, by the name of the people of a case, empty where there is one.
        payloads: by their names.
        changing: indices of robot links.
        surfaces: of all meshes, whatever the design.
    """

    robot: TreeBody
    agents: tuple[AgentContent, ...]
    others: dict[str, dict[str, TreeBody]]
    payloads: dict[str, LoadBody]
    changing: tuple[int, ...]
    surfaces: tuple[SurfaceBody, ...] = ()


class ClearanceContent(Part, frozen=True):
    """The two bodies that are nearest in a posture; the distance is negative where they overlap."""

    first: str
    second: str
    distance_m: float


class EffortContent(Part, frozen=True):
    """What a posture does to the person; null where the person has no such joint, strength or link.

    Attributes:
        back_n, shear_n: of the disc L5/S1 [N].
        back_limit_n: NIOSH's limit of the first [N].
        load_n_m: norm of the torques that the load adds to those with empty hands [N m].
        seconds: how long it can be held, and whether `longer` than what was measured.
        tires: the joint that tires first.
        rula, reba: scores.
    """

    back_n: int | None
    shear_n: int | None
    back_limit_n: int
    load_n_m: float
    seconds: int | None
    longer: bool
    tires: str
    rula: int | None
    reba: int | None


class ActuatorContent(Part, frozen=True):
    """What drives a group of joints; `model` is empty for one of the law.

    Attributes:
        count: of joints.
        mass_kg, price_eur: of one.
        joint: of the group, that is used most.
        asked_n_m, asked_by, share: of it, as in `evaluation.bill`.
        loss_w: of all together, each at its most.
        winding_c, winding_limit_c: of the warmest in the problem's duty, where there is one [deg C].
    """

    name: str
    model: str
    count: int
    rated_torque_n_m: float
    peak_torque_n_m: float
    mass_kg: float
    price_eur: float | None
    joint: str
    asked_n_m: float
    asked_by: str
    share: float
    loss_w: float
    winding_c: float | None = None
    winding_limit_c: float | None = None


class WallContent(Part, frozen=True):
    """What a hollow link is made of, as in `evaluation.bill`; no safety factor of one that is no beam."""

    link: str
    material: str | None
    wall_m: float
    mass_kg: float
    safety_factor: float | None
    safety_mode: str | None
    safety_case: str | None


class HardwareContent(Part, frozen=True):
    """The bill of materials; masses of `actuators`, `structure`, `rest` and in `total`.

    `governs` are sentences on walls and actuators. `least_clearance` names two parts and tells by how much
    they go together, negative where they do not.
    """

    actuators: tuple[ActuatorContent, ...]
    walls: tuple[WallContent, ...]
    mass_kg: dict[str, float]
    governs: tuple[str, ...]
    least_clearance: dict[str, Any] | None = None


class DesignContent(Part, frozen=True):
    """A design that can be opened.

    Attributes:
        cases: how each ended, without the disturbances, which the page never shows one by one.
        people: mean and standard deviation over the problem's people, by quantity.
        weakest: where push margins are least, by quantity.
        postures: one per solved case; empty when the log or the page's limit leaves them out.
        clearances: as many as postures; none where a posture is of a stranger to the run's problem.
        efforts: of the person, likewise.
        static_torques: those of lifts if nothing moved, by moment, agent and joint [N m]; likewise, none
            where no load is lifted.
        torque_limits: of the robot's joints that have a limit [N m].
        links, joints: those that differ from the unscaled robot's, by index.
        gradients: of each objective by parameter; empty when the log has none.
        hardware: bill of materials; None where the problem has no hardware, or postures are left out.
        slices: through a marked design, as in `analysis.importance_json`.
        urdf: of the robot: lines that differ from the unscaled one's by their place, each as its texts and
            numbers in turn, or the whole text where it has another number of lines.
        replay: MCAP file of a marked design, as base64; empty when it is left out.
    """

    cases: tuple[CaseOutcome, ...]
    people: dict[str, tuple[float, float]] = {}
    weakest: dict[str, WeakestPush] = {}
    postures: tuple[CaseDetail, ...] = ()
    clearances: tuple[ClearanceContent, ...] = ()
    efforts: tuple[EffortContent, ...] = ()
    static_torques: tuple[tuple[dict[str, dict[str, float]], ...], ...] = ()
    torque_limits: dict[str, float] = {}
    links: dict[int, LinkBody] = {}
    joints: dict[int, JointBody] = {}
    gradients: dict[str, dict[str, float]] = {}
    hardware: HardwareContent | None = None
    slices: list[dict[str, Any]] = []
    urdf: dict[int, tuple[str | float, ...]] | str = {}
    replay: str = ""


class StopContent(Part, frozen=True):
    """What the page's slider stops at: a load held still, or a moment of a lift.

    Attributes:
        task: that it belongs to.
        moment: which of the task's postures in the page.
        height_m: of the load; in a lift where it begins, for postures tell the rest.
        time_s: since the task began.
        text: what it is called.
        name: of the task.
    """

    task: Task
    moment: int
    height_m: float
    time_s: float
    text: str
    name: str


class Content(Part, frozen=True):
    """The whole page; people and loads have an empty name where there is one of them.

    `urdf` is the unscaled robot's, empty where it is not known. `words` say what joints and links are called.

    `importance` is as in `analysis.importance_json`, `families` as `analysis.families` tells
    them, `growth` a sentence or empty. `spread` is that over samples of people, as `analysis.people_spread`
    has it; None where none were drawn.
    """

    facts: Facts
    objectives: tuple[Objective, ...]
    constraints: tuple[Constraint, ...]
    parameters: tuple[Parameter, ...]
    people: tuple[str, ...]
    payloads: tuple[str, ...]
    heights_m: tuple[float, ...]
    stops: tuple[StopContent, ...]
    points: Points
    marks: tuple[Mark, ...]
    generations: tuple[Generation, ...]
    growth: str
    failures: tuple[CauseContent, ...]
    importance: dict[str, Any]
    families: dict[str, Any]
    bodies: Bodies | None
    words: dict[str, str]
    urdf: str
    designs: dict[int, DesignContent]
    notes: tuple[str, ...]
    spread: dict[str, Any] | None = None
