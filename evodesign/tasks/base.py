"""What every kind of task says of itself."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import msgspec


class Record(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Base of all records: immutable, strict, keyword-only."""


class TaskRecord(Record, frozen=True, tag_field="kind"):
    """Base of all kinds of task; its text is short and tells it from others of its kind.

    A program is given the numbers of a task as parameters, so that one program serves all tasks of a kind.

    Attributes:
        PARAMETERS: names of these numbers.
    """

    PARAMETERS: ClassVar[tuple[str, ...]]

    @property
    def name(self) -> str:
        """What tells it from others where the names of quantities do, such as `robot_torque@1.2`."""
        return str(self)

    @property
    def given(self) -> dict[str, float]:
        """The numbers that programs are given, by name."""
        raise NotImplementedError

    @classmethod
    def load_heights(cls, given: Mapping[str, Any]) -> tuple[Any, ...]:
        """Height of the load's centre at each instant [m], from numbers or symbols of the parameters."""
        raise NotImplementedError

    @property
    def heights(self) -> tuple[float, ...]:
        """Height of the load's centre at each instant [m]."""
        return self.load_heights(self.given)

    @property
    def times(self) -> tuple[float, ...]:
        """When each instant is, since the task began [s]; zero where nothing moves."""
        return (0.0,) * len(self.heights)
