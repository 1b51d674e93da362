"""Reach and postures of one design: reach first, then the postures of every case.

Of a design whose build brings bodies together only the reach is asked.

With sized actuators postures are found in rounds (`evaluation.sizing`): the first asks for reach and begins
all cases; the last one checks them.

Beyond 300 lines: the rounds of one design share what earlier ones found.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import product

from evodesign.collision.clearance import BodyDistance
from evodesign.collision.zero_posture import built_in_slack
from evodesign.evaluation.inner import InnerProblems
from evodesign.evaluation.sizing import sized_result, usual_values
from evodesign.mechanics.added_mass import AddedMasses
from evodesign.mechanics.scene import Scene
from evodesign.mechanics.stance_case import StanceTorques
from evodesign.nlp.program import Start
from evodesign.posture.allocation import shared_scene
from evodesign.posture.check import AgentModel, Checker, Unchecked
from evodesign.posture.design_checkers import with_hardware
from evodesign.posture.formulations.reach import HIGHEST, LOWEST, Reach, common_reach
from evodesign.posture.postures import PostureProblem
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.results import CaseSolution, Neighbour
from evodesign.posture.seeking.exchange import other_ways
from evodesign.problem.build import DesignProblem
from evodesign.quantities.demand import SizedRobot
from evodesign.quantities.design_result import DesignResult
from evodesign.quantities.stance_model import StanceModel
from evodesign.records import Case, Hold, Lift, Status
from evodesign.tree.equip import mounted_solids
from evodesign.tree.model import Tree

Cases = tuple[CaseSolution, ...]

LESS = "less was tried, as another case has no posture"
NOT_TRIED = "not tried, as another case has no posture"

UNCHECKED = Unchecked()


class DesignSolver:
    """Solves any number of designs; no state is carried from one to the next.

    Args:
        problem: whose designs they are.
        known: what is known beforehand.
        inner: its inner problems.
    """

    def __init__(self, problem: DesignProblem, known: Precomputed, inner: InnerProblems) -> None:
        self.problem, self.known, self.inner = problem, known, inner
        scene, space = problem.scene, problem.space
        self.family = space.family(scene.designed_tree)
        self.tree = self.family.tree
        self.robots = tuple(
            AgentModel.of(robot, self.tree if robot.designed else robot.tree) for robot in scene.robots
        )
        self.people = {
            scene.pair[0]: tuple(AgentModel.of(person, person.tree) for person in scene.people)
            for scene in problem.scenes
        }

    def solve(self, values: Sequence[float]) -> DesignResult:
        """Reach and postures of a design given as one number per parameter."""
        design = _OneDesign(self, values)
        overlap = design.built_in_overlap
        if overlap is not None:
            return design.unsought(overlap)
        if not self.problem.space.margins:
            return design.result(values)
        result = sized_result(self.problem.space, values, design.sized_robot, design, self.usual)
        return replace(result, values=tuple(values), rated=tuple(result.values))

    @property
    def robot(self) -> AgentModel:
        """The first one, which designs change."""
        return self.robots[0]

    @cached_property
    def usual(self) -> Mapping[str, float]:
        """What the unscaled robot asks of sized actuators [N m], by parameter; nothing if it holds none."""
        values = self.problem.space.unscaled(self.problem.scene.designed_tree)
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
        unscaled = space.given(space.unscaled(self.problem.scene.designed_tree), {})
        return tuple(found for _, found in self.alone.torques(self.family.resized(unscaled)))

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
        self._tree = solver.family.without_actuators(values)
        self._robots = with_hardware(solver.robots, self._tree)

    @property
    def _robot(self) -> AgentModel:
        """The first one."""
        return self._robots[0]

    @property
    def built_in_overlap(self) -> BodyDistance | None:
        """The bodies that the design's build brings nearest to each other, if it brings any together."""
        rules = self._robot.agent.collisions if self._robots else None
        found = built_in_slack(self._tree, rules)
        return found[1] if found is not None and found[0] < 0.0 else None

    def unsought(self, overlap: BodyDistance) -> DesignResult:
        """The results without a posture in any case, as the design's build brings bodies together."""
        how = "inside" if overlap.distance < 0.0 else "from"
        apart = f"{overlap.first} {1e3 * abs(overlap.distance):.2g} mm {how} {overlap.second}"
        reason = f"{apart} while all joints are at zero: no posture was sought"
        cases = (CaseSolution(case, Status.BODIES_OVERLAP, reason) for case in self._problem.cases)
        space, given = self._problem.space, self._values
        if space.margins:
            given = usual_values(space, given, self._solver.usual)
        result = self._of_cases(given, self._reach(given), tuple(cases))
        return replace(result, values=tuple(self._values), rated=tuple(given) if space.margins else ())

    @cached_property
    def sized_robot(self) -> SizedRobot:
        """The robot without the actuators that are sized."""
        model, solver, space = self._solver.alone, self._solver, self._problem.space
        body = self._robot.body if model.body is solver.robot.body else model.body.resized(self._tree)
        chosen = {name: each for name, each in space.actuators(self._values).items() if each.holds}
        if chosen:
            body = body.carrying(mounted_solids(self._tree, chosen))
        return SizedRobot(
            self._robot.agent, self._tree, body, self._problem.stances, solver.near, solver.added
        )

    def sketched(self, values: Sequence[float]) -> Cases:
        """Postures of every case from one start each, not checked; none where something is lifted as well."""
        if not all(isinstance(case.task, Hold) for case in self._problem.cases):
            return ()
        return tuple(self._postures(case).sketched(values, case.task) for case in self._problem.cases)

    def following(self, values: Sequence[float], before: Cases) -> Cases:
        """Those near the postures of another round, not checked."""
        found: list[CaseSolution] = []
        for solution in before:
            near = self._postures(solution.case).followed(values, solution) if solution.solved else solution
            found.append(near or self._in_case(values, solution.case, None, UNCHECKED))
        return tuple(found)

    def result(self, values: Sequence[float], before: Cases = ()) -> DesignResult:
        """The checked results for the values that programs are given, near the postures of a round.

        Cases that have none in that round have none.
        """
        problem, solver = self._problem, self._solver
        tree = problem.space.with_actuators(self._tree, values)
        robots = self._driven(tree) if problem.space.driven else self._robots
        reach = self._reach(values)
        check = Checker(problem.scene, *robots, *solver.people[problem.scene.pair[0]])
        return self._of_cases(values, reach, self.cases(values, reach, check, before))

    def _driven(self, tree: Tree) -> tuple[AgentModel, ...]:
        """The robots with the actuators of a tree, which hold what they can, if designs change them."""
        return tuple(each.driven(tree) if each.agent.designed else each for each in self._robots)

    def _of_cases(self, values: Sequence[float], reach: Reach, cases: Cases) -> DesignResult:
        problem, solver = self._problem, self._solver
        tree = problem.space.with_actuators(self._tree, values)
        return DesignResult(
            scenes=problem.scenes,
            space=problem.space,
            values=tuple(values),
            tree=tree,
            standing=self._standing(tree) if self._robots else None,
            reach=reach,
            cases=cases,
            paper=problem.joint,
            people_highest=min(
                (person.highest for person in solver.known.person_reaches.values()), default=None
            ),
        )

    def _standing(self, tree: Tree) -> StanceModel:
        """The robot that stands alone, with the actuators of a tree."""
        alone, solver = self._solver.alone, self._solver
        robot = self._driven(tree)[0] if self._problem.space.driven else self._robot
        body = robot.body if alone.body is solver.robot.body else None
        return StanceModel(alone.cases, alone.body, None if body is None else (tree, body))

    def _reach(self, values: Sequence[float]) -> Reach:
        return common_reach([reach.solve(values) for reach in self._solver.inner.reaches.values()])

    def cases(
        self,
        values: Sequence[float],
        reach: Reach | None = None,
        check: Checker = UNCHECKED,
        before: Cases = (),
    ) -> Cases:
        """Postures of every case: holds first, at last those that were not found at once; then lifts.

        A lift goes between holds.

        Args:
            values: that programs are given.
            reach: of the design; left out, it is asked for where a case has no posture.
            check: of the design; left out, postures are not checked.
            before: what another round found, near which postures are.
        """
        cases, found = self._problem.cases, dict[Case, CaseSolution]()
        lifts = {case: case.task for case in cases if isinstance(case.task, Lift)}
        for case, earlier in zip(cases, before or [None] * len(cases), strict=True):
            if earlier is not None and not earlier.solved:
                found[case] = earlier
            elif case not in lifts:
                near = self._neighbour([*found.values()], case)
                if earlier is not None:
                    near = Neighbour(earlier, unchecked=True)
                found[case] = _beyond(case, reach) or self._postures(case).begun(
                    values, case.task, self._checker(values, case, check), near, polished=reach is not None
                )
        lost = False
        for begun in [*found.values()]:
            if begun.attempts and not begun.solved and all(begun is not earlier for earlier in before):
                now = self._searched(values, begun, reach, check, [*found.values()], lost=lost)
                found[begun.case], lost = now, lost or not now.solved
        if not before:
            found |= self._improved(values, [each for each in found.values() if each.solved], reach, check)
        for case, lift in lifts.items():
            if case not in found:
                found[case] = self._lifted(values, case, lift, reach, check, [*found.values()])
        return tuple(found[case] for case in cases)

    def _improved(
        self, values: Sequence[float], solved: Sequence[CaseSolution], reach: Reach | None, check: Checker
    ) -> dict[Case, CaseSolution]:
        """The cases of a task in which robots stand differently: each in its own way, or in a better one."""
        found = dict[Case, CaseSolution]()
        robots = [robot.name for robot in self._problem.scene.robots]
        for own in solved:
            others = other_ways(own, self._similar(solved, own.case), robots)
            if others:
                found[own.case] = self._postures(own.case).improved(
                    values, own, others, self._checker(values, own.case, check), polished=reach is not None
                )
        return found

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
        scene, people = self._problem.scene_of(case), self._solver.people[case.person]
        held = [*found]
        for hold in (Hold(height_m=height) for height in lift.heights):
            end = scene.case(hold)
            if all(solution.case != end for solution in held):
                held.append(self._in_case(values, end, reach, check, held))
        ends = [
            next(solution for solution in held if solution.case == scene.case(Hold(height_m=height)))
            for height in lift.heights
        ]
        motions, starts = self._solver.inner.lifts[case.pair], self._solver.known.lift_starts(case.pair, lift)
        solution = motions.solve(values, lift, ends, check.robot, *people, known=starts, slowly=False)
        return solution.in_case(case)

    def _neighbour(self, before: Sequence[CaseSolution], case: Case) -> Neighbour | None:
        """The most similar case of the same task that was solved before: of the same load if there is one."""
        similar = self._similar(before, case)
        same_load = [solution for solution in similar if solution.case.payload == case.payload]
        return Neighbour((same_load or similar)[-1]) if similar else None

    def _similar(self, before: Sequence[CaseSolution], case: Case) -> list[CaseSolution]:
        """The solved ones of the same task."""
        joints = _joints(self._problem.scene_of(case))
        return [
            solution
            for solution in before
            if solution.solved
            and solution.case.task == case.task
            and _joints(self._problem.scene_of(solution.case)) == joints
        ]

    def _in_case(
        self,
        values: Sequence[float],
        case: Case,
        reach: Reach | None,
        check: Checker,
        found: Sequence[CaseSolution] = (),
    ) -> CaseSolution:
        """The posture in a case, beside what is found of others."""
        near, checker = self._neighbour(found, case), self._checker(values, case, check)
        begun = _beyond(case, reach) or self._postures(case).begun(
            values, case.task, checker, near, polished=reach is not None
        )
        if begun.solved or not begun.attempts:
            return begun
        return self._searched(values, begun, reach, check, found)

    def _searched(
        self,
        values: Sequence[float],
        begun: CaseSolution,
        reach: Reach | None,
        check: Checker,
        found: Sequence[CaseSolution],
        *,
        lost: bool = False,
    ) -> CaseSolution:
        """The posture in a case within reach to which the first formulation did not lead at once (`begun`).

        Where another case has none (`lost`), the design is infeasible, and nothing else is tried.
        """
        case, reach = begun.case, reach or self._reach(values)
        beyond = _beyond(case, reach)
        if beyond is not None:
            return beyond
        if lost:
            return replace(begun, reason=f"{begun.reason} ({LESS})")
        return self._postures(case).solve(
            values,
            case.task,
            self._checker(values, case, check),
            self._neighbour(found, case),
            self._elsewhere(found, case),
            self._at_ends_of_reach(values, case),
        )

    def _at_ends_of_reach(self, values: Sequence[float], case: Case) -> list[Start]:
        """How robots hold the highest and the lowest load that are asked for, where that is known."""
        reaches = self._solver.inner.reaches.items()
        own = [
            reached
            for (payload, _, people), reached in reaches
            if payload == case.payload and people in ("", case.person)
        ]
        found = ([each.extreme_posture(values, sense) for each in own] for sense in (HIGHEST, LOWEST))
        return [
            {name: value for part in parts for name, value in part.items()}
            for all_robots in found
            for parts in product(*all_robots)
        ]

    def _elsewhere(self, found: Sequence[CaseSolution], case: Case) -> list[Neighbour]:
        """Solutions of other tasks, those at the nearest heights first."""
        joints = _joints(self._problem.scene_of(case))
        others = [
            each
            for each in found
            if each.solved
            and each.case.task != case.task
            and _joints(self._problem.scene_of(each.case)) == joints
        ]
        others.sort(key=lambda each: abs(each.case.task.heights[0] - case.task.heights[0]))
        return [Neighbour(each) for each in others]

    def _postures(self, case: Case) -> PostureProblem:
        return self._solver.inner.postures[case.pair]

    def _checker(self, values: Sequence[float], case: Case, check: Checker) -> Checker:
        """The check, in a case."""
        scene = shared_scene(self._problem.scene_of(case), self._problem.space, values)
        return check.elsewhere(scene, *self._solver.people[case.person])


def _joints(scene: Scene) -> tuple[tuple[str, ...], ...]:
    """Those that move, of each person."""
    return tuple(person.joints for person in scene.people)


def _beyond(case: Case, reach: Reach | None) -> CaseSolution | None:
    """Why there is no posture in a case whose heights are out of reach; None within it, or if unknown."""
    if reach is None:
        return None
    distance = reach.beyond(case.task.heights)
    if distance is None:
        return CaseSolution(case, reach.status, reach.reason)
    if distance > 0.0:
        reason = f"{case.task} is {distance:.3f} m out of reach: the robot {reach.reason}"
        return CaseSolution(case, Status.INFEASIBLE, reason)
    return None
