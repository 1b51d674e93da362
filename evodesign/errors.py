"""Every error that evodesign raises on purpose.

    EvodesignError
    ├── InputError          a file, a key or an option that the user gave is wrong (exit code 2)
    │   └── ModelError      a robot or person description that cannot be used
    ├── RunError            a run directory that cannot be read or written (exit code 2)
    │   └── ResumeMismatch  a log that this problem and search did not write (exit code 2)
    ├── AllFailed           a session's first evaluations, for one reason; it can be resumed (exit code 5)
    └── Interrupted         the user stopped a search; it can be resumed (exit code 3)

A failed solve is not an error: it is a `records.Status` with a reason.
"""

from __future__ import annotations

import difflib
import re
import traceback
from collections.abc import Iterable, Sequence
from pathlib import Path

LONGEST_WORD, LONGEST_CLAUSE = 80, 600
"""Letters of a word (paths have one in each folder) and of a clause that a message repeats of a file."""


class EvodesignError(Exception):
    """Root of the tree; its text is one sentence that a user can act on."""


class InputError(EvodesignError):
    """Something that the user wrote is wrong; the message repeats no more of it than can be read.

    Attributes:
        source: the file or option that holds it.
        key: where in it, such as `design.length[2].lower`; empty for the whole.
        wanted: what would be accepted.
        found: what stands there.
    """

    def __init__(self, source: str, key: str, wanted: str, found: str) -> None:
        self.source = source
        self.key = key
        self.wanted = wanted
        self.found = found
        place = f"{source}: {_readable(key)}" if key else source
        super().__init__(on_one_line(f"{place}: wanted {_readable(wanted)}, found {_readable(found)}"))


def on_one_line(text: str) -> str:
    """The text with line ends and other control characters as their escapes: names in files may hold them."""
    return "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in text)


def shortened(text: str, longest: int = LONGEST_WORD) -> str:
    """The text with its middle left out where it has more letters than `longest`."""
    kept = (longest - 3) // 2
    return text if len(text) <= longest else f"{text[:kept]}...{text[-kept:]}"


LISTED = 3
"""Names that a sentence lists before it counts the others."""


def listed(names: Sequence[str]) -> str:
    """The first of some names, and how many there are beside them."""
    more = len(names) - LISTED
    return ", ".join(names[:LISTED]) + (f" and {more} more" if more > 0 else "")


def _readable(clause: str) -> str:
    """A clause of a message, with long words and all of it shortened."""
    words = re.sub(rf"[^\s/]{{{LONGEST_WORD + 1},}}", lambda word: shortened(word[0]), clause)
    return shortened(words, LONGEST_CLAUSE)


class ModelError(InputError):
    """A robot or person description that is not a usable tree of links and joints."""


class RunError(EvodesignError):
    """A run directory that cannot be read, written or continued."""


class ResumeMismatch(RunError):
    """A logged evaluation that the rebuilt search would not have asked for."""


class AllFailed(EvodesignError):
    """A generation of which every evaluation failed for one reason; resumed, it is evaluated again."""


class Interrupted(EvodesignError):
    """A search that was stopped on request and can be resumed."""


def nearest_name(name: str, names: Iterable[str]) -> str:
    """A hint such as `; did you mean 'chest'?`, or an empty string when nothing is near.

    Names that are equally near are all in it, at most `LISTED` of them.
    """
    if len(name) > LONGEST_WORD:  # looking for a match takes as long as the square of its letters
        return ""
    matches = difflib.get_close_matches(name, list(names), n=LISTED, cutoff=0.5)
    likeness = [difflib.SequenceMatcher(None, match, name).ratio() for match in matches]
    nearest = [f"'{match}'" for match, like in zip(matches, likeness, strict=True) if like == likeness[0]]
    return f"; did you mean {' or '.join(sorted(nearest))}?" if nearest else ""


def offered(names: Iterable[str], name: str, meant: str = "", beside: Iterable[str] = ()) -> tuple[str, str]:
    """What would do in place of a name, and the name with a hint: a few names where one is near, else all.

    Args:
        names: that would do.
        name: as it stands.
        meant: which name it is likely to stand for; left out: itself.
        beside: names that would do and are not listed.
    """
    known = [*names]
    hint = nearest_name(meant or name, [*known, *beside])
    return listed(known) if hint else ", ".join(known), f"'{name}'{hint}"


def explain(error: BaseException) -> str:
    """Kind, text and last line of an exception, such as `ValueError: no root (model.py:120 in root)`.

    An error of evodesign is its text: a sentence that says where to look.
    """
    if isinstance(error, EvodesignError):
        return str(error)
    text = " ".join(str(error).split())
    sentence = f"{type(error).__name__}: {text}" if text else type(error).__name__
    frames = traceback.extract_tb(error.__traceback__)
    if not frames:
        return sentence
    last = frames[-1]
    return f"{sentence} ({Path(last.filename).name}:{last.lineno} in {last.name})"
