"""Names in a problem file that a model does not have, refused with the nearest one that it has."""

from __future__ import annotations

from collections.abc import Collection

from evodesign.errors import InputError, nearest_name
from evodesign.records import ProblemSource


def refuse_unknown(
    source: ProblemSource, key: str, noun: str, name: str, known: Collection[str], where: str
) -> None:
    """Refuse a name that is not among the known ones.

    Args:
        source: the problem, for messages.
        key: where in it the name stands.
        noun: what is named, such as `link`.
        name: as written.
        known: all that would do.
        where: the model that holds them.
    Raises:
        InputError: naming the nearest known one.
    """
    if name not in known:
        hint = nearest_name(name, known)
        raise InputError(source.path, key, f"the name of a {noun} of '{where}'", f"'{name}'{hint}")
