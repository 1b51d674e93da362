"""Shapes and wrenches as primitives of a Foxglove scene."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

from foxglove_schemas_protobuf.ArrowPrimitive_pb2 import ArrowPrimitive
from foxglove_schemas_protobuf.Color_pb2 import Color
from foxglove_schemas_protobuf.CubePrimitive_pb2 import CubePrimitive
from foxglove_schemas_protobuf.CylinderPrimitive_pb2 import CylinderPrimitive
from foxglove_schemas_protobuf.Pose_pb2 import Pose
from foxglove_schemas_protobuf.Quaternion_pb2 import Quaternion
from foxglove_schemas_protobuf.SceneEntity_pb2 import SceneEntity
from foxglove_schemas_protobuf.SpherePrimitive_pb2 import SpherePrimitive
from foxglove_schemas_protobuf.TextPrimitive_pb2 import TextPrimitive
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3

from evodesign.body.placement import Matrix, Placement, Vector, dot, quaternion_wxyz, scale
from evodesign.body.shape import Box, Cylinder, Shape, Sphere

__all__ = ["COLORS", "add_arrow", "add_shape", "add_text", "orientation", "vector"]

Rgba = tuple[float, float, float, float]

COLORS: Final[Mapping[str, Rgba]] = {
    "robot": (0.23, 0.43, 0.65, 1.0),
    "human": (0.79, 0.55, 0.39, 1.0),
    "load": (0.55, 0.45, 0.33, 1.0),
    "ground force": (0.88, 0.48, 0.00, 1.0),
    "hand force": (0.48, 0.18, 0.55, 1.0),
    "moment": (0.10, 0.55, 0.45, 1.0),
    "text": (0.13, 0.15, 0.18, 1.0),
}

SHAFT, HEAD = 0.015, 0.04
"""Diameters of an arrow [m]; its head is as long as it is wide, or a third of a short arrow."""

LETTERS = 0.07
"""Height of letters [m]."""


def vector(triple: Vector) -> Any:
    """Three numbers as a message."""
    return Vector3(x=triple[0], y=triple[1], z=triple[2])


def orientation(rotation: Matrix) -> Any:
    """A rotation as a message."""
    w, x, y, z = quaternion_wxyz(rotation)
    return Quaternion(x=x, y=y, z=z, w=w)


def add_shape(entity: SceneEntity, shape: Shape, place: Placement, color: str) -> None:
    """Add a shape, placed in the entity's frame."""
    pose, paint = _pose(place), _color(color)
    match shape:
        case Sphere(radius):
            entity.spheres.append(SpherePrimitive(pose=pose, size=vector((2.0 * radius,) * 3), color=paint))
        case Cylinder(radius, length):
            size = vector((2.0 * radius, 2.0 * radius, length))
            straight = {"bottom_scale": 1.0, "top_scale": 1.0}
            entity.cylinders.append(CylinderPrimitive(pose=pose, size=size, color=paint, **straight))
        case Box():
            entity.cubes.append(CubePrimitive(pose=pose, size=vector(shape.sides), color=paint))


def add_arrow(entity: SceneEntity, tail: Vector, way: Vector, color: str) -> None:
    """Add an arrow from a point along a vector [m], both in the entity's frame; none without a length."""
    length = math.hypot(*way)
    if length == 0.0:
        return
    head = min(HEAD, length / 3.0)
    arrow = ArrowPrimitive(
        pose=_pose(Placement(_towards(scale(1.0 / length, way)), tail)),
        shaft_length=length - head,
        shaft_diameter=SHAFT,
        head_length=head,
        head_diameter=HEAD,
        color=_color(color),
    )
    entity.arrows.append(arrow)


def add_text(entity: SceneEntity, place: Vector, text: str) -> None:
    """Add words that face the viewer, at a point of the entity's frame."""
    words = TextPrimitive(
        pose=_pose(Placement(translation=place)),
        billboard=True,
        font_size=LETTERS,
        color=_color("text"),
        text=text,
    )
    entity.texts.append(words)


def _towards(way: Vector) -> Matrix:
    """A rotation that takes x to a unit vector: its columns are the vector and two across."""
    aside: Vector = (0.0, 0.0, 1.0) if abs(way[2]) < 0.9 else (0.0, 1.0, 0.0)
    up = _cross(way, _cross(aside, way))
    up = scale(1.0 / math.sqrt(dot(up, up)), up)
    left = _cross(up, way)
    return tuple(zip(way, left, up, strict=True))  # type: ignore[return-value]


def _cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _pose(place: Placement) -> Any:
    return Pose(position=vector(place.translation), orientation=orientation(place.rotation))


def _color(name: str) -> Any:
    red, green, blue, opacity = COLORS[name]
    return Color(r=red, g=green, b=blue, a=opacity)
