"""Random designs ranked with and without disturbances.

Random designs of point-grasp hold a load without disturbances, and with those of 20 % more load and
of 20 N on the load, away from the robot and towards it. They are ranked by the robot's torque: undisturbed by
its mean over the heights; under disturbances by the mean over the heights of its worst case, in postures that
are chosen for it. All solves begin at the same starts: the program's own and some random ones. Results go to
benchmarks/results/disturbed_ranking.json, a figure to docs/pictures/disturbed_ranking.png, and tables are
printed.

    python -m benchmarks.disturbed_ranking [--designs 50] [--starts 2] [--jobs 2]
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict, dataclass, replace

import numpy as np
from joblib import Parallel, delayed
from scipy.stats import kendalltau, rankdata

from benchmarks.inner_problem import HERE, Design, problem_at, random_designs
from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.mechanics.disturbance import Disturbance, Disturbances
from evodesign.mechanics.payload import Grasp
from evodesign.mechanics.scene import Scene
from evodesign.posture.check import AgentModel, Checker
from evodesign.posture.formulations.base import Setting
from evodesign.posture.formulations.reach import ReachProblem
from evodesign.posture.postures import PostureProblem
from evodesign.posture.precompute.precomputed import Precomputed
from evodesign.posture.results import CaseSolution
from evodesign.posture.seeking.start_portfolio import Coverage, StartPortfolio
from evodesign.problem.build import DesignProblem
from evodesign.records import Hold
from evodesign.report.figures.paint import SEQUENCE, clean, new_figure, write_figure

HEIGHTS = (0.8, 1.0, 1.2)
HOLDS = tuple(Hold(height_m=height) for height in HEIGHTS)
DISTURBANCES = Disturbances(
    (
        Disturbance("20 % more load", mass_share=0.2),
        Disturbance("pushed to the person", push=(20.0, 0.0, 0.0)),
        Disturbance("pushed to the robot", push=(-20.0, 0.0, 0.0)),
    )
)
LOADS = {"point grasps, 5 kg": (Grasp.POINT, 5.0), "rigid grasps, 10 kg": (Grasp.RIGID, 10.0)}
PICTURES = HERE.parent / "docs" / "pictures"
ITERATIONS = 80
"""Limit of a solve; those that succeed mostly take 15 to 40."""

FALLEN = 3
"""Designs that are listed."""


@dataclass(frozen=True, slots=True)
class Row:
    """One design; torque norms are means over the heights [N m].

    Args:
        undisturbed_robot, undisturbed_human: without disturbances.
        robot, human: of the worst case, in postures chosen for it.
        same_posture_robot: in the postures for disturbances, while none acts.
        case: the load case of largest robot torque.
    """

    undisturbed_robot: float
    undisturbed_human: float
    robot: float
    human: float
    same_posture_robot: float
    case: str


class Judge:
    """A problem with one load, undisturbed and disturbed."""

    def __init__(self, problem: DesignProblem, load: str, starts: int) -> None:
        grasp, mass = LOADS[load]
        payload = replace(problem.scene.payload, grasp=grasp, mass=mass)
        undisturbed = replace(problem.scene, payload=payload)
        self._problem = problem
        self._scenes = (undisturbed, replace(undisturbed, disturbances=DISTURBANCES))
        self._reach = ReachProblem(
            Setting(self._scenes[1], problem.space, problem.weights, problem.options), symmetric=True
        )
        self._postures = [_with_starts(problem, scene, starts) for scene in self._scenes]
        self._human = AgentModel.of(undisturbed.human, undisturbed.human.tree)

    def row(self, design: Design) -> Row | None:
        """Torques of a design; None if it does not reach every height."""
        reach = self._reach.solve(design)
        if any(reach.distance(height) != 0.0 for height in HEIGHTS):
            return None
        tree = self._problem.space.resized(self._scenes[0].robot.tree, design)
        found = []
        for scene, postures in zip(self._scenes, self._postures, strict=True):
            checker = Checker(scene, AgentModel.of(scene.robot, tree), self._human)
            found.append([postures.solve(design, task, checker) for task in HOLDS])
        if not all(solution.solved for solutions in found for solution in solutions):
            return None
        undisturbed, shaken = found
        worst = [max(_norms(solution, ROBOT).items(), key=lambda item: item[1]) for solution in shaken]
        return Row(
            undisturbed_robot=float(np.mean([s.postures[ROBOT].torque_norm for s in undisturbed])),
            undisturbed_human=float(np.mean([s.postures[HUMAN].torque_norm for s in undisturbed])),
            robot=float(np.mean([norm for _, norm in worst])),
            human=float(np.mean([max(_norms(s, HUMAN).values()) for s in shaken])),
            same_posture_robot=float(np.mean([s.postures[ROBOT].torque_norm for s in shaken])),
            case=max(worst, key=lambda item: item[1])[0],
        )


def _norms(solution: CaseSolution, agent: str) -> dict[str, float]:
    """Torque norms of an agent [N m], by case."""
    cases = {"nothing": solution.postures, **solution.disturbed}
    return {name: postures[agent].torque_norm for name, postures in cases.items()}


def _with_starts(problem: DesignProblem, scene: Scene, count: int) -> PostureProblem:
    """A posture problem whose solves begin at the program's own starts and at some random ones."""
    setting = Setting(scene, problem.space, problem.weights, problem.options)
    landscape = PostureProblem(setting, problem.symmetry).landscape(HOLDS[0])
    rng = np.random.default_rng(0)
    starts = (*landscape.starts, *(landscape.free_start(rng) for _ in range(count)))
    portfolio = StartPortfolio(starts, Coverage(0, 0, 0.0))
    known = Precomputed(postures=dict.fromkeys(HOLDS, portfolio))
    return PostureProblem(setting, problem.symmetry, known)


def judge(load: str, designs: list[Design], starts: int) -> list[Row | None]:
    """The rows of some designs."""
    problem = problem_at(HEIGHTS)
    few = replace(problem.options, iterations=ITERATIONS)
    here = Judge(replace(problem, options=few), load, starts)
    return [here.row(design) for design in designs]


@dataclass(frozen=True, slots=True)
class Ranking:
    """How alike two rankings of the same designs are.

    Args:
        tau: Kendall's, 1 for the same order.
        kept: share of the best tenth of the undisturbed ranking that is in that of the other one.
        rise: largest ratio of a robot's torque in the worst case to the undisturbed one.
        undisturbed, disturbed: rank of each design, from 1.
        rows: the designs.
    """

    tau: float
    kept: float
    rise: float
    undisturbed: list[float]
    disturbed: list[float]
    rows: list[Row]

    @classmethod
    def of(cls, rows: list[Row]) -> Ranking:
        """The rankings of some designs by the robot's torque."""
        undisturbed, disturbed = (
            rankdata([getattr(row, name) for row in rows]) for name in ("undisturbed_robot", "robot")
        )
        tenth = max(1, len(rows) // 10)
        best, still = (set(np.argsort(ranks)[:tenth].tolist()) for ranks in (undisturbed, disturbed))
        return cls(
            tau=float(kendalltau(undisturbed, disturbed).statistic),
            kept=len(best & still) / tenth,
            rise=max(row.robot / row.undisturbed_robot for row in rows),
            undisturbed=undisturbed.tolist(),
            disturbed=disturbed.tolist(),
            rows=rows,
        )

    @property
    def fallen(self) -> list[int]:
        """Places of the designs that fall furthest."""
        fall = np.array(self.disturbed) - np.array(self.undisturbed)
        return np.argsort(-fall, kind="stable")[:FALLEN].tolist()


def table(rankings: dict[str, Ranking]) -> str:
    """How alike the rankings are, and the designs that fall furthest."""
    lines = ["| load | designs | Kendall's tau | best tenth kept | largest rise |", "|---|---|---|---|---|"]
    lines += [
        f"| {load} | {len(found.rows)} | {found.tau:.2f} | {found.kept:.0%} | {found.rise:.1f} x |"
        for load, found in rankings.items()
    ]
    robot = "robot undisturbed | robot worst | robot, same posture, undisturbed"
    columns = f"load | rank | {robot} | human undisturbed | human worst | worst case"
    lines += ["", f"| {columns} |", "|---" * 8 + "|"]
    for load, found in rankings.items():
        for place in found.fallen:
            row, ranks = found.rows[place], f"{found.undisturbed[place]:.0f} to {found.disturbed[place]:.0f}"
            robot = f"{row.undisturbed_robot:.1f} | {row.robot:.1f} | {row.same_posture_robot:.1f}"
            lines.append(
                f"| {load} | {ranks} | {robot} | {row.undisturbed_human:.1f} | {row.human:.1f} | {row.case} |"
            )
    return "\n".join(lines)


def draw(rankings: dict[str, Ranking]) -> None:
    """Rank against rank, the fallen ones marked."""
    figure = new_figure(9.0, 4.4, "rank of a design by its robot's torque")
    for axes, (load, found) in zip(figure.subplots(1, len(rankings)), rankings.items(), strict=True):
        clean(axes)
        fallen = [place in found.fallen for place in range(len(found.rows))]
        axes.plot([1, len(found.rows)], [1, len(found.rows)], color="#8a9097", linewidth=0.8)
        axes.scatter(found.undisturbed, found.disturbed, s=18, c=[SEQUENCE[int(fell)] for fell in fallen])
        axes.set(title=f"{load}: tau {found.tau:.2f}", xlabel="undisturbed", ylabel="with disturbances")
    write_figure(figure, PICTURES, "disturbed_ranking")[0].unlink()


def main() -> None:
    """Judge all designs, write, draw and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--designs", type=int, default=50)
    parser.add_argument("--starts", type=int, default=2)
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    designs = random_designs(problem_at(HEIGHTS), options.designs)
    parts = Parallel(options.jobs)(delayed(judge)(load, designs, options.starts) for load in LOADS)
    rankings = {
        load: Ranking.of([row for row in part if row is not None])
        for load, part in zip(LOADS, parts, strict=True)
    }
    target = HERE / "results" / "disturbed_ranking.json"
    figures = {load: asdict(ranking) for load, ranking in rankings.items()}
    target.write_text(json.dumps({**vars(options), "figures": figures}, indent=2) + "\n")
    draw(rankings)
    print(table(rankings))


if __name__ == "__main__":
    main()
