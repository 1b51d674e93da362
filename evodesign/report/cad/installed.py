"""Whether what CAD files need is there, looked at before Open CASCADE is imported."""

from __future__ import annotations

from importlib.util import find_spec

from evodesign.errors import InputError


def refuse_without_cad() -> None:
    """Refuse to write CAD files without Open CASCADE.

    Raises:
        InputError: it is not installed.
    """
    if find_spec("OCP") is None:
        wanted = "Open CASCADE installed (pip install 'evodesign[cad]')"
        raise InputError("--cad", "", wanted, "no package 'OCP'")
