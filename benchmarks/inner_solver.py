"""What one design costs, and how much of its score is luck.

Times (medians on one core, compiled and on CasADi's virtual machine): the reach problem, the robot against the
person's value function, the joint symmetric posture, the whole posture. Designs per second and core, the share
of wall time outside IPOPT, one worker against two, and the paper's own formulation beside them in the same run.

Quality (--quality): random designs at four heights; how many reachable heights are solved, how many of those
lie within 1 % of the best of 25 random starts, and how far the optimum of robot and person solved one after
the other lies from that of the joint program.

    python benchmarks/inner_solver.py [--designs 40] [--quality 200] [--joint 50] [--paper 3]

Results go to benchmarks/results/inner_solver.json and are printed as Markdown tables.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from evodesign.cli.ready import known_of
from evodesign.pool.joblib_pool import JoblibPool
from evodesign.posture.form import symmetric_forms, whole
from evodesign.posture.portfolio import NEAR, Landscape, random_start
from evodesign.posture.posture import PostureProblem
from evodesign.posture.preparation import Preparation
from evodesign.posture.program import RawSolution, Solver
from evodesign.problem.build import Problem, build_problem
from evodesign.problem.evaluate import AssessmentFactory, Evaluator
from evodesign.problem.source import read_source
from evodesign.records import ProblemSource, Status

HERE = Path(__file__).parent
PROBLEM = HERE.parent / "problems" / "icub_lifting.toml"
HEIGHTS = "heights_m = [0.8, 1.0, 1.2, 1.5]"
Design = tuple[float, ...]
