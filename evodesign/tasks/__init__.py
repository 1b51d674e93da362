"""What robot and person do with the load. A new kind is a file here and its name in `Task`."""

from __future__ import annotations

from evodesign.tasks.base import Record, TaskRecord
from evodesign.tasks.hold import Hold

__all__ = ["Hold", "Record", "Task", "TaskRecord"]

Task = Hold
"""Every kind of task, told apart by its `kind`: a union as soon as there is a second one."""
