"""The engines that tests are repeated with."""

from __future__ import annotations

import pytest

from evodesign.simulation.installed import EngineName

ENGINES = [EngineName.MUJOCO, pytest.param(EngineName.DRAKE, marks=pytest.mark.needs_drake)]
