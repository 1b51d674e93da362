"""Open CASCADE, and the only module that knows it: bodies, their measures, STEP files and triangles.

Bodies are in millimetres, as workshops have them; everything that goes in or comes out is SI but the files.
A hollow body is its outer shape less that within its wall (`Solid.wall`), so it holds a closed cavity.

Beyond 300 lines: one library behind one door; bodies, measures, files and triangles share nothing but it.

Source: Open CASCADE Technology, user guides "Modeling Algorithms" and "STEP Translator"; ISO 10303-214.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import count
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_Transform
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeSphere
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt, gp_Trsf
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.Message import Message
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_StepModelType
from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Compound
from OCP.XCAFDoc import XCAFDoc_DocumentTool

from evodesign.body.inertia import Inertia
from evodesign.body.placement import Placement
from evodesign.body.shape import Box, Cylinder, Shape, Solid, Sphere
from evodesign.errors import on_one_line

Body = Any
"""A TopoDS_Shape, in millimetres."""

MILLIMETRES: Final = 1000.0
"""In a metre."""

FACET_ANGLE: Final = 0.06
"""Largest angle [rad] between facets of a round body: a ball's volume is then right to 7e-4."""

FACET_DISTANCE: Final = 0.5
"""Largest distance [mm] of facets from a body; the angle is stricter for what a link measures."""

WELD: Final = 1e-5
"""Vertices nearer to each other [mm] are one."""

USE: Final = "NEXT_ASSEMBLY_USAGE_OCCURRENCE"
USE_OF_PART: Final = re.compile(rf"{USE}\('\d+'((?:'(?:[^']|'')*'|[^';])*);")
STRING_OR_SPACE: Final = re.compile(r"('(?:[^']|'')*')|\s+")
"""What STEP files say of a part in an assembly, and what of it are strings and line ends."""

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Product:
    """A part of a STEP file.

    Args:
        name: of the product.
        body: in its own frame.
        place: in the assembly's frame.
    """

    name: str
    body: Body
    place: Placement


def body_of(solid: Solid) -> Body:
    """A solid in its link's frame, hollow where it has a wall."""
    return placed(solid_body(solid.shape, solid.wall), solid.link_from_solid)


def outer_body(solid: Solid) -> Body:
    """What a solid encloses, in its link's frame."""
    return placed(solid_body(solid.shape, None), solid.link_from_solid)


def solid_body(shape: Shape, wall: float | None) -> Body:
    """A shape about its own centre.

    Args:
        shape: of numbers.
        wall: thickness [m]; None for a full one, as is one whose wall leaves no cavity.
    """
    outer = _primitive(shape)
    if wall is None or shape.inside(wall).least_width <= 0.0:
        return outer
    return cut(outer, [_primitive(shape.inside(wall))])


def _primitive(shape: Shape) -> Body:
    """A full body, its centre in the origin; a cylinder stands along z."""
    match shape:
        case Sphere(radius):
            return BRepPrimAPI_MakeSphere(_mm(radius)).Shape()
        case Cylinder(radius, length):
            foot = gp_Ax2(gp_Pnt(0.0, 0.0, -_mm(length) / 2.0), gp_Dir(0.0, 0.0, 1.0))
            return BRepPrimAPI_MakeCylinder(foot, _mm(radius), _mm(length)).Shape()
        case Box():
            x, y, z = (_mm(side) for side in shape.sides)
            return BRepPrimAPI_MakeBox(gp_Pnt(-x / 2.0, -y / 2.0, -z / 2.0), x, y, z).Shape()


def _mm(length: float) -> float:
    return float(length) * MILLIMETRES


def together(bodies: Sequence[Body]) -> Body:
    """Bodies as one part: the body itself, or a compound of several, which stay apart."""
    if len(bodies) == 1:
        return bodies[0]
    builder, compound = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(compound)
    for body in bodies:
        builder.Add(compound, body)
    return compound


def line(length: float) -> Body:
    """A straight edge of a length [m] along z, its middle in the origin."""
    half = _mm(length) / 2.0
    return BRepBuilderAPI_MakeEdge(gp_Pnt(0.0, 0.0, -half), gp_Pnt(0.0, 0.0, half)).Edge()


def placed(body: Body, outer_from_inner: Placement) -> Body:
    """A body in an outer frame, its geometry moved: one that had a location would be an assembly in STEP."""
    return BRepBuilderAPI_Transform(body, _move(outer_from_inner), True).Shape()


def _move(place: Placement) -> gp_Trsf:
    move, (x, y, z) = gp_Trsf(), place.translation
    rows = [(*map(float, row), _mm(offset)) for row, offset in zip(place.rotation, (x, y, z), strict=True)]
    move.SetValues(*rows[0], *rows[1], *rows[2])
    return move


def volume(body: Body) -> float:
    """Volume [m^3], by integrals over the faces."""
    return float(_integrals(body).Mass()) / MILLIMETRES**3


def inertia(body: Body, density: float) -> Inertia:
    """Mass, centre and inertia of a body of uniform density, by integrals over its faces.

    Args:
        body: in some frame.
        density: [kg/m^3].
    """
    found = _integrals(body)
    center, matrix = found.CentreOfMass(), found.MatrixOfInertia()
    rows = [tuple(density * matrix.Value(i, j) / MILLIMETRES**5 for j in (1, 2, 3)) for i in (1, 2, 3)]
    place = tuple(each / MILLIMETRES for each in (center.X(), center.Y(), center.Z()))
    mass = density * found.Mass() / MILLIMETRES**3
    return Inertia(mass, place, (rows[0], rows[1], rows[2]))


def _integrals(body: Body) -> Any:
    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(body, found)
    return found


def united_volume(bodies: Sequence[Body]) -> float:
    """Volume [m^3] of the union of bodies, where what several share counts once."""
    return volume(united(bodies))


def shared_volume(one: Body, other: Body) -> float:
    """Volume [m^3] that two bodies have in common."""
    return volume(common(one, other))


def common(one: Body, other: Body) -> Body:
    """What two bodies have in common."""
    return BRepAlgoAPI_Common(one, other).Shape()


def cut(body: Body, tools: Iterable[Body]) -> Body:
    """A body less others.

    Raises:
        RuntimeError: Open CASCADE cannot cut it.
    """
    return _sound(reduce(lambda left, tool: BRepAlgoAPI_Cut(left, tool).Shape(), tools, body))


def united(bodies: Sequence[Body]) -> Body:
    """The union of bodies, where what several share counts once.

    Raises:
        RuntimeError: Open CASCADE cannot unite them.
    """
    return _sound(reduce(lambda one, other: BRepAlgoAPI_Fuse(one, other).Shape(), bodies))


def pieces(body: Body) -> list[Body]:
    """The solids that a body is made of."""
    found, each = [], TopExp_Explorer(body, TopAbs_ShapeEnum.TopAbs_SOLID)
    while each.More():
        found.append(each.Current())
        each.Next()
    return found


def _sound(body: Body) -> Body:
    """A body whose faces close it; one of a single solid as that, not as a compound of it."""
    if not BRepCheck_Analyzer(body).IsValid():
        raise RuntimeError("Open CASCADE cannot cut or unite bodies: faces of what comes out do not close it")
    found = pieces(body)
    return found[0] if len(found) == 1 else body


def triangles(body: Body) -> tuple[Array, NDArray[np.int64]]:
    """The surface of a body as triangles.

    Returns:
        Vertices [m], shape (n, 3); and triangles as indices of vertices, shape (m, 3), counter-clockwise
        seen from outside. Faces share vertices, and none is without area, so the surface is closed.
    """
    BRepMesh_IncrementalMesh(body, FACET_DISTANCE, False, FACET_ANGLE)
    vertices: list[tuple[float, float, float]] = []
    corners: list[tuple[int, int, int]] = []
    faces = TopExp_Explorer(body, TopAbs_ShapeEnum.TopAbs_FACE)
    while faces.More():
        face, place, first = TopoDS.Face(faces.Current()), TopLoc_Location(), len(vertices) - 1
        mesh = BRep_Tool.Triangulation_s(face, place)
        move = place.Transformation()
        vertices += [mesh.Node(number).Transformed(move).Coord() for number in range(1, mesh.NbNodes() + 1)]
        inwards = face.Orientation() == TopAbs_Orientation.TopAbs_REVERSED
        for number in range(1, mesh.NbTriangles() + 1):
            a, b, c = mesh.Triangle(number).Get()
            corners.append(
                (first + a, first + c, first + b) if inwards else (first + a, first + b, first + c)
            )
        faces.Next()
    return _welded(np.array(vertices), np.array(corners, np.int64))


def _welded(vertices: Array, corners: NDArray[np.int64]) -> tuple[Array, NDArray[np.int64]]:
    """Triangles of faces that share the vertices of their common edges; vertices in mm, returned in m."""
    grid, of_vertex = np.unique(np.round(vertices / WELD).astype(np.int64), axis=0, return_inverse=True)
    joined = of_vertex.reshape(-1)[corners]
    a, b, c = joined.T
    welded: Array = grid.astype(np.float64) * (WELD / MILLIMETRES)
    return welded, joined[(a != b) & (b != c) & (c != a)].astype(np.int64)


def step_file(name: str, products: Sequence[Product], stamp: str) -> bytes:
    """Products as a STEP file (AP214, mm): one by itself in its own frame, or an assembly of several.

    Args:
        name: of the assembly; of a single product its own is taken.
        products: at least one, of different names, none of which shares its body with another.
        stamp: time that the file bears, ISO 8601; equal products and stamps give equal files.
    Raises:
        RuntimeError: Open CASCADE cannot write them.
    """
    _silence()
    document = TDocStd_Document(TCollection_ExtendedString("BinXCAF"))
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    assembly = shapes.NewShape() if len(products) > 1 else None
    for product in products:
        label = shapes.AddShape(product.body, False)
        _name(label, product.name)
        if assembly is not None:
            _name(shapes.AddComponent(assembly, label, TopLoc_Location(_move(product.place))), product.name)
    if assembly is not None:
        _name(assembly, name)
        shapes.UpdateAssemblies()
    writer = STEPCAFControl_Writer()
    writer.SetNameMode(True)
    writer.Transfer(document, STEPControl_StepModelType.STEPControl_AsIs)
    _head(writer, name, stamp)
    file = io.BytesIO()
    if writer.WriteStream(file) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise RuntimeError(f"Open CASCADE does not write '{name}'")
    return _numbered(file.getvalue().decode("latin-1")).encode("latin-1")


def _numbered(text: str) -> str:
    """A STEP file whose uses of parts are numbered from 1; Open CASCADE counts on from file to file."""
    numbers = count(1)

    def renumbered(use: re.Match[str]) -> str:
        rest = STRING_OR_SPACE.sub(lambda each: (each[1] or "").replace("\n", ""), use[1])
        return f"{USE}('{next(numbers)}'{rest};"

    return USE_OF_PART.sub(renumbered, text)


def _head(writer: STEPCAFControl_Writer, name: str, stamp: str) -> None:
    """What the file says of itself."""
    head = APIHeaderSection_MakeHeader(writer.ChangeWriter().Model())
    head.SetName(_ascii(name))
    head.SetTimeStamp(_ascii(stamp))
    head.SetAuthorValue(1, _ascii("evodesign"))
    head.SetOrganizationValue(1, _ascii(""))
    head.SetOriginatingSystem(_ascii("evodesign"))


def _ascii(text: str) -> TCollection_HAsciiString:
    return TCollection_HAsciiString(text.encode("ascii", "replace").decode())


def _name(label: Any, name: str) -> None:
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(on_one_line(name), True))


def _silence() -> None:
    """Keep Open CASCADE from telling standard output what it does."""
    messenger = Message.DefaultMessenger_s()
    for printer in list(messenger.Printers()):
        messenger.RemovePrinter(printer)
