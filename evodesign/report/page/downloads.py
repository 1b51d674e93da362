"""What a card shows and offers of a design: its postures, the robot as URDF, a replay.

A page of hundreds of designs has no room for whole files: a URDF is told by the lines that differ from the
unscaled robot's, and only marked designs have a replay. Neither holds mesh files; exported folders do.
"""

from __future__ import annotations

import base64
import io
import re
from typing import Any

import msgspec

from evodesign.errors import RunError
from evodesign.problem.build import DesignProblem
from evodesign.records import Detail
from evodesign.report.page.content import DesignContent
from evodesign.report.replay.recording import replay_frames, time_scale, write_frames
from evodesign.report.scene_models import SceneSet
from evodesign.runlog.run import RunLog
from evodesign.tree.model import Tree
from evodesign.tree.urdf_write import urdf_text

MOST_BYTES = 300_000
"""Of a replay in the page; one of a robot with many triangles is larger, and left out."""

DIGITS = 7
"""Of the numbers of a design that can be opened: a micrometre in ten metres."""

NUMBER = re.compile(r'(?<=[" ])(-?\d+\.\d+(?:e-?\d+)?)(?=[" ])')
"""In a line of a URDF."""


def rounded(design: DesignContent) -> DesignContent:
    """A design with numbers of seven significant digits, which take half the room."""
    return msgspec.convert(_rounded(msgspec.to_builtins(design)), DesignContent)


def _rounded(part: Any) -> Any:
    match part:
        case float():
            return float(f"{part:.{DIGITS}g}")
        case dict():
            return {key: _rounded(value) for key, value in part.items()}
        case list() | tuple():
            return [_rounded(value) for value in part]
    return part


def _parts(line: str) -> tuple[str | float, ...]:
    """A line of a URDF as its texts and, in between, its numbers."""
    return tuple(float(part) if place % 2 else part for place, part in enumerate(NUMBER.split(line)))


class Downloads:
    """Files of a run's designs.

    Args:
        problem: of the run.
        run: whose designs they are.
    """

    def __init__(self, problem: DesignProblem, run: RunLog) -> None:
        self._problem, self._run = problem, run
        self._unscaled = urdf_text(problem.scene.designed_tree).splitlines()

    def urdf(self, robot: Tree) -> dict[int, tuple[str | float, ...]] | str:
        """A robot's URDF as `DesignContent` tells it."""
        text = urdf_text(robot)
        lines = text.splitlines()
        if len(lines) != len(self._unscaled):
            return text
        pairs = enumerate(zip(lines, self._unscaled, strict=True))
        return {place: _parts(line) for place, (line, before) in pairs if line != before}

    def replay(self, robot: Tree, detail: Detail) -> str:
        """A design's replay as base64; empty if it is too large, or of strangers to the problem."""
        if not detail.cases:
            return ""
        stream = io.BytesIO()
        about = {
            "problem": self._run.header.problem_name,
            "run": self._run.directory.resolve().name,
            "design": str(detail.evaluation),
            "time": time_scale(detail.cases),
        }
        try:
            scene_set = SceneSet.of(self._problem.scenes, robot)
            frames = replay_frames(scene_set, detail.cases)
            write_frames(stream, scene_set, frames, {"robot.urdf": urdf_text(robot)}, about)
        except RunError:  # postures of strangers, whom the page does not draw
            return ""
        recorded = stream.getvalue()
        return base64.b64encode(recorded).decode() if len(recorded) <= MOST_BYTES else ""
