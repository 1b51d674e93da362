"""What a film draws of links whose shapes are meshes, which MuJoCo's model leaves out."""

from __future__ import annotations

import mujoco

from evodesign.simulation.film import _unseen

LINKS = """
<mujoco><worldbody>
  <body name="mesh"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/><geom size="0.1" group="3"/>
    <body name="shape"><geom size="0.1"/>
      <body name="hand"><geom size="0.1"/></body>
    </body>
  </body>
</worldbody></mujoco>
"""


def test_a_stick_goes_from_a_link_of_which_nothing_is_drawn_to_each_link_on_it() -> None:
    """A sole, in a group that is not drawn, is nothing that is seen."""
    model = mujoco.MjModel.from_xml_string(LINKS)
    assert [model.body(link).name for link in _unseen(model)] == ["shape"]
