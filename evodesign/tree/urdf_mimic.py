"""Where the mimic joints of a URDF are while every joint that moves by itself is at zero.

    q = multiplier q_leader + offset        q_leader = 0 where the leader follows nobody

Leaders may follow others themselves.

Source: wiki.ros.org/urdf/XML/joint (mimic); pinocchio and MuJoCo place such chains likewise.
"""

from __future__ import annotations

from lxml import etree

from evodesign.errors import ModelError


def held_positions(robot: etree._Element, source: str) -> dict[str, float]:
    """Positions [rad or m] of the mimic joints, by name.

    Args:
        robot: of a checked URDF.
        source: the file's name, for messages.
    Raises:
        ModelError: joints follow each other in a ring.
    """
    mimics = {joint.get("name"): joint.find("mimic") for joint in robot.findall("joint")}
    followers = {name: mimic for name, mimic in mimics.items() if mimic is not None}
    held: dict[str, float] = {}
    for name in followers:
        chain = [name]
        while (leader := followers[chain[-1]].get("joint")) in followers and leader not in held:
            if leader in chain:
                wanted = "a leader that does not follow its follower"
                raise ModelError(source, f"joint {name}.mimic.joint", wanted, f"'{leader}', which does")
            chain.append(leader)
        for each in reversed(chain):
            mimic = followers[each]
            slope, offset = float(mimic.get("multiplier", "1")), float(mimic.get("offset", "0"))
            held[each] = slope * held.get(mimic.get("joint"), 0.0) + offset
    return held
