"""A small robot in MJCF with what files of this form have: defaults, classes, an include, several angles."""

from __future__ import annotations

from pathlib import Path

ARM = """
<mujocoinclude>
  <body name="arm" pos="0 0.2 0.35" euler="20 -10 35" childclass="light">
    <joint name="shoulder_pitch" axis="0 1 0.2" pos="0.01 0 0.02" range="-90 120" actuatorfrcrange="-30 40"/>
    <joint name="shoulder_roll" axis="1 0 0" pos="0 0.03 0.02" range="-20 170" ref="15"/>
    <geom name="arm" fromto="0 0 0 0.02 0.01 -0.3" size="0.04"/>
    <body name="hand" pos="0.02 0.01 -0.3" quat="0.9 0.1 -0.3 0.2">
      <joint name="wrist" type="slide" axis="0 0 -1" range="-0.05 0.08"/>
      <geom type="ellipsoid" size="0.03 0.05 0.06" pos="0 0 -0.05" density="700"/>
      <geom name="thumb" type="sphere" size="0.015" pos="0 0.04 -0.03" class="bump"/>
      <site name="palm" pos="0 0 -0.06" axisangle="1 1 0 40"/>
      <body name="finger" pos="0 0 -0.1">
        <joint name="finger" axis="1 0 0" pos="0 0 0.01" ref="5"/>
        <geom size="0.01" fromto="0 0 0 0 0 -0.05"/>
      </body>
      <body name="nail" pos="0.01 0 -0.1">
        <joint name="nail" axis="0 1 0"/>
        <geom size="0.008" fromto="0 0 0 0 0 -0.02"/>
      </body>
    </body>
  </body>
</mujocoinclude>"""

ROBOT = """
<mujoco model="small">
  <compiler angle="degree" eulerseq="XYZ"/>
  <default>
    <geom density="500"/>
    <default class="light"><geom type="capsule" density="300"/><joint damping="1"/>
      <default class="bump"><geom contype="0" conaffinity="0" group="1" mass="0.05"/></default>
    </default>
    <default class="drawn"><geom type="mesh" contype="0" conaffinity="0" group="2" mass="0"/></default>
    <default class="touched"><geom group="3"/></default>
  </default>
  <asset>
    <mesh name="wedge" vertex="0 0 0  0.2 0 0  0 0.1 0  0 0 0.3" scale="1 -2 1"/>
  </asset>
  <worldbody>
    <geom type="plane" size="1 1 0.1"/>
    <body name="trunk" pos="0.3 0.1 0.8" xyaxes="0.9 0.1 0 -0.1 0.9 0.1">
      <freejoint name="root"/>
      <inertial mass="9" pos="0.01 0.02 0.15" fullinertia="0.3 0.25 0.1 0.02 -0.01 0.03"/>
      <geom name="drawn" class="drawn" mesh="wedge" pos="0.1 0 0" euler="0 0 90"/>
      <geom name="touched" class="touched" type="box" size="0.1 0.15 0.2" pos="0 0 0.2"/>
      <geom name="plate" class="touched" type="cylinder" size="0.05 0.01" group="0"/>
      <include file="arm.xml"/>
      <body name="spinner" pos="0 -0.2 0.3" gravcomp="1">
        <joint name="spin" axis="0 0 1"/>
        <geom type="cylinder" size="0.03 0.1" pos="0 0 0.1"/>
        <geom type="box" size="0.02 0.03 0.04" pos="0.05 0 0.2" zaxis="1 0 1"/>
      </body>
      <body name="camera mount" pos="0 0 0.45"><geom type="box" size="0.01 0.02 0.03"/></body>
    </body>
    <body name="crate" pos="2 0 0"><freejoint/><geom type="box" size="0.1 0.1 0.1"/></body>
  </worldbody>
  <equality>
    <joint name="curl" joint1="finger" joint2="wrist" polycoef="0.1 2 0 0 0"/>
    <joint joint1="nail" polycoef="0.2 0 0 0 0"/>
    <connect name="loop" body1="spinner" body2="arm" anchor="0 0 0"/>
  </equality>
  <actuator>
    <motor joint="shoulder_pitch" gear="5" ctrllimited="true" ctrlrange="-7 7"/>
    <motor joint="shoulder_roll" gear="-5" ctrllimited="true" ctrlrange="-7 8"/>
    <position joint="wrist" kp="100" gear="2" forcelimited="true" forcerange="-25 30"/>
    <position joint="wrist" kp="100"/>
    <general joint="spin" gear="2" gainprm="3" ctrllimited="true" ctrlrange="-1 1"/>
  </actuator>
</mujoco>"""


def write_small_mjcf(folder: Path) -> Path:
    """The robot's file, with the one that it includes beside it."""
    (folder / "arm.xml").write_text(ARM)
    (folder / "small.xml").write_text(ROBOT)
    return folder / "small.xml"
