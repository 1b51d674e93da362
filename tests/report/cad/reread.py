"""STEP files read back: by Open CASCADE's own reader, with names and places."""

from __future__ import annotations

import io
from typing import Any, NamedTuple

import numpy as np
from OCP.BRepGProp import BRepGProp
from OCP.collections import Sequence_TDF_Label
from OCP.GProp import GProp_GProps
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.XCAFDoc import XCAFDoc_DocumentTool, XCAFDoc_ShapeTool


class Part(NamedTuple):
    """A product of a STEP file: its body in mm, and its place in the assembly, 4 x 4 [mm]."""

    body: Any
    place: np.ndarray


def parts_in(content: bytes) -> dict[str, Part]:
    """The products of a STEP file by name: those of the assembly, or the one that it holds."""
    reader, document = STEPCAFControl_Reader(), TDocStd_Document(TCollection_ExtendedString("BinXCAF"))
    reader.SetNameMode(True)
    reader.ReadStream("file", io.BytesIO(content))
    assert reader.Transfer(document)
    shapes, free = XCAFDoc_DocumentTool.ShapeTool_s(document.Main()), Sequence_TDF_Label()
    shapes.GetFreeShapes(free)
    (top,) = (free.Value(number) for number in range(1, free.Length() + 1))
    labels = Sequence_TDF_Label()
    if not XCAFDoc_ShapeTool.GetComponents_s(top, labels, False):
        return {name_of(top): Part(XCAFDoc_ShapeTool.GetShape_s(top), np.eye(4))}
    found = {}
    for label in (labels.Value(number) for number in range(1, labels.Length() + 1)):
        product = type(label)()
        XCAFDoc_ShapeTool.GetReferredShape_s(label, product)
        assert name_of(product) not in found
        move = XCAFDoc_ShapeTool.GetLocation_s(label).Transformation()
        rows = [[move.Value(i, j) for j in (1, 2, 3, 4)] for i in (1, 2, 3)]
        found[name_of(product)] = Part(
            XCAFDoc_ShapeTool.GetShape_s(product), np.array([*rows, [0.0, 0.0, 0.0, 1.0]])
        )
    return found


def name_of(label: Any) -> str:
    name = TDataStd_Name()
    assert label.FindAttribute(TDataStd_Name.GetID_s(), name)
    return str(name.Get().ToExtString())


def measured(body: Any) -> tuple[float, np.ndarray, np.ndarray]:
    """Volume [m^3], centre [m], and inertia of a density of 1 kg/m^3 about the centre [kg m^2]."""
    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(body, found)
    center, matrix = found.CentreOfMass(), found.MatrixOfInertia()
    rows = [[matrix.Value(i, j) for j in (1, 2, 3)] for i in (1, 2, 3)]
    return found.Mass() * 1e-9, 1e-3 * np.array([center.X(), center.Y(), center.Z()]), 1e-15 * np.array(rows)


def explored(body: Any, kind: TopAbs_ShapeEnum) -> list[Any]:
    """Parts of a kind that a body is made of."""
    found, each = [], TopExp_Explorer(body, kind)
    while each.More():
        found.append(each.Current())
        each.Next()
    return found


def solids_in(body: Any) -> list[Any]:
    """The solids of a body."""
    return explored(body, TopAbs_ShapeEnum.TopAbs_SOLID)
