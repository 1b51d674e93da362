"""Postures side by side, one panel per height or moment of a lift: robot, person, load, and forces as arrows.

Several people or loads have a row of panels each.

Faces are painted from far to near, shaded by their slope to a light above the camera's left shoulder. Ground
forces begin at the centre of pressure and are orange as in the paper, hand forces are violet; the two have
scales of their own, equal in all panels.

A camera with azimuth a and elevation e looks from afar along -d, with

    d = (cos e cos a, cos e sin a, sin e)      right = z x d / |z x d|      up = d x right

and sees a point p at (p . right, p . up), the nearer the larger p . d.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MultipleLocator
from numpy.typing import NDArray

from evodesign.mechanics.agent import HUMAN, ROBOT
from evodesign.report.figures.faces import faces_of, seen_triangles
from evodesign.report.figures.paint import AGENTS, GROUND_FORCE, HAND_FORCE, INK, PALE, key_below, new_figure
from evodesign.report.scene_models import LOAD, ContactWrench, PlacedScene
from evodesign.tree.mesh_write import in_frame, vertices_of

Array = NDArray[np.float64]

Painted = tuple[float, Array, tuple[float, float, float]]
"""Nearness, outline and colour of a face as it is seen."""

LONGEST = 0.45
"""Length [m] in the scene of the largest force of a kind."""

FLOOR = ((-1.05, -0.55), (1.05, -0.55), (1.05, 0.55), (-1.05, 0.55))
"""Corners of the piece of ground that is drawn [m]."""

METRE = 1.45
"""Length of a metre [inches]."""

LEAST_PANEL = 1.9
"""Width of a panel in which its title has room [inches]."""

BETWEEN = 0.4
"""Room above each of several rows [inches]."""

HEAD = "-|>,head_width=0.22,head_length=0.45"

LEAST_FIGURE = 4.6
"""Width of a figure in which its legend has room [inches]."""

WORDS = {ROBOT: "robot", HUMAN: "person", LOAD: "load"}

COLORS = {True: GROUND_FORCE, False: HAND_FORCE}
"""Of the forces that the ground exerts, and of those that the load does."""


@dataclass(frozen=True, slots=True)
class Camera:
    """A far camera.

    Args:
        azimuth: of the direction towards the camera, about z from x [rad]; -pi/2 sees x to the right.
        elevation: above the ground, less than pi/2 [rad].
    """

    azimuth: float = math.radians(-68.0)
    elevation: float = math.radians(14.0)

    @property
    def axes(self) -> Array:
        """Rows right, up and towards the camera, shape (3, 3)."""
        towards = np.array(
            [
                math.cos(self.elevation) * math.cos(self.azimuth),
                math.cos(self.elevation) * math.sin(self.azimuth),
                math.sin(self.elevation),
            ]
        )
        right = np.array([-math.sin(self.azimuth), math.cos(self.azimuth), 0.0])
        return np.array([right, np.cross(towards, right), towards])

    def seen(self, points: Array) -> Array:
        """Right, up and nearness [m] of points, shape (n, 3) to (n, 3)."""
        found: Array = np.asarray(points) @ self.axes.T
        return found


def posture_figure(stages: Sequence[PlacedScene], title: str, camera: Camera | None = None) -> Figure:
    """A figure of postures.

    Args:
        stages: one per panel.
        title: over the figure.
        camera: where it is seen from.
    """
    view = camera or Camera()
    low, high = _limits(stages, view)
    rows, (across, up) = _rows(stages), high - low
    panels = max(len(rows[0]), 1)
    row = METRE * up + (BETWEEN if len(rows) > 1 else 0.0)
    width = max(METRE * across, LEAST_PANEL) * panels
    figure = new_figure(max(width, LEAST_FIGURE), row * len(rows) + 1.1, title)
    axes = figure.subplots(len(rows), panels, squeeze=False)
    longest = {by_ground: _longest(stages, by_ground) for by_ground in COLORS}
    for of_row, in_row in zip(axes, rows, strict=True):
        for panel, stage in zip(of_row, in_row, strict=False):
            if stage is None:
                continue
            _paint(panel, stage, view)
            for wrench in stage.wrenches:
                if longest[wrench.by_ground]:
                    _arrow(panel, wrench, view, LONGEST / longest[wrench.by_ground])
            panel.set_title(_heading(stage), fontsize=10, color=INK, parse_math=False)
    for place, panel in enumerate(axes.flat):
        panel.set(aspect="equal", xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        if view.elevation == 0.0 and stages:  # heights are seen at their true length
            _scale(panel, labelled=place % panels == 0)
        else:
            panel.set_axis_off()
    if stages:
        _key(figure, axes[0][0], stages, longest)
    else:
        axes[0][0].text(0.5, 0.5, "no posture", ha="center", color=INK, transform=axes[0][0].transAxes)
    return figure


def _rows(stages: Sequence[PlacedScene]) -> list[list[PlacedScene | None]]:
    """The stages of each person and load, at the same place those of a moment; at least one row."""
    pairs = [*dict.fromkeys(stage.models.label for stage in stages)]
    if len(pairs) < 2:
        return [[*stages]]
    moments = sorted({_moment(stage) for stage in stages})
    found = {(stage.models.label, _moment(stage)): stage for stage in stages}
    return [[found.get((pair, moment)) for moment in moments] for pair in pairs]


def _moment(stage: PlacedScene) -> tuple[float, str, float, int]:
    """Of whatever person and load, in the order of panels: agents that are drawn alone in their own order."""
    names, first = [agent.name for agent in stage.models.agents], next(iter(stage.models.trees))
    return stage.task.heights[0], str(stage.task), stage.time, names.index(first)


def _heading(stage: PlacedScene) -> str:
    who = stage.models.label
    if len(stage.models.trees) == 1:
        (name,) = stage.models.trees
        kind = stage.models.kind(name)
        word = f"{WORDS[kind]}{name.removeprefix(kind).replace('_', ' ')}"
        who = f"{word} with {who}" if kind == ROBOT and who else who or word
    place = f"load at {stage.place}"
    return f"{who}\n{place}" if who else place


def _scale(panel: Axes, *, labelled: bool) -> None:
    """Metres along both axes of a view in which they have their true length, and the ground."""
    panel.set_axisbelow(True)
    panel.grid(visible=True, color=PALE, linewidth=0.6)
    panel.axhline(0.0, color="#8a9097", linewidth=1.0, zorder=0.5)
    for spine in panel.spines.values():
        spine.set_visible(False)
    for axis in (panel.xaxis, panel.yaxis):
        axis.set_major_locator(MultipleLocator(0.5))
    panel.tick_params(colors=INK, labelsize=8, length=0, labelbottom=False, labelleft=labelled)
    if labelled:
        panel.set_ylabel("height [m]", fontsize=9, color=INK)


def _paint(axes: Axes, stage: PlacedScene, view: Camera) -> None:
    ground = view.seen(np.array([(x, y, 0.0) for x, y in FLOOR]))[:, :2]
    axes.add_collection(PolyCollection([ground], facecolors="#eef0f2", edgecolors="#c6cbd1", linewidths=0.6))
    light = np.array([-0.35, 0.55, 0.76]) @ view.axes
    seen = [*_painted_solids(stage, view, light), *_painted_meshes(stage, view, light)]
    seen.sort(key=lambda item: item[0])
    colors = [color for _, _, color in seen]
    polygons = [outline for _, outline, _ in seen]
    painted = PolyCollection(polygons, facecolors=colors, edgecolors=colors, linewidths=0.25)
    painted.set_rasterized(bool(stage.meshes))  # tens of thousands of triangles
    axes.add_collection(painted)


def _painted_solids(stage: PlacedScene, view: Camera, light: Array) -> Iterator[Painted]:
    for name, shape, place in stage.solids:
        for face in faces_of(shape, place):
            if float(face.normal @ view.axes[2]) > 0.0:
                corners = view.seen(face.corners)
                color = _shade(stage.models.kind(name), float(face.normal @ light))
                yield float(corners[:, 2].mean()), corners[:, :2], color


def _painted_meshes(stage: PlacedScene, view: Camera, light: Array) -> Iterator[Painted]:
    towards = view.axes[2]
    for name, mesh, world_from_link in stage.meshes:
        corners, normals = seen_triangles(mesh, world_from_link, towards)
        drawn = view.seen(corners.reshape(-1, 3)).reshape(-1, 3, 3)
        colors = [_shade(stage.models.kind(name), slope) for slope in (normals @ light).tolist()]
        yield from zip(drawn[:, :, 2].mean(axis=1).tolist(), drawn[:, :, :2], colors, strict=True)


def _shade(kind: str, slope: float) -> tuple[float, float, float]:
    """A kind's colour in the light: darker where a face turns away from it."""
    brightness = 0.62 + 0.43 * max(slope, -0.2)
    red, green, blue = (min(channel * brightness, 1.0) for channel in to_rgb(AGENTS[kind]))
    return red, green, blue


def _longest(stages: Sequence[PlacedScene], by_ground: bool) -> float:
    """The largest force of a kind [N]."""
    wrenches = [wrench for stage in stages for wrench in stage.wrenches if wrench.by_ground == by_ground]
    return max((math.hypot(*wrench.force) for wrench in wrenches), default=0.0)


def _arrow(axes: Axes, wrench: ContactWrench, view: Camera, scale: float) -> None:
    tail = np.array(wrench.point)
    (x, y, _), (to_x, to_y, _) = view.seen(np.array([tail, tail + scale * np.array(wrench.force)]))
    if math.hypot(to_x - x, to_y - y) < 0.02:  # shorter than its head
        return
    style = {"arrowstyle": HEAD, "color": COLORS[wrench.by_ground], "linewidth": 1.9}
    axes.annotate("", (to_x, to_y), (x, y), arrowprops={**style, "shrinkA": 0, "shrinkB": 0}, zorder=5)


def _limits(stages: Sequence[PlacedScene], view: Camera) -> tuple[Array, Array]:
    """Least and largest right and up [m] of everything that is drawn, each of shape (2,)."""
    points = [np.array([(x, y, 0.0) for x, y in FLOOR])]
    for stage in stages:
        points += [face.corners for _, shape, place in stage.solids for face in faces_of(shape, place)]
        points += [in_frame(vertices_of(mesh), place) for _, mesh, place in stage.meshes]
    seen = view.seen(np.vstack(points))[:, :2]
    return seen.min(axis=0) - 0.03, seen.max(axis=0) + 0.03


def _key(figure: Figure, axes: Axes, stages: Sequence[PlacedScene], longest: Mapping[bool, float]) -> None:
    """Who is who, and how long arrows are."""
    drawn = {*(stage.models.kind(name) for stage in stages for name in stage.models.trees), LOAD}
    who = [Patch(color=color, label=WORDS[name]) for name, color in AGENTS.items() if name in drawn]
    kinds = {True: "force on the feet", False: "force on the hands"}
    arrows = [
        axes.plot(
            [], [], color=COLORS[kind], linewidth=2.2, label=f"{kinds[kind]}, the largest {force:.3g} N"
        )[0]
        for kind, force in longest.items()
    ]
    key_below(figure, [*who, *arrows])
