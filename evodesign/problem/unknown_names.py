"""Names in a file that stand for nothing, refused with the nearest one that would do."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from evodesign.errors import InputError, nearest_name, offered
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
    refuse_unlisted(source.path, key, name, known, f"the name of a {noun} of '{where}'")


def refuse_unlisted(source: str, key: str, name: str, known: Collection[str], wanted: str = "") -> None:
    """The same by the file's or option's own name; wanted is, unless it is said, one of the known ones."""
    if name not in known:
        found = f"'{name}'{nearest_name(name, known)}"
        raise InputError(source, key, wanted or f"one of {', '.join(known)}", found)


OF_CATALOGUE = {
    "material": "a material of the catalogue or of a [[material]] table",
    "model": "a model of the catalogue or of an [[actuator]] table",
}
"""Where materials and models of actuators come from."""


def of_catalogue(noun: str, name: str, known: Collection[str]) -> str:
    """Where materials or models come from, with those that would do in place of a name."""
    return f"{OF_CATALOGUE[noun]} ({offered(known, name)[0]})"


def refuse_unfit_choices(
    source: ProblemSource, key: str, noun: str, names: Sequence[str], known: Collection[str]
) -> None:
    """Refuse fewer than two materials or models to choose from, unknown ones, or one twice."""
    if len(names) < 2:
        raise InputError(source.path, key, f"at least two {noun}s", f"{len(names)}")
    for position, name in enumerate(names):
        where = f"{key}[{position}]"
        refuse_unlisted(source.path, where, name, known, of_catalogue(noun, name, known))
        if name in names[:position]:
            raise InputError(source.path, where, f"each {noun} once", f"'{name}' twice")
