"""Code that stands outside of the package, under a name such as `module:name`, and is imported by it.

A name may come from a problem or a run that somebody else has sent, and an import executes; so only modules
are imported that the user has named in the environment variable `EVODESIGN_MODULES`, which all processes of
a search inherit.
"""

from __future__ import annotations

import os
import pkgutil

from evodesign.errors import InputError

MODULES_VARIABLE = "EVODESIGN_MODULES"
"""Names of the modules that may be imported, separated by commas."""


def is_outside(name: str) -> bool:
    """Whether a name says where it is to be imported from."""
    return ":" in name


def imported(name: str, source: str, key: str) -> object:
    """What stands at a place such as `package.module:name`.

    Args:
        name: the place.
        source: what holds the name, for the error's sentence.
        key: where in it.

    Raises:
        InputError: nothing does, or the user has not named the module.
    """
    module = name.partition(":")[0]
    if module not in [each.strip() for each in os.environ.get(MODULES_VARIABLE, "").split(",")]:
        wanted = f"a module that the environment variable {MODULES_VARIABLE} names"
        found = f"'{name}'; to let its code run, set {MODULES_VARIABLE}={module}"
        raise InputError(source, key, wanted, found)
    try:
        return pkgutil.resolve_name(name)
    except Exception as error:  # a module of the user's may raise anything while it is imported
        wanted = "MODULE:NAME of something that Python can import"
        told = "" if isinstance(error, ImportError | AttributeError) else f"{type(error).__name__}: "
        raise InputError(source, key, wanted, f"'{name}' ({told}{error})") from error
