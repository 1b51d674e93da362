"""Long straight-line functions of C, cut into pieces that a compiler takes in linear time.

CasADi writes a function as one block: numbers `a0`, `a1`, .. are assigned and used again, thousands of lines
long. A compiler's time and memory grow faster than such a block. Each piece becomes a function of its own;
the numbers that later pieces need are handed on in an array. The operations and their order stay the same,
and so does every bit of the result.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

PIECE = 1000
"""Statements in a piece: fewer cost time in handing numbers on, more cost time in compiling."""

ARGUMENTS = "const casadi_real** arg, casadi_real** res"

FUNCTION = re.compile(
    r"^static int (\w+)\((const casadi_real\*\* arg, casadi_real\*\* res), [^)]*\) \{\n"
    r"((?:  casadi_real a\d+(?:, a\d+)*;\n)+)(.*?)  return 0;\n\}\n",
    re.MULTILINE | re.DOTALL,
)
"""A function's name, the declarations of its numbers, and its statements, one a line."""

NUMBER = re.compile(r"\ba(\d+)\b")
ASSIGNED = re.compile(r"^  a(\d+)=")


def in_pieces(text: str, longest: int = PIECE) -> str:
    """The same C with every function of more statements than `longest` cut into pieces."""
    return FUNCTION.sub(lambda found: _cut(found, longest), text)


def _cut(found: re.Match[str], longest: int) -> str:
    name, lines = found[1], found[4].splitlines()
    if len(lines) <= longest:
        return found[0]
    pieces = [lines[first : first + longest] for first in range(0, len(lines), longest)]
    needs, makes = zip(*map(_needed_and_made, pieces), strict=True)
    wanted: set[int] = set()  # by what follows
    texts: list[str] = []
    for number in reversed(range(len(pieces))):
        texts.append(_piece(f"{name}_{number}", pieces[number], needs[number], makes[number] & wanted))
        wanted = (wanted - makes[number]) | needs[number]
    size = 1 + max(map(int, NUMBER.findall(found[3])))
    calls = [f"  {name}_{number}(arg, res, kept);" for number in range(len(pieces))]
    head = found[0].partition("\n")[0]
    return "\n".join([*reversed(texts), head, f"  casadi_real kept[{size}];", *calls, "  return 0;", "}", ""])


def _needed_and_made(lines: Sequence[str]) -> tuple[set[int], set[int]]:
    """Numbers that statements use before they assign them, and those that they assign."""
    needed: set[int] = set()
    made: set[int] = set()
    for line in lines:
        assigned = ASSIGNED.match(line)
        used = line[assigned.end() :] if assigned else line
        needed.update(set(map(int, NUMBER.findall(used))) - made)
        if assigned:
            made.add(int(assigned[1]))
    return needed, made


def _piece(name: str, lines: Sequence[str], needed: set[int], handed_on: set[int]) -> str:
    spelled = {int(word): f"a{word}" for line in lines for word in NUMBER.findall(line)}
    return "\n".join(
        [
            f"static void {name}({ARGUMENTS}, casadi_real* kept) {{",
            f"  casadi_real {', '.join(spelled[number] for number in sorted(spelled))};",
            *(f"  {spelled[number]}=kept[{number}];" for number in sorted(needed)),
            *lines,
            *(f"  kept[{number}]={spelled[number]};" for number in sorted(handed_on)),
            "}",
            "",
        ]
    )
