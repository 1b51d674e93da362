"""How deep bodies are in each other, by the benchmark that shares nothing with the check."""

from __future__ import annotations

from typing import Any

import coal
import numpy as np
import pytest
import trimesh

from benchmarks.independent_overlaps import overlaps

IDENTITY = np.eye(3)


def mesh(sides: tuple[float, float, float]) -> Any:
    box = trimesh.creation.box(sides)
    found = coal.BVHModelOBBRSS()
    found.beginModel(len(box.faces), len(box.vertices))
    for face in box.faces:
        found.addTriangle(*box.vertices[face])
    found.endModel()
    return found


def depth(one: Any, other: Any, place: tuple[float, float, float]) -> float:
    placed = [("one", one, coal.Transform3s(IDENTITY, np.zeros(3)))]
    others = [("other", other, coal.Transform3s(IDENTITY, np.array(place)))]
    return overlaps(placed, others).get(("one", "other"), 0.0)


@pytest.mark.parametrize("other", [mesh((0.1, 0.1, 0.1)), coal.Box(0.1, 0.1, 0.1), coal.Sphere(0.05)])
def test_meshes_are_as_deep_in_other_bodies_as_they_must_be_moved(other: Any) -> None:
    one = mesh((0.1, 0.1, 0.1))
    assert depth(one, other, (0.098, 0.0, 0.0)) == pytest.approx(0.002, abs=2e-4)
    assert depth(one, other, (0.102, 0.0, 0.0)) == 0.0


def test_a_mesh_within_another_one_is_found_though_no_triangles_cross() -> None:
    large, small = mesh((0.1, 0.1, 0.1)), mesh((0.02, 0.02, 0.02))
    assert depth(large, small, (0.03, 0.0, 0.0)) == pytest.approx(0.03, abs=2e-4)
    assert depth(small, large, (0.03, 0.0, 0.0)) == pytest.approx(0.03, abs=2e-4)
