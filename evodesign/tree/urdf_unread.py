"""What a URDF says that the reader does not know, so that nothing is passed over in silence.

`READ` lists all elements and attributes that become part of a tree, `HARMLESS` those which say nothing about
places, masses, shapes, axes or limits: colours, sensors, controllers, simulators' contacts. Whatever else
stands in a file is told. Of what is harmless, `<gazebo>` may hold springs, joints and weightlessness.

Source: wiki.ros.org/urdf/XML; URDF 1.1 and 1.2 of urdfdom; gazebosim.org, SDFormat extensions to URDF.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from lxml import etree

from evodesign.errors import ModelError, listed, shortened

READ: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "robot": (("link", "joint"), ("name", "version")),
    "link": (("inertial", "visual", "collision"), ("name", "type")),
    "inertial": (("origin", "mass", "inertia"), ()),
    "visual": (("origin", "geometry"), ("name",)),
    "collision": (("origin", "geometry"), ("name",)),
    "geometry": (("box", "cylinder", "sphere", "capsule", "mesh"), ("name",)),
    "joint": (
        ("origin", "parent", "child", "axis", "limit", "mimic", "dynamics"),
        ("name", "type", "dont_collapse"),
    ),
    "origin": ((), ("xyz", "rpy", "quat_xyzw")),
    "mass": ((), ("value",)),
    "inertia": ((), ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")),
    "box": ((), ("size",)),
    "cylinder": ((), ("radius", "length")),
    "capsule": ((), ("radius", "length")),
    "sphere": ((), ("radius",)),
    "mesh": ((), ("filename", "scale")),
    "parent": ((), ("link",)),
    "child": ((), ("link",)),
    "axis": ((), ("xyz",)),
    "limit": ((), ("lower", "upper", "effort", "velocity")),
    "mimic": ((), ("joint", "multiplier", "offset")),
    "dynamics": ((), ("damping", "friction")),
}
"""Children and attributes by element."""

LOOKS = ("material", "verbose", "contact_coefficients")
HARMLESS: Mapping[str, tuple[str, ...]] = {
    "robot": ("material", "gazebo", "transmission", "ros2_control", "sensor", "note"),
    "link": ("material", "contact", "collision_checking", "self_filter", "sensor", "surface", "verbose"),
    "visual": LOOKS,
    "collision": LOOKS,
    "joint": ("calibration",),
}

GAZEBO: Mapping[str, tuple[str, ...]] = {
    "joint": (),
    "link": (),
    "springStiffness": ("0", "0.0"),
    "spring_stiffness": ("0", "0.0"),
    "turnGravityOff": ("0", "false"),
    "gravity": ("1", "true"),
}
"""Children of <gazebo> that change what a robot holds, and what they say where they do not."""

EXPRESSION = re.compile(r"\$[({]")
"""How expressions and arguments of xacro begin."""

MOST_KINDS = 20
"""Sentences before the others are counted."""

VERSIONS = ("1", "1.0", "1.1", "1.2")
"""Of URDF, that are known; a file that says none is of version 1.0."""


def refuse_xacro(robot: etree._Element, source: str) -> None:
    """Refuse a file in which xacro's macros or expressions are left where a robot's parts stand.

    Raises:
        ModelError: naming the first of them.
    """
    parts = (each for part in robot if part.tag not in HARMLESS["robot"] for each in part.iter())
    for element in (robot, *parts):
        macro = f"<{tag_of(element)}>" if tag_of(element).startswith("xacro:") else ""
        texts = [text for text in (*element.attrib.values(), element.text or "") if EXPRESSION.search(text)]
        if macro or texts:
            wanted = "a URDF: expand with xacro (xacro FILE > robot.urdf)"
            raise ModelError(source, _place(element), wanted, macro or repr(shortened(texts[0])))


def unread(robot: etree._Element) -> Iterator[str]:
    """A sentence for each kind of element or attribute that is not read, and where it stands.

    Args:
        robot: as parsed, before anything is taken out of it.
    """
    found: dict[str, dict[str, None]] = {}
    for what, where in (*_unknown(robot), *_of_gazebo(robot), *_of_motion(robot)):
        found.setdefault(what, {})[where] = None
    for what in [*found][:MOST_KINDS]:
        yield f"{what} {listed([*found[what]])}"
    if len(found) > MOST_KINDS:
        yield f"not read: {len(found) - MOST_KINDS} more kinds of elements and attributes"
    if robot.get("version", VERSIONS[0]) not in VERSIONS:
        yield f"version {shortened(robot.get('version'))!r} of URDF is not known: read as {VERSIONS[-1]}"


def _unknown(element: etree._Element) -> Iterator[tuple[str, str]]:
    """What is not read of an element and of those below that are, with the link or joint it belongs to."""
    tag = element.tag
    children, attributes = READ[tag]
    fixed = tag == "joint" and element.get("type") == "fixed"
    known_shape = tag != "geometry" or any(child.tag in children for child in element)
    for name in element.attrib:
        if name not in attributes and "XMLSchema-instance" not in name:
            yield f"not read: {shortened(name.rpartition('}')[2])} of <{tag}>:", _owner(element) or tag
    for child in element:
        if child.tag in children:
            if not (fixed and child.tag in ("axis", "limit", "mimic", "dynamics")):
                yield from _unknown(child)
        elif child.tag not in HARMLESS.get(tag, ()) and known_shape:
            named = shortened(child.get("name") or child.get("reference") or "without a name")
            yield f"not read: <{shortened(tag_of(child))}> in <{tag}>:", _owner(element) or named


def _of_gazebo(robot: etree._Element) -> Iterator[tuple[str, str]]:
    for gazebo in robot.findall("gazebo"):
        for child in gazebo:
            without = GAZEBO.get(child.tag)
            if without is not None and (child.text or "").strip().lower() not in without:
                name = gazebo.get("reference") or child.get("name", "")
                yield f"not read: <{child.tag}> in <gazebo>:", shortened(name)


def _of_motion(robot: etree._Element) -> Iterator[tuple[str, str]]:
    """Joints with damping or friction, and origins whose quaternion only URDF 1.1 knows."""
    for dynamics in robot.iterfind("joint/dynamics"):
        if dynamics.getparent().get("type") != "fixed" and any(
            _is_not_zero(dynamics.get(key, "0")) for key in ("damping", "friction")
        ):
            yield "damping and friction of joints are not counted:", _owner(dynamics)
    if robot.get("version", VERSIONS[0]) in VERSIONS[:2]:
        for origin in robot.iter("origin"):
            if origin.get("quat_xyzw"):
                yield (
                    "quat_xyzw is read, which others ignore where a file does not say version 1.1:",
                    _owner(origin),
                )


def _is_not_zero(text: str) -> bool:
    try:
        return float(text) != 0.0
    except ValueError:
        return True


def tag_of(element: etree._Element) -> str:
    """The tag of an element as it stands in the file."""
    name = etree.QName(element).localname if str(element.tag).startswith("{") else str(element.tag)
    return f"{element.prefix}:{name}" if element.prefix else name


def _owner(element: etree._Element) -> str:
    """The name of the link or joint that an element belongs to; empty outside of them."""
    return shortened(_place(element).partition(" ")[2])


def _place(element: etree._Element) -> str:
    """The link or joint that an element belongs to, as a key of messages."""
    while element is not None and element.tag not in ("link", "joint"):
        element = element.getparent()
    return "" if element is None else f"{element.tag} {element.get('name', '')}"
