"""Reach and postures of one design: reach first, then the postures of every case.

With sized actuators postures are found in rounds (`problem.sizing`): the first asks for reach and begins all
cases; the last one checks them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property

from evodesign.mechanics.added_mass import AddedMasses
from evodesign.mechanics.stance_case import StanceTorques
from evodesign.posture.allocation import shared_scene
from evodesign.posture.check import AgentModel, Checker, Unchecked
from evodesign.posture.formulations.reach import Reach, common_reach
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.results import CaseSolution, Neighbour
from evodesign.problem.build import DesignProblem
from evodesign.problem.demand import SizedRobot
from evodesign.problem.design_result import DesignResult
from evodesign.problem.hardware_objectives import StanceModel
from evodesign.problem.inner import InnerProblems
from evodesign.problem.sizing import sized_result
from evodesign.records import Case, Hold, Lift, Status
from evodesign.tree.equip import mounted_solids

__all__ = ["DesignSolver"]

Cases = tuple[CaseSolution, ...]

LESS = "less was tried, as another case has no posture"
NOT_TRIED = "not tried, as another case has no posture"


class DesignSolver:
    """Solves any number of designs; no state is carried from one to the next.

    Args:
        problem: whose designs they are.
        known: what is known beforehand.
        inner: its inner problems.
    """

    def __init__(self, problem: DesignProblem, known: Precomputed, inner: InnerProblems) -> None:
        self.problem, self.known, self.inner = problem, known, inner
        robot, space = problem.scene.robot, problem.space
        self.growths = space.growths(robot.tree)
        self.tree = space.with_fixed_walls(robot.tree)
        self.robot = AgentModel.of(robot, self.tree)
        self.people = {s.human.label: AgentModel.of(s.human, s.human.tree) for s in problem.scenes}

    def solve(self, values: Sequence[float]) -> DesignResult:
        """Reach and postures of a design given as one number per parameter."""
        design = _OneDesign(self, values)
        if not self.problem.space.margins:
            return design.result(values)
        result = sized_result(self.problem.space, values, design.sized_robot, design, self.usual)
        return replace(result, values=tuple(values), rated=tuple(result.values))

    @cached_property
    def usual(self) -> Mapping[str, float]:
        """What the unscaled robot asks of sized actuators [N m], by parameter; nothing if it holds none."""
        values = self.problem.space.unscaled(self.problem.scene.robot.tree)
        design = _OneDesign(self, values)
        found = sized_result(self.problem.space, values, design.sized_robot, design)
        return {} if found.demand is None else found.demand.at(found.demand.sizes)

    @cached_property
    def alone(self) -> StanceModel:
        """The robot that stands alone, of any design."""
        agent, driven = self.robot.agent, self.problem.space.driven
        if set(driven) <= set(agent.joints):
            return StanceModel(self.problem.stances, self.robot.body)
        return StanceModel.of(self.problem.stances, replace(agent, tree=self.tree), driven)

    @cached_property
    def near(self) -> tuple[StanceTorques, ...]:
        """The unscaled robot in each standing case."""
        space = self.problem.space
        unscaled = space.given(space.unscaled(self.problem.scene.robot.tree), {})
        return tuple(found for _, found in self.alone.torques(space.resized(self.tree, unscaled)))

    @cached_property
    def added(self) -> AddedMasses:
        """The groups of sized actuators."""
        space, joints = self.problem.space, self.tree.joint_by_name
        groups = [space.parameters[place].joints for place in space.margins]
        return AddedMasses(self.alone.body, [[joints[name].child for name in group] for group in groups])


class _OneDesign:
    """One design, with actuators of any size.

    Args:
        solver: of its problem.
        values: of the design; those of margins do not count.
    """

    def __init__(self, solver: DesignSolver, values: Sequence[float]) -> None:
        self._solver, self._problem, self._values = solver, solver.problem, values
        self._tree = solver.problem.space.without_actuators(solver.tree, values, solver.growths)
        self._robot = solver.robot.resized(self._tree)

    @cached_property
    def sized_robot(self) -> SizedRobot:
        """The robot without the actuators that are sized."""
        model, solver, space = self._solver.alone, self._solver, self._problem.space
        body = self._robot.body if model.body is solver.robot.body else model.body.resized(self._tree)
        chosen = {name: each for name, each in space.actuators(self._values).items() if each.holds}
        if chosen:
            body = body.carrying(mounted_solids(self._tree, chosen))
        return SizedRobot(self._robot.agent, body, self._problem.stances, solver.near, solver.added)

    def first(self, values: Sequence[float]) -> Cases:
        """Postures of every case, not checked."""
        return self._cases(values, None, Unchecked())

    def following(self, values: Sequence[float], before: Cases) -> Cases:
        """Those near the postures of another round, not checked."""
        found: list[CaseSolution] = []
        for solution in before:
            postures = self._solver.inner.postures[solution.case.pair]
            near = postures.followed(values, solution) if solution.solved else solution
            found.append(near or self._in_case(values, solution.case, None, Unchecked(), None))
        return tuple(found)

    def result(self, values: Sequence[float], before: Cases = ()) -> DesignResult:
        """The checked results for the values that programs are given, near the postures of a round.

        Cases that have none in that round have none.
        """
        problem, solver = self._problem, self._solver
        tree = problem.space.with_actuators(self._tree, values)
        robot = self._robot.driven(tree) if problem.space.driven else self._robot
        reach = self._reach(values)
        check = Checker(problem.scene, robot, solver.people[problem.scene.human.label])
        alone = solver.alone
        body = robot.body if alone.body is solver.robot.body else None
        return DesignResult(
            scenes=problem.scenes,
            space=problem.space,
            values=tuple(values),
            tree=tree,
            standing=StanceModel(alone.cases, alone.body, None if body is None else (tree, body)),
            reach=reach,
            cases=self._cases(values, reach, check, before),
            paper=problem.joint,
            people_highest=min(
                (person.highest for person in solver.known.person_reaches.values()), default=None
            ),
        )

    def _reach(self, values: Sequence[float]) -> Reach:
        return common_reach([reach.solve(values) for reach in self._solver.inner.reaches.values()])

    def _cases(
        self, values: Sequence[float], reach: Reach | None, check: Checker, before: Cases = ()
    ) -> Cases:
        problem, found = self._problem, list[CaseSolution]()
        for number, case in enumerate(problem.cases):
            if before and not before[number].solved:
                found.append(before[number])
                continue
            if isinstance(case.task, Lift):
                found.append(self._lifted(values, case, case.task, reach, check, found))
                continue
            scene = shared_scene(problem.scene_of(case), problem.space, values)
            checker = check.elsewhere(scene, self._solver.people[case.person])
            near = self._neighbour(found, case)
            if before:
                near = Neighbour(before[number], same_load=True, unchecked=True)
            lost = any(each.attempts and not each.solved for each in found)
            found.append(self._in_case(values, case, reach, checker, near, lost=lost))
        return tuple(found)

    def _lifted(
        self,
        values: Sequence[float],
        case: Case,
        lift: Lift,
        reach: Reach | None,
        check: Checker,
        found: Sequence[CaseSolution],
    ) -> CaseSolution:
        """The motion of a lift from the holds at both ends; none is looked for where another case failed."""
        reach = reach or self._reach(values)
        beyond = _beyond(case, reach)
        if beyond is not None:
            return beyond
        failed = [solution for solution in found if not solution.solved]
        if failed:
            return CaseSolution(case, failed[0].status, NOT_TRIED)
        scene = shared_scene(self._problem.scene_of(case), self._problem.space, values)
        human = self._solver.people[case.person]
        checker, held = check.elsewhere(scene, human), [*found]
        for hold in (Hold(height_m=height) for height in lift.heights):
            end = scene.case(hold)
            if all(solution.case != end for solution in held):
                held.append(self._in_case(values, end, reach, checker, self._neighbour(held, end)))
        ends = [
            next(solution for solution in held if solution.case == scene.case(Hold(height_m=height)))
            for height in lift.heights
        ]
        motions = self._solver.inner.lifts[case.pair]
        return motions.solve(values, lift, ends, check.robot, human, slowly=False).in_case(case)

    def _neighbour(self, before: Sequence[CaseSolution], case: Case) -> Neighbour | None:
        """The most similar case of the same task that was solved before: of the same load if there is one."""
        joints, best = self._problem.scene_of(case).human.joints, None
        for solution in before:
            other = self._problem.scene_of(solution.case)
            if solution.solved and solution.case.task == case.task and other.human.joints == joints:
                same_load = solution.case.payload == case.payload
                if best is None or same_load >= best.same_load:
                    best = Neighbour(solution, same_load)
        return best

    def _in_case(
        self,
        values: Sequence[float],
        case: Case,
        reach: Reach | None,
        checker: Checker,
        neighbour: Neighbour | None,
        *,
        lost: bool = False,
    ) -> CaseSolution:
        """The posture in a case; a reach that is not known is asked for where there is none at once.

        Where another case has none (`lost`), the design is infeasible, and no refuge is sought.
        """
        postures = self._solver.inner.postures[case.pair]
        if reach is None:
            begun = postures.begun(values, case.task, checker, neighbour)
            if begun.solved:
                return begun
            reach = self._reach(values)
        beyond = _beyond(case, reach)
        if beyond is not None:
            return beyond
        if not lost:
            return postures.solve(values, case.task, checker, neighbour)
        begun = postures.begun(values, case.task, checker, neighbour)
        return begun if begun.solved else replace(begun, reason=f"{begun.reason} ({LESS})")


def _beyond(case: Case, reach: Reach) -> CaseSolution | None:
    """Why there is no posture in a case whose heights are out of reach; None within it."""
    distance = reach.beyond(case.task.heights)
    if distance is None:
        return CaseSolution(case, reach.status, reach.reason)
    if distance > 0.0:
        reason = f"{case.task} is {distance:.3f} m out of reach: the robot {reach.reason}"
        return CaseSolution(case, Status.INFEASIBLE, reason)
    return None
