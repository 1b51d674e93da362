"""What tests of the page share: opening it, and reading what it shows."""

from __future__ import annotations

import base64
import gzip
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import casadi as ca
import msgspec
import numpy as np
import pytest

from evodesign.records import AgentDetail
from evodesign.report.page.content import Content
from evodesign.report.page.render import STEPS
from evodesign.tree.kinematics import Pose, euler_rotation, forward
from evodesign.tree.model import Tree
from tests.report.page.chromium import Tab

SHOWN_WITHIN = 2e-3
"""How far links [m] stand from where the log has them, as pages tell joints and bases in steps."""

CANVAS = "document.getElementById('posture')"


def open_page(tab: Tab, path: Path, theme: str = "light") -> None:
    """Open a page and wait until its scripts are through."""
    tab.open(path.as_uri(), theme=theme)
    tab.wait_for("window.evodesign !== undefined")


def shown_as(value: float) -> str:
    """A number as tiles and tables show it: four significant digits."""
    return f"{value:#.4g}".rstrip(".").replace("-", "\u2212")


def leaves(part: Any, path: str = "") -> dict[str, Any]:
    """Every number and text of a record by its path."""
    match msgspec.to_builtins(part):
        case dict() as found:
            parts = found.items()
        case list() | tuple() as found:
            parts = enumerate(found)
        case found:
            return {path: found}
    return {at: leaf for key, one in parts for at, leaf in leaves(one, f"{path}/{key}").items()}


def apart(groups: Sequence[Mapping[str, Any]]) -> dict[int, Any]:
    """What `page.columns` wrote side by side, by the design's number."""

    def filled(form: Any, values: Iterator[Any]) -> Any:
        match form:
            case dict():
                return {key: filled(part, values) for key, part in form.items()}
            case list():
                return [filled(part, values) for part in form]
        return next(values)

    def value(group: Mapping[str, Any], place: int, row: int) -> Any:
        column = group["columns"][place if place >= 0 else -1 - place]
        match column:
            case list() | tuple():
                found = column[row]
            case {"per": per, "times": times}:
                found = times[row] / per
            case found:
                pass
        return found if place >= 0 else -found

    return {
        number: filled(group["form"], (value(group, place, row) for place in group["places"]))
        for group in groups
        for row, number in enumerate(group["of"])
    }


def embedded(page: str) -> Content:
    """The content as a browser finds it: up to the first end of its script element."""
    block = page.split('<script type="text/plain" id="content">')[1].split("</script>")[0]
    told = msgspec.json.decode(gzip.decompress(base64.b85decode(block)))
    designs: dict[int, dict[str, Any]] = {}
    limits, kinds = told.pop("limits"), told.pop("limit_kinds")
    for field, groups in told["designs"].items():
        for number, value in apart(groups).items():
            designs.setdefault(number, {})[field] = value
    for number, design in designs.items():
        for posture, active in zip(design["postures"], limits[str(number)], strict=True):
            if active:
                pairs = zip(active[::2], active[1::2], strict=True)
                posture["limits"] = [{**kinds[kind], "price_n_m": price} for kind, price in pairs]
    return msgspec.convert({**told, "designs": designs}, Content, strict=False)


def check_as_shown(shown: Any, made: Any) -> None:
    """Two contents, or parts of them, are the same, but for digits that the written page drops."""
    mine, theirs = leaves(shown), leaves(made)
    assert mine.keys() == theirs.keys()
    for path, value in theirs.items():
        if not isinstance(value, float):
            assert mine[path] == value, path
        elif "/limits/" in path or path.endswith("/residual"):
            assert mine[path] == pytest.approx(value, rel=0.06, abs=0.0), path
        elif any(f"/{field}/" in path for field in STEPS):
            assert mine[path] == pytest.approx(value, rel=2e-3, abs=2e-2), path
        else:
            assert mine[path] == pytest.approx(value, rel=5e-7, abs=0.0), path


def check_to_seven_digits(shown: Any, logged: Any) -> None:
    """Records are the same, but for what lies beyond seven digits of a number."""
    assert leaves(shown) == {
        path: pytest.approx(leaf, rel=5e-7, abs=0.0) if isinstance(leaf, float) else leaf
        for path, leaf in leaves(logged).items()
    }


def check_poses(
    tab: Tab, script: str, tree: Tree, posture: AgentDetail, turn: float, within: float = 1e-9
) -> None:
    """A script's link poses are those of our kinematics, for an agent's frame turned about z [rad]."""
    world_from_agent = euler_rotation(ca.DM([0.0, 0.0, turn]))
    base = Pose(
        world_from_agent @ euler_rotation(ca.DM(posture.base_rpy_rad)),
        world_from_agent @ ca.DM(posture.base_position_m),
    )
    poses = forward(tree, base, posture.joints_rad)
    for link, pose in zip(tree.links, tab.value(script), strict=True):
        wanted = poses[link.name]
        np.testing.assert_allclose(pose["position"], np.array(wanted.position)[:, 0], rtol=0.0, atol=within)
        rotation = np.array(pose["rotation"]).reshape(3, 3)
        np.testing.assert_allclose(rotation, np.array(wanted.rotation), rtol=0.0, atol=within)
