"""What a tree is asked for again and again, worked out once while the tree is in use."""

from __future__ import annotations

import functools
import weakref
from collections.abc import Callable
from typing import Concatenate, ParamSpec, TypeVar

from evodesign.tree.model import Tree

P = ParamSpec("P")
R = TypeVar("R")


def once_per_tree(function: Callable[Concatenate[Tree, P], R]) -> Callable[Concatenate[Tree, P], R]:
    """The function, whose results are kept by the tree's identity and the other, hashable arguments."""
    known: dict[int, tuple[weakref.ref[Tree], dict[object, R]]] = {}

    @functools.wraps(function)
    def found(tree: Tree, /, *args: P.args, **kwargs: P.kwargs) -> R:
        key = id(tree)
        if key not in known:
            known[key] = weakref.ref(tree, lambda _: known.pop(key, None)), {}
        results, given = known[key][1], (args, *sorted(kwargs.items()))
        if given not in results:
            results[given] = function(tree, *args, **kwargs)
        return results[given]

    return found
