"""Starts of lifts: how a person moves, and how a robot's hold is moved before it is followed.

Where the load's path is given, robot and person are coupled by little, with point grasps by the push alone:
the best motion of one is the best one beside nearly every other. A person has many ways to lift a load, and
holds at both ends lead to few of them: from 0.6 m the best of 24 random starts had half the squared torques
of the others. So starts are chosen once per problem, as those of postures are
(`posture.seeking.start_training`): each has a motion of the person, and some move the robot's hold.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from evodesign.design.spread import spread_designs
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.mechanics.scene import scene_of
from evodesign.motion.lift_program import LiftProgram
from evodesign.motion.lifting import MOVED, lift_program, lift_starts, moved_posture
from evodesign.nlp.program import Start
from evodesign.nlp.solver import status_of
from evodesign.posture.check import Unchecked
from evodesign.posture.design_checkers import can_be_built
from evodesign.posture.formulations.reach import ReachProblem
from evodesign.posture.postures import PostureProblem
from evodesign.posture.precompute.meetings import with_meetings
from evodesign.posture.precompute.plan import PrecomputeSetting
from evodesign.posture.precompute.precomputed import NO_STARTS, Precomputed
from evodesign.posture.results import AgentPosture
from evodesign.posture.seeking.budget import BUDGET
from evodesign.posture.seeking.start_portfolio import StartPortfolio
from evodesign.posture.seeking.start_training import Training, start_portfolio
from evodesign.records import Hold, Lift, Status

TRAINING = Training(designs=4, begun=4, random=8, portfolio=4)

LOOKED_AT = 40
"""Designs among which those are sought that hold the load at both ends."""

JOINTS_MOVED, BASE_MOVED = 0.3, 0.1
"""Standard deviations by which a random start's joints [rad] and base [m] are moved."""

ROBOTS_MOVED = 0.5
"""Share of the random starts that move the robot's hold."""

Design = tuple[float, ...]
Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class _Found:
    """The end of a solve; others may begin as its person moves."""

    cost: float
    status: Status
    iterations: int
    values: Start


class _LiftLandscape:
    """The cost of a lift, by how it begins.

    Args:
        program: of the lift.
        lift: with as many knots.
        mass: of the load [kg].
        holds: of the same scene.
        first: the design whose postures random starts are near.
    """

    universal: tuple[Start, ...] = ({},)

    def __init__(
        self, program: LiftProgram, lift: Lift, mass: float, holds: PostureProblem, first: Design
    ) -> None:
        self._program, self._lift, self._mass, self._holds = program, lift, mass, holds
        self._first = first
        self._held: dict[Design, list[Mapping[str, AgentPosture]]] = {}

    def free(self, design: Design, start: Start) -> _Found:
        """The best optimum that a start leads to."""
        best = _Found(np.inf, Status.INFEASIBLE, 0, {})
        for begun in lift_starts(self._program, self._lift, self._ends(design), design, [start]).values():
            ending, _ = self._program.solve(self._lift, begun, design, self._mass)
            status = status_of(ending.word)
            if status is Status.SOLVED and ending.cost < best.cost:
                person = self._program.motion_of(HUMAN, replace(begun, symbols=ending.symbols))
                best = _Found(ending.cost, status, ending.iterations, {**start, **person})
        return best

    def settled(self, design: Design, end: _Found) -> _Found:
        """Nothing comes in later."""
        return end

    finished = settled

    def needed(self, end: _Found) -> Start:
        """How its person moves."""
        return end.values

    def size(self, start: Start) -> float:
        """All starts are of one program."""
        return 1.0

    def good(self, costs: Array, best: Array) -> NDArray[np.bool_]:
        """Within 1 % of the best one."""
        relative, absolute = BUDGET.near
        return np.asarray(costs <= best + relative * np.abs(best) + absolute)

    def random_start(self, rng: np.random.Generator) -> Start:
        """The person of a hold at either end, moved, and followed along the lift; some robots are moved."""
        last = int(rng.integers(2))
        postures = self._ends(self._first)[last]
        moved = {**postures, HUMAN: moved_posture(postures[HUMAN], _change(postures[HUMAN], rng))}
        person = self._program.followed(self._lift, moved, last * (self._lift.knots - 1), self._first)
        begun = self._program.motion_of(HUMAN, person)
        if rng.random() >= ROBOTS_MOVED:
            return begun
        return {**begun, MOVED: np.array([last, *_change(postures[ROBOT], rng)])}

    def _ends(self, design: Design) -> list[Mapping[str, AgentPosture]]:
        """A design's holds at both ends."""
        if design not in self._held:
            holds = [Hold(height_m=height) for height in self._lift.heights]
            self._held[design] = [self._holds.solve(design, hold, Unchecked()).postures for hold in holds]
        return self._held[design]


def lift_portfolio(
    setting: PrecomputeSetting, pair: tuple[str, str], lift: Lift, known: Precomputed
) -> StartPortfolio:
    """Where a lift begins, and how well other designs are solved from there.

    Args:
        setting: of the problem.
        pair: names of person and load.
        lift: of both.
        known: what earlier stages gave.
    """
    scene, space = with_meetings(scene_of(setting.scenes, pair), known.meetings), setting.space
    own = setting.of(scene)
    holds = PostureProblem(own, setting.symmetry, known)
    reach = ReachProblem(own, symmetric=setting.symmetric, known=known)

    built = can_be_built(scene, space)

    def held(design: Design) -> bool:
        if not built(design) or reach.solve(design).beyond(lift.heights) != 0.0:
            return False
        ends = (holds.solve(design, Hold(height_m=height), Unchecked()) for height in lift.heights)
        return all(end.solved for end in ends)

    def given(genome: Design) -> Design:
        return space.given(space.values(genome), {})

    designs = spread_designs(len(space.free), given, held, LOOKED_AT)
    first = next(designs, None)
    if first is None:
        return NO_STARTS
    program = lift_program(own, lift.knots, symmetric=setting.symmetric)
    landscape = _LiftLandscape(program, lift, scene.payload.mass, holds, first)
    return start_portfolio(landscape, designs, TRAINING)


def _change(posture: AgentPosture, rng: np.random.Generator) -> Array:
    """By how much a posture's base [m] and joints [rad] are moved, at random."""
    scales = np.r_[np.full(3, BASE_MOVED), np.full(len(posture.joints), JOINTS_MOVED)]
    return np.asarray(scales * rng.normal(size=len(scales)))
