"""What a person's joints and links are called in tables and figures: `jL5S1_roty` bends the lower back.

These names are the generated person's (`human.body`). A robot's joints keep the names of its URDF.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from evodesign.tree.model import Tree

SPINE = ("bending sideways", "bending forward", "turning")

PLACES: Mapping[str, tuple[str, tuple[str, str, str]]] = {
    "L5S1": ("lower back L5/S1", SPINE),
    "L4L3": ("lower back L4/L3", SPINE),
    "L1T12": ("middle back L1/T12", SPINE),
    "T9T8": ("upper back T9/T8", SPINE),
    "T1C7": ("neck", SPINE),
    "C1Head": ("head", SPINE),
    "C7Shoulder": ("collar bone", ("raising", "turning", "forward")),
    "Shoulder": ("shoulder", ("raising sideways", "turning", "raising forward")),
    "Elbow": ("elbow", ("sideways", "turning", "bending")),
    "Wrist": ("wrist", ("bending", "turning", "sideways")),
    "Hip": ("hip", ("spreading", "bending", "turning")),
    "Knee": ("knee", ("sideways", "bending", "turning")),
    "Ankle": ("ankle", ("tilting sideways", "bending", "turning")),
    "BallFoot": ("ball of the foot", ("sideways", "bending", "turning")),
}
"""Where a joint of the person is, and what it does about x, y and z; at zero the arms point sideways."""

LINKS: Mapping[str, str] = {
    "L5": "spine L5",
    "L3": "spine L3",
    "T12": "spine T12",
    "T8": "chest",
    "ForeArm": "forearm",
}

PERSONS_JOINT = re.compile(r"j(Left|Right)?(\w+?)_rot([xyz])")
PERSONS_LINK = re.compile(
    "(Left|Right)?(Pelvis|L5|L3|T12|T8|Neck|Head|Shoulder|UpperArm|ForeArm|Hand|Palm|UpperLeg|LowerLeg|Foot|Sole|Toe)"
    r"(?:_f\d)?"
)


def in_words(name: str) -> str:
    """What a joint or a link of this name is called; any that is not the person's by its name."""
    joint = PERSONS_JOINT.fullmatch(name)
    if joint and joint[2] in PLACES:
        place, moves = PLACES[joint[2]]
        return f"{(joint[1] or '').lower()} {place}, {moves['xyz'.index(joint[3])]}".strip()
    link = PERSONS_LINK.fullmatch(name)
    if link:
        part = LINKS.get(link[2]) or re.sub(r"(?<=[a-z])(?=[A-Z])", " ", link[2]).lower()
        return f"{(link[1] or '').lower()} {part}".strip()
    return name


def words_of(tree: Tree) -> dict[str, str]:
    """Those of a tree's joints and links whose words are not their name."""
    names = [*(joint.name for joint in tree.joints), *(link.name for link in tree.links)]
    return {name: words for name in names if (words := in_words(name)) != name}
