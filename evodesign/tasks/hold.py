"""Holding the load still."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from evodesign.tasks.base import TaskRecord


class Hold(TaskRecord, frozen=True, tag="hold"):
    """The load held still, its centre at a height [m]: one instant."""

    PARAMETERS: ClassVar[tuple[str, ...]] = ("height",)

    height_m: float

    def __str__(self) -> str:
        return f"{self.height_m:g} m"

    @property
    def name(self) -> str:
        """Such as `1.2`."""
        return f"{self.height_m:g}"

    @property
    def given(self) -> dict[str, float]:
        """The height [m]."""
        return {"height": self.height_m}

    @classmethod
    def load_heights(cls, given: Mapping[str, Any]) -> tuple[Any, ...]:
        """The height [m], of the only instant."""
        return (given["height"],)
