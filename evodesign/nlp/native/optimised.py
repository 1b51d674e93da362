"""Functions as machine code: TinyCC's at once, optimised behind where they run for long.

TinyCC compiles at once. What has been solved with for longer than it takes to optimise its functions is
worth that: the machine's own compiler does it behind, and its code, which gives the same bits, takes over.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from pathlib import Path

from evodesign.nlp.background import in_background
from evodesign.nlp.codegen import FUNCTION_FLAGS, Library, built, compiler_and_cache, kept_library
from evodesign.nlp.compiler import Compiler, NotCompiled
from evodesign.nlp.disk_cache import Cache

WORTH = 5e-6
"""Time [s] that must have been solved for, per byte of TinyCC's code, to be worth optimising.

Twice what GCC takes for it; its code saves a third to a half of a solve.
"""

NICENESS = 10
"""How much less urgent optimising is than the solves beside it."""


@dataclass(frozen=True, slots=True)
class FunctionSource:
    """What functions are compiled from.

    Args:
        of: data that the C follows from.
        text: writes the C, in the thread that CasADi works in.
        file: makes of it what a compiler is given, in whichever thread.
        flags: for a compiler beside those of all functions.
    """

    of: object
    text: Callable[[], str]
    file: Callable[[str, Compiler], str] = lambda text, _: text
    flags: Callable[[Compiler], Sequence[str]] = lambda _: ()

    def kept(self, compiler: Compiler, cache: Cache) -> Library | None:
        """What was compiled before."""
        return kept_library(self.of, self._flags(compiler), compiler, cache)

    def compiled(
        self, compiler: Compiler, cache: Cache, niceness: int = 0, text: str | None = None
    ) -> Library | NotCompiled:
        """What was compiled before, or is now, of a text that may be known already; else why there is none.

        Raises:
            OSError: a file cannot be written.
        """

        def files() -> Mapping[str, str]:
            return {"functions.c": self.file(self.text() if text is None else text, compiler)}

        return built(self.of, files, self._flags(compiler), compiler, cache, niceness)

    def _flags(self, compiler: Compiler) -> tuple[str, ...]:
        return *FUNCTION_FLAGS, *self.flags(compiler)


def functions_of(source: FunctionSource, *, seldom: bool) -> tuple[Library, Optimised | None] | NotCompiled:
    """Functions by the quick compiler, and what optimises them; or optimised ones that were made before.

    Args:
        source: what they are compiled from.
        seldom: whether they run so seldom that it is never worth optimising them.
    Raises:
        OSError: a file cannot be read or written.
    """
    quick, best = (compiler_and_cache(os.environ, quick=each) for each in (True, False))
    if isinstance(quick, NotCompiled):
        return quick
    if isinstance(best, NotCompiled):
        return best
    optimised = None if seldom or quick == best else Optimised(source, *best)
    if optimised and (kept := source.kept(*best)):
        return kept, None
    found = source.compiled(*quick)
    if isinstance(found, NotCompiled) and quick != best:
        found, optimised = source.compiled(*best), None
    return found if isinstance(found, NotCompiled) else (found, optimised)


_SOLVED: dict[Path, float] = {}
"""How long [s] this process has solved with a library."""


@dataclass
class Optimised:
    """Functions from the machine's compiler, which is asked for them once they are worth it.

    Args:
        source: what they are compiled from.
        compiler: to use.
        cache: where libraries are kept.
    """

    source: FunctionSource
    compiler: Compiler
    cache: Cache
    _coming: Future[Library | NotCompiled] | None = None

    def taken_over(self, quick: Library, seconds: float, load: Callable[[Library], None]) -> Optimised | None:
        """Have the functions loaded if they are ready; itself as long as they may come.

        Args:
            quick: the library that runs.
            seconds: that it has been solved with once more [s].
            load: puts another library in its place; where it fails, the quick one stays.
        """
        try:
            found = self.after(quick, seconds)
            if isinstance(found, Library):
                load(found)
        except (OSError, RuntimeError, MemoryError):
            return None
        return None if found else self

    def after(self, quick: Library, seconds: float) -> Library | NotCompiled | None:
        """The functions, or why there are none, when it is known.

        Args:
            quick: the library that runs.
            seconds: that it has been solved with once more [s].
        Raises:
            OSError: a file cannot be read or written.
        """
        if self._coming:
            return self._coming.result() if self._coming.done() else None
        solved = _SOLVED[quick.path] = _SOLVED.get(quick.path, 0.0) + seconds
        if solved < WORTH * quick.path.stat().st_size:
            return None
        if kept := self.source.kept(self.compiler, self.cache):
            return kept
        text = self.source.text()
        self._coming = in_background(lambda: self.source.compiled(self.compiler, self.cache, NICENESS, text))
        return None
