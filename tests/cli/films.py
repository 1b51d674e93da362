"""Films that commands write, where the machine can draw."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from PIL import Image

from evodesign.errors import InputError


def assert_filmed_or_refused(run: Callable[[], None], film: Path) -> None:
    """That a command writes a film of the usual size, or says in a sentence that MuJoCo cannot draw."""
    refused = ""
    try:
        run()
    except InputError as error:
        refused = str(error)
    if film.exists():
        with Image.open(film) as opened:
            assert (opened.size, refused) == ((480, 360), "")
    else:
        assert "MUJOCO_GL" in refused
