"""`[payload]`, `[task]` and what else says how the load is held."""

from __future__ import annotations

from typing import Annotated

import msgspec
from msgspec import Meta

from evodesign.mechanics.disturbance import OverCases, PushedAt
from evodesign.mechanics.payload import Grasp, GraspDirection
from evodesign.problem.table import Name, NotNegative, Point, Positive, Share, Table
from evodesign.tasks.lift import FEWEST_KNOTS, LoadProfile


class GraspsTable(Table, frozen=True):
    """`robot_grasps_m`, `human_grasps_m`: grasp points from the box's centre, in the world's axes.

    Attributes:
        left: grasp point of the left hand, in m; left out where there is none.
        right: grasp point of the right hand, in m; likewise.
    """

    left: Point | None = None
    right: Point | None = None


class PayloadTable(Table, frozen=True):
    """`[payload]` or `[[payload]]`: a box; of several loads, each person holds each at each height.

    Attributes:
        size_m: depth (from robot to person), width and height.
        mass_kg: mass.
        name: name in results; without it, the mass.
        center_of_mass_m: centre of mass from the box's centre, inside the box.
        grasp: what a hand transmits: `point` a force, `rigid` a force and a moment.
        hand_moment_n_m: largest moment of a rigid hand about each axis; `inf` for no bound; without it,
            7.0, what wrists bear (Delp, Grierson and Buchanan 1996).
        grasp_direction: where forearms come from: `side` from outside and behind, `under` from below and
            behind.
        grasp_cone_deg: largest angle of a forearm from `grasp_direction`; without it, 60.
        robot_grasps_m: grasp points of the robot; without it, at 0.4 of the edge from its middle, 0.25
            beside a neighbour, in the middle for one hand.
        human_grasps_m: the same of the person.
    """

    size_m: tuple[Positive, Positive, Positive]
    mass_kg: Positive
    name: Name | None = None
    center_of_mass_m: Point = (0.0, 0.0, 0.0)
    grasp: Grasp = Grasp.POINT
    hand_moment_n_m: NotNegative | None = None
    grasp_direction: GraspDirection = GraspDirection.FREE
    grasp_cone_deg: Annotated[float, Meta(gt=0.0, lt=180.0)] | None = None
    robot_grasps_m: GraspsTable | None = None
    human_grasps_m: GraspsTable | None = None


class WeightsTable(Table, frozen=True):
    """`effort_weights`: weights of the squared joint torques in the posture problem.

    Attributes:
        robot: weight of the robot's torques.
        human: weight of the person's torques.
    """

    robot: NotNegative = 1.0
    human: NotNegative = 1.0


class LiftTable(Table, frozen=True):
    """`[[task.lift]]`: the load moves straight up or down, from rest to rest.

    Docs: motion.md.

    Attributes:
        from_m: height of the load's centre at the start. Since 0.3.
        to_m: height at the end. Since 0.3.
        seconds: duration. Since 0.3.
        profile: height over time: `minimum_jerk`, or `free` for the optimiser's choice. Since 0.3.
        knots: knots of the splines. Since 0.3.
    """

    from_m: Positive
    to_m: Positive
    seconds: Positive = 1.5
    profile: LoadProfile = LoadProfile.MINIMUM_JERK
    knots: Annotated[int, Meta(ge=FEWEST_KNOTS)] = 12


class TaskTable(Table, frozen=True):
    """`[task]`: heights at which the load is held, lifts, and how robot and person share the effort.

    Attributes:
        heights_m: heights of the load's centre; a design that misses one is infeasible by the missing
            distance.
        lift: lifts, besides or in place of `heights_m`. Since 0.3.
        effort_weights: weights of squared torques in the posture problem; without it, 1 and 1.
        robot_share: share of the load's weight that the robot carries, with rigid grasps; without it, the
            posture problem decides.
        disturbed_effort: effort over the undisturbed and all disturbed load cases: their `mean` or the
            `worst`.
    """

    heights_m: Annotated[tuple[Positive, ...], Meta(min_length=1)] | msgspec.UnsetType = msgspec.UNSET
    lift: tuple[LiftTable, ...] = ()
    effort_weights: WeightsTable | None = None
    robot_share: Share | None = None
    disturbed_effort: OverCases = OverCases.WORST


class DisturbanceTable(Table, frozen=True):
    """`[[disturbance]]`: a further load case of each posture, with its own torques and wrenches.

    Docs: disturbances.md.

    Attributes:
        name: name in results; without it, numbered.
        load_mass_share: added mass, as a share of the load's.
        center_of_mass_m: shift of the load's centre of mass.
        push_n: force in the world's axes: x from the robot to the person, z up.
        at: where it acts: `load`, or the last frame of an agent's trunk: `robot`, `human`, `robot_2`.
    """

    name: Name | None = None
    load_mass_share: Annotated[float, Meta(gt=-1.0)] = 0.0
    center_of_mass_m: Point = (0.0, 0.0, 0.0)
    push_n: Point = (0.0, 0.0, 0.0)
    at: Name = PushedAt.LOAD


class LimitsTable(Table, frozen=True):
    """`[limits]`: limits of ground contact and stance, for robots and people.

    Attributes:
        friction: Coulomb coefficient of soles on the ground; our choice.
        torsional_friction_m: largest moment about a foot's normal, over its normal force; our choice.
        least_foot_force_n: least normal force of a foot: contact is unilateral.
        trunk_clearance_m: least distance along x of the trunk's frames from the load's near edge; without
            it, 0.15 for a robot, half the trunk's depth and 2 cm for a person.
        feet_apart_m: least and largest sideways distance of the soles' origins; without it, [0.12, 0.50]
            for a robot; for a person from soles that touch to legs 20 degrees outwards.
        feet_stagger_m: largest difference of the soles' origins along x; our choice.
        feet_gap_m: least sideways distance of the soles' edges; without it, none; our choice.
        foot_yaw_rad: largest yaw of a foot; our choice.
        base_tilt_rad: largest roll, pitch and yaw of the root link; our choice.
        push_n: largest internal force between the agents; our choice.
    """

    friction: Positive = 0.5
    torsional_friction_m: NotNegative = 0.02
    least_foot_force_n: NotNegative = 0.0
    trunk_clearance_m: NotNegative | None = None
    feet_apart_m: tuple[NotNegative, NotNegative] | None = None
    feet_stagger_m: NotNegative = 0.30
    feet_gap_m: NotNegative | None = None
    foot_yaw_rad: NotNegative = 0.35
    base_tilt_rad: Positive = 0.60
    push_n: NotNegative = 5.0


class PushesTable(Table, frozen=True):
    """`[push]`: pushes on the robot's trunk that are simulated for quantities such as `push_margin`.

    Docs: control.md.

    Attributes:
        impulse_n_s: impulse of the push after which the load is tracked. Since 0.3.
        frequency_rad_s: bandwidth of all controllers. Since 0.3.
        damping_ratio: damping of all controllers. Since 0.3.
    """

    impulse_n_s: Positive = 10.0
    frequency_rad_s: Positive = 8.0
    damping_ratio: Positive = 1.0


class CollisionsTable(Table, frozen=True):
    """`[collisions]`: bodies do not overlap each other, load, floor or partner.

    Without the table they may overlap.

    Attributes:
        margin_m: least distance of bodies.
        ignore: pairs of links (or of a link and `load`, `floor`, `partner`) that may overlap, besides
            those that overlap as built; `evodesign check` lists these.
        part: pairs that every program separates, besides those that are found to come close.
    """

    margin_m: NotNegative = 0.005
    ignore: tuple[tuple[Name, Name], ...] = ()
    part: tuple[tuple[Name, Name], ...] = ()
