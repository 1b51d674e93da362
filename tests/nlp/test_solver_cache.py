"""Solvers are built once for all options of their solves, and the ones that were last asked for are kept."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from evodesign.nlp.method import MethodName, SolverOptions
from evodesign.nlp.program import Program
from evodesign.nlp.solver import Solver, SolverCache
from evodesign.records import Status
from tests.nlp.native.programs import RandomProgram, random_program

IPOPT = SolverOptions()


def status(solver: Solver, random: RandomProgram) -> Status:
    numbers = np.random.default_rng(0).normal(size=random.numbers)
    return solver.solve({"numbers": numbers}, {}).status


def test_a_program_is_built_once_and_solved_by_each_options() -> None:
    random, built = random_program(4, convex=False), list[str]()

    def program() -> Program:
        built.append("once")
        return random.program

    solvers = SolverCache()
    usual = solvers.solver("a", program, IPOPT)
    short = solvers.solver("a", program, replace(IPOPT, iterations=2))
    again = solvers.solver("a", program, IPOPT)
    assert built == ["once"]
    assert status(usual, random) is status(again, random) is Status.SOLVED
    assert status(short, random) is Status.ITERATION_LIMIT
    assert usual.functions is short.functions


def test_options_of_options_stay_apart() -> None:
    solver = Solver(random_program(4, convex=False).program, IPOPT)
    short = solver.with_options(replace(IPOPT, iterations=2))
    assert short.near.options.iterations == 2
    assert short.near.options.near
    assert short.by_ipopt.options == replace(short.options, compiled=False)
    assert solver.near.by_ipopt.options.near


def test_machine_code_and_method_count() -> None:
    random, built = random_program(4, convex=False), list[Solver]()
    solvers = SolverCache()
    for options in (IPOPT, replace(IPOPT, compiled=True, method=MethodName.NATIVE)):
        built.append(solvers.solver("a", lambda: random.program, options))
    assert built[0].functions is not built[1].functions


def test_those_are_kept_that_were_last_asked_for() -> None:
    random, built = random_program(4, convex=False), list[str]()

    def asked(solvers: SolverCache, key: str) -> None:
        solvers.solver(key, lambda: built.append(key) or random.program, IPOPT)

    few = SolverCache(2)
    for key in "abacab":
        asked(few, key)
    assert "".join(built) == "abcb"
