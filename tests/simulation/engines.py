"""The engines that tests are repeated with."""

from __future__ import annotations

import pytest

from evodesign.simulation.installed import EngineName

ENGINES = [EngineName.MUJOCO, pytest.param(EngineName.DRAKE, marks=pytest.mark.needs_drake)]
SLOW_IN_DRAKE = [
    EngineName.MUJOCO,
    pytest.param(EngineName.DRAKE, marks=[pytest.mark.needs_drake, pytest.mark.slow]),
]
"""Where whole motions are simulated; `simulation.test_engines` and a push on the command line are quick."""
