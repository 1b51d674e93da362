"""A layout for Foxglove and Lichtblick: the scene, and beside it the largest joint torques of each agent.

The arrows and shapes are shown, the axes and names of the many frames are not. Both programs read the form.

Source: layouts that Foxglove Studio exports (`configById`, `layout`, `globalVariables`, `playbackConfig`).
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any, Final

from evodesign.records import CaseDetail
from evodesign.report.replay.messages import WORLD, frame_id
from evodesign.report.replay.recording import several, time_scale
from evodesign.report.replay.surfaces import topics_of
from evodesign.report.scene_models import LOAD, SceneSet
from evodesign.report.subset import ranked_joints

SCENE = "3D!scene"

JOINTS_SHOWN: Final = 6
"""Lines of a plot."""

CAMERA: Final = {
    "perspective": True,
    "distance": 4.6,
    "phi": 72.0,
    "thetaOffset": 22.0,
    "targetOffset": [0.0, 0.0, 0.8],
    "target": [0.0, 0.0, 0.0],
    "targetOrientation": [0.0, 0.0, 0.0, 1.0],
    "fovy": 45.0,
    "near": 0.05,
    "far": 100.0,
}

GRID: Final = {
    "layerId": "foxglove.Grid",
    "instanceId": "ground",
    "label": "ground",
    "visible": True,
    "frameLocked": True,
    "frameId": WORLD,
    "size": 4.0,
    "divisions": 8,
    "lineWidth": 1,
    "color": "#8a909780",
    "position": [0.0, 0.0, 0.0],
    "rotation": [0.0, 0.0, 0.0],
    "order": 1,
}


def layout_text(scene_set: SceneSet, cases: Sequence[CaseDetail]) -> str:
    """The layout as JSON text.

    Args:
        scene_set: who stands there.
        cases: postures, whose torques choose the joints that are plotted.
    """
    plots = {f"Plot!{name}": _plot(name, cases) for name in scene_set.models[0].trees}
    panels = {SCENE: _scene(scene_set, cases), **plots}
    layout = {"first": SCENE, "second": _stacked([*plots]), "direction": "row", "splitPercentage": 64}
    whole = {
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": layout,
    }
    return json.dumps(whole, indent=2, ensure_ascii=False) + "\n"


def _stacked(panels: Sequence[str]) -> Any:
    """Panels above each other, all of one height."""
    first, *others = panels
    if not others:
        return first
    share = 100 / len(panels)
    return {
        "first": first,
        "second": _stacked(others),
        "direction": "column",
        "splitPercentage": int(share) if share.is_integer() else share,
    }


def _scene(scene_set: SceneSet, cases: Sequence[CaseDetail]) -> dict[str, Any]:
    trees = [(name, tree) for models in scene_set.models for name, tree in models.trees.items()]
    links = [frame_id(name, link) for name, tree in trees for link in tree.link_by_name]
    frames = [LOAD, *dict.fromkeys(links)]
    letters = 1.0 if several(cases) else 0.0
    return {
        "cameraState": CAMERA,
        "followMode": "follow-none",
        "followTf": WORLD,
        "scene": {"backgroundColor": "#f4f5f6", "labelScaleFactor": letters},
        "transforms": {f"frame:{frame}": {"visible": False} for frame in (WORLD, *frames)},
        "topics": {topic: {"visible": True} for topic in topics_of(scene_set) if topic.startswith("/scene/")},
        "layers": {"ground": GRID},
        "publish": {},
        "imageMode": {},
    }


def _plot(agent: str, cases: Sequence[CaseDetail]) -> dict[str, Any]:
    torques = [detail.agents[agent].torques_n_m for case in cases for detail in case.few_moments]
    nameable = [joint for joint in ranked_joints(torques) if not set(joint) & set('"\\{}')]  # in a path
    time = time_scale(cases) if several(cases) else "time [s] = 10 x height [m]"
    return {
        "title": f"{agent}: joint torques [N m]; {time}",
        "paths": [_path(agent, joint) for joint in nameable[:JOINTS_SHOWN]],
        "showLegend": True,
        "legendDisplay": "floating",
        "showPlotValuesInLegend": True,
        "showXAxisLabels": True,
        "showYAxisLabels": True,
        "isSynced": True,
        "xAxisVal": "timestamp",
        "sidebarDimension": 240,
    }


def _path(agent: str, joint: str) -> dict[str, Any]:
    value = f'/joint_states/{agent}.joints[:]{{name=="{joint}"}}.effort'
    return {
        "value": value,
        "label": joint,
        "enabled": True,
        "timestampMethod": "receiveTime",
        "showLine": True,
    }
