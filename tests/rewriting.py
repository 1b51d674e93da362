"""Files written again and again."""

from __future__ import annotations

from pathlib import Path


def write_anew(path: Path, content: bytes) -> None:
    """Write a file as if there had been none: one that is emptied first may wait for the disk."""
    path.unlink(missing_ok=True)
    path.write_bytes(content)
