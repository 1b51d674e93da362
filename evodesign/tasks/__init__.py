"""What robot and person do with the load. A new kind is a file here and its name in `Task`."""

from __future__ import annotations

from evodesign.tasks.base import Record, TaskRecord
from evodesign.tasks.hold import Hold
from evodesign.tasks.lift import Lift

__all__ = ["Hold", "Lift", "Record", "Task", "TaskRecord"]

Task = Hold | Lift
"""Every kind of task, told apart by its `kind`."""
