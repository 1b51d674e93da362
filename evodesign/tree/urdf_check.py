"""URDF text vetted element by element, so that every complaint is a sentence that names file and element.

What passes holds nothing but links and joints, and of these only what a tree is made of: places, masses,
shapes, axes and limits, all figures finite and within bounds, and no part twice. Colours, sensors, simulator
tags, and the axes and limits of fixed joints are stripped; shapes of a size of zero or of an unknown kind,
and all else that is not read (`urdf_unread`), with a note. Nothing is fetched: documents with a DTD (and so
entities) are refused, and a mesh's file is not opened here.

Beyond 300 lines: one check for each element of a URDF.

Source: wiki.ros.org/urdf/XML (link, joint).
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from lxml import etree

from evodesign.errors import ModelError, on_one_line, shortened
from evodesign.tree.model import JointKind
from evodesign.tree.urdf_unread import refuse_xacro, tag_of, unread


@dataclass(frozen=True, slots=True)
class Figures:
    """What an attribute may hold: so many finite numbers within bounds."""

    count: int = 1
    low: float = -math.inf
    high: float = math.inf
    required: bool = True

    def __str__(self) -> str:
        noun = "a finite number" if self.count == 1 else f"{self.count} finite numbers"
        low = f" from {self.low:g}" if math.isfinite(self.low) else ""
        high = f" to {self.high:g}" if math.isfinite(self.high) else ""
        return noun + low + high


SIZE = Figures(low=1e-6, high=1e3)
"""A dimension [m]: beyond a micrometre and a kilometre lies a mistaken unit, and a volume of zero."""
MASS = Figures(low=0.0, high=1e6)
"""A mass [kg]: up to a thousand tonnes."""
MOMENT = Figures(low=-1e9, high=1e9)
"""An entry of an inertia tensor [kg m^2]."""
POSITION, ANGLES = Figures(3, -1e3, 1e3, required=False), Figures(3, -1e3, 1e3, required=False)
"""A point [m] and roll, pitch, yaw [rad]."""
AXIS = Figures(3, -1e3, 1e3, required=False)
"""A direction, of any length that can be divided by."""
OPTIONAL, NOT_NEGATIVE = Figures(required=False), Figures(low=0.0, required=False)

ATTRIBUTES: Mapping[str, Mapping[str, Figures]] = {
    "origin": {"xyz": POSITION, "rpy": ANGLES, "quat_xyzw": Figures(4, -1e3, 1e3, required=False)},
    "mass": {"value": MASS},
    "inertia": dict.fromkeys(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), MOMENT),
    "box": {"size": Figures(3, SIZE.low, SIZE.high)},
    "cylinder": {"radius": SIZE, "length": SIZE},
    "capsule": {"radius": SIZE, "length": SIZE},
    "sphere": {"radius": SIZE},
    "mesh": {"scale": Figures(3, -1e3, 1e3, required=False)},
    "mimic": {"multiplier": OPTIONAL, "offset": OPTIONAL},
    "axis": {"xyz": AXIS},
    "limit": {"lower": OPTIONAL, "upper": OPTIONAL, "effort": NOT_NEGATIVE, "velocity": NOT_NEGATIVE},
}
SHAPES = ("box", "cylinder", "sphere", "capsule", "mesh")
NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
"""What urdfdom takes for a number; Python takes `1_4.5`, too."""
SHORTEST = 1e-6
"""An <axis> of fewer than this length has no direction, a quaternion no rotation."""
LONGEST_NAME, LONGEST_NOTE, LONGEST_FILE_NAME, LONGEST_TAG = 200, 400, 1_000, 100_000
"""Letters of a name, of a note, of a path, and between the beginnings of two elements."""
MOST_LINKS, MOST_ELEMENTS = 5_000, 100_000
"""A robot of 100 links has 1,500 elements."""


def checked_urdf(text: str, source: str, notes: list[str]) -> etree._Element:
    """The <robot> element of a URDF, with only such elements left as were checked.

    Args:
        text: the URDF.
        source: the file's name, for messages.
        notes: takes a sentence for each shape that is left out, and the file's own.
    Returns:
        Links and joints in file order, their numbers as the shortest text that reads back to the same
        double. A mesh may stand where a shape does.
    Raises:
        ModelError: the text is not XML or not a URDF; says where and why. Whether the links form a tree is
            for `model.Tree` to say.
    """
    root = _parsed(text, source)
    _check(root, source, notes)
    return root


def _parsed(text: str, source: str) -> etree._Element:
    tags = text.split("<")
    elements = sum(not tag.startswith(("/", "!", "?")) for tag in tags) - 1
    if elements > MOST_ELEMENTS:
        raise ModelError(source, "", f"a URDF file of at most {MOST_ELEMENTS} elements", f"{elements}")
    if max(map(len, tags)) > LONGEST_TAG:
        raise ModelError(source, "", f"elements of at most {LONGEST_TAG} letters", "a longer one")
    parser = etree.XMLParser(
        encoding="utf-8",  # whatever the declaration said: the text is decoded already
        resolve_entities=False,
        no_network=True,
        huge_tree=False,
        recover=True,  # what else than a prefix without its xmlns is wrong is refused below
        remove_comments=True,
        remove_pis=True,
    )
    try:
        root = etree.fromstring(text.encode("utf-8", "surrogatepass"), parser)
    except etree.XMLSyntaxError as error:  # nothing in it
        raise ModelError(source, "", "a URDF file", f"text that is not XML: {error.msg}") from error
    faults = [each for each in parser.error_log if each.domain_name != "NAMESPACE"]
    if faults:
        found = f"text that is not XML: {faults[0].message}, line {faults[0].line}"
        raise ModelError(source, "", "a URDF file", found)
    if root.getroottree().docinfo.doctype:
        raise ModelError(source, "", "a URDF file without a DTD", "a DOCTYPE declaration")
    return root


def _check(root: etree._Element, source: str, notes: list[str]) -> None:
    """Refuse what cannot be read, and strip what is not, so that only checked elements remain."""
    if root.tag != "robot":
        raise ModelError(
            source, "", "<robot> (URDF) or <mujoco> (MJCF) as the outermost element", f"<{root.tag}>"
        )
    _check_name(root, source)
    count = len(root.findall("link"))
    if not 0 < count <= MOST_LINKS:
        raise ModelError(source, "robot", f"links, at most {MOST_LINKS}", f"{count or 'none'}")
    refuse_xacro(root, source)
    notes += [on_one_line(shortened(note.get("text", ""), LONGEST_NOTE)) for note in root.findall("note")]
    notes += map(on_one_line, unread(root))
    _strip(root, ("link", "joint"))
    for element in root:
        _check_name(element, source)
        if element.tag == "link":
            _check_link(element, source, notes)
        else:
            _check_joint(element, source)
        for part in element.iter(*ATTRIBUTES):
            _check_figures(part, source)
    joints = {joint.get("name") for joint in root.findall("joint")}
    for joint in root.findall("joint"):
        _check_motion(joint, source)
        for mimic in joint.findall("mimic"):
            followed = mimic.get("joint", "")
            if followed not in joints or followed == joint.get("name"):
                wanted = "the name of another joint"
                raise ModelError(source, f"{_key(mimic)}.joint", wanted, _quoted(followed))


def _check_name(element: etree._Element, source: str) -> None:
    name = element.get("name", "")
    if name and name.isprintable() and len(name) <= LONGEST_NAME:
        return
    key = f"{element.tag if element.getparent() is None else _indexed(element)}.name"
    if not name:
        raise ModelError(source, key, "a name", "nothing")
    raise ModelError(source, key, f"a name on one line, of at most {LONGEST_NAME} letters", _quoted(name))


def _check_once(element: etree._Element, tags: Iterable[str], source: str) -> None:
    """Refuse parts that stand twice: readers differ on which one counts."""
    for tag in tags:
        found = len(element.findall(tag))
        if found > 1:
            raise ModelError(source, f"{_key(element)}.{tag}", f"one <{tag}>", str(found))


def _check_link(link: etree._Element, source: str, notes: list[str]) -> None:
    _strip(link, ("inertial", "visual", "collision"))
    _check_once(link, ("inertial",), source)
    for inertial in link.findall("inertial"):
        _check_once(inertial, ("origin", "mass", "inertia"), source)
        for tag in ("mass", "inertia"):
            if inertial.find(tag) is None:
                raise ModelError(source, f"{_key(inertial)}.{tag}", f"<{tag}>", "nothing")
        _strip(inertial, ("origin", "mass", "inertia"))
    for look in [*link.findall("visual"), *link.findall("collision")]:
        _check_once(look, ("origin", "geometry"), source)
        inside = [shape for geometry in look.findall("geometry") for shape in geometry]
        shapes = [shape for shape in inside if shape.tag in SHAPES] or inside[:1]
        if len(shapes) != 1:
            found = shortened(", ".join(f"<{tag_of(shape)}>" for shape in shapes)) or "nothing"
            wanted = "one <box>, <cylinder>, <sphere>, <capsule> or <mesh>"
            raise ModelError(source, f"{_key(look)}.geometry", wanted, found)
        fault = _fault(shapes[0])
        if fault:
            notes.append(f"link {link.get('name')}: a {look.tag} is left out, {fault}")
            link.remove(look)
            continue
        if shapes[0].tag == "mesh":
            _check_file(shapes[0], source)
        _strip(look, ("origin", "geometry"))
        _strip(look.find("geometry"), (shapes[0].tag,))


def _fault(shape: etree._Element) -> str:
    """Why a shape cannot be used though the file can be; nothing if it can."""
    if shape.tag not in SHAPES:
        return f"whose <{shortened(tag_of(shape))}> is no box, cylinder, sphere, capsule or mesh"
    sizes = [number for name in ("size", "radius", "length") for number in _numbers(shape.get(name, ""))]
    return "whose size is zero" if 0.0 in sizes else ""


def _check_file(mesh: etree._Element, source: str) -> None:
    name = mesh.get("filename", "")
    if not name or not name.isprintable() or len(name) > LONGEST_FILE_NAME:
        wanted = f"the name of a file, of at most {LONGEST_FILE_NAME} letters"
        raise ModelError(source, f"{_key(mesh)}.filename", wanted, _quoted(name) if name else "nothing")


def _check_joint(joint: etree._Element, source: str) -> None:
    kind = joint.get("type")
    if kind not in list(JointKind):
        found = _quoted(kind) if kind else "nothing"
        raise ModelError(source, f"{_key(joint)}.type", "fixed, revolute, continuous or prismatic", found)
    for role in ("parent", "child"):
        element = joint.find(role)
        if element is None or not element.get("link"):
            raise ModelError(source, f"{_key(joint)}.{role}", "the name of a link", "nothing")
    parts: tuple[str, ...] = ("origin", "parent", "child")
    if kind != JointKind.FIXED:
        parts += ("axis", "limit", "mimic")
    _check_once(joint, parts, source)
    _strip(joint, parts)


def _check_figures(element: etree._Element, source: str) -> None:
    for name, figures in ATTRIBUTES[element.tag].items():
        text = element.get(name)
        if text is None and not figures.required:
            continue
        numbers = _numbers(text or "")
        fits = len(numbers) == figures.count and all(
            figures.low <= number <= figures.high for number in numbers
        )
        if not fits or not all(map(math.isfinite, numbers)):
            found = "nothing" if text is None else _quoted(text)
            raise ModelError(source, f"{_key(element)}.{name}", str(figures), found)
        element.set(name, " ".join(map(repr, numbers)))
    if element.get("quat_xyzw") is not None:
        _check_quaternion(element, source)


def _check_quaternion(origin: etree._Element, source: str) -> None:
    key, text = f"{_key(origin)}.quat_xyzw", origin.get("quat_xyzw")
    if origin.get("rpy") is not None:
        raise ModelError(source, key, "either rpy or quat_xyzw", "both")
    if math.hypot(*_numbers(text)) < SHORTEST:
        raise ModelError(source, key, "a rotation", _quoted(text))


def _check_motion(joint: etree._Element, source: str) -> None:
    """Axis and limits of a joint whose figures are known to be numbers."""
    axis, limit = joint.find("axis"), joint.find("limit")
    if axis is not None and math.hypot(*_numbers(axis.get("xyz", "1 0 0"))) < SHORTEST:
        raise ModelError(source, f"{_key(axis)}.xyz", "a direction", _quoted(axis.get("xyz", "")))
    if joint.get("type") not in (JointKind.REVOLUTE, JointKind.PRISMATIC):
        return
    if limit is None:
        raise ModelError(source, f"{_key(joint)}.limit", "<limit>", "nothing")
    lower, upper = (float(limit.get(name, "0")) for name in ("lower", "upper"))
    if lower > upper:
        raise ModelError(source, f"{_key(limit)}.lower", f"at most the upper limit {upper!r}", repr(lower))


def _numbers(text: str) -> list[float]:
    """The numbers of an attribute; none when a word is not a number."""
    words = text.split()
    return [float(word) for word in words] if all(map(NUMBER.fullmatch, words)) else []


def _quoted(text: str) -> str:
    """A piece of the file in a message: on one line, and not a page of it."""
    return repr(shortened(text))


def _strip(element: etree._Element, tags: Iterable[str]) -> None:
    for child in reversed(element):
        if child.tag not in tags:
            element.remove(child)


def _key(element: etree._Element) -> str:
    """Where an element stands, such as `link chest.visual[2].box`."""
    if element.getparent().tag == "robot":
        return f"{element.tag} {element.get('name')}"
    if element.tag == "geometry":
        return _key(element.getparent())
    return f"{_key(element.getparent())}.{_indexed(element)}"


def _indexed(element: etree._Element) -> str:
    brothers = element.getparent().findall(element.tag)
    return f"{element.tag}[{brothers.index(element) + 1}]" if len(brothers) > 1 else str(element.tag)
