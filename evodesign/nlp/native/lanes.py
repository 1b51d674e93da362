"""Straight-line functions of C that work on several arguments at once, a number of each in a lane.

What a block says at a knot takes two hundred thousand operations, one after the other, and a processor waits
for their instructions more than for their results. With four knots in the lanes of a vector an instruction
does the work of four. Lanes do not mix and nothing is fused, so every bit of a result stays the same.

Arrays hold a number of every lane, then the next number of every lane. Source of the vectors: GCC's manual,
"Using vector instructions through built-in functions". Clang has them, too, but takes minutes over them.
"""

from __future__ import annotations

import platform
import re
from functools import cache
from pathlib import Path

from evodesign.nlp.compiler import Compiler

LANES = 4
"""Arguments that are worked on at once."""

LANES_SYMBOL = "evodesign_lanes"
"""Of the number in a library that says how many lanes its functions have."""

CALLS = {"casadi_sq": "x * x", "casadi_fabs": "fabs(x)"} | {
    name: f"{name}(x)" for name in ("sin", "cos", "sqrt", "exp", "log")
}
"""What functions of one number that are called do in a lane."""

POWER = "pow"
"""The only one of two numbers."""

EACH = f"for (int lane = 0; lane < {LANES}; lane++)"

HEAD = "\n".join(
    [
        f"typedef double lanes __attribute__((vector_size({8 * LANES}), aligned(8)));",
        *(
            f"static inline lanes lanes_{name}(lanes all) {{ "
            f"{EACH} {{ double x = all[lane]; all[lane] = {does}; }} return all; }}"
            for name, does in CALLS.items()
        ),
        f"static inline lanes lanes_{POWER}(lanes all, lanes by) {{ "
        f"{EACH} all[lane] = {POWER}(all[lane], by[lane]); return all; }}",
    ]
)

LOADED = re.compile(r"^  (a\d+)=arg\[(\d+)\]\? arg\[\2\]\[(\d+)\] : 0;$")
STORED = re.compile(r"^  if \(res\[(\d+)\]!=0\) res\[\1\]\[(\d+)\]=(.*);$")
CONSTANT = re.compile(r"^  (a\d+)=(-?[0-9.][0-9.e+-]*);$")
NUMBERS = re.compile(r"^  casadi_real (a\d|kept\[)")
STATEMENT = re.compile(r"^  (?:a\d+|kept\[\d+\])=")
CALLED = re.compile(r"\b([a-z_]\w*)\(")
NOT_TAKEN = re.compile(r"[?<>!&|]|==")
"""Comparisons, which give whole numbers, and what is made of them."""


def in_lanes(text: str) -> str:
    """The same C with functions that work in lanes; in one, where some operation cannot be done in several.

    Args:
        text: of a CasADi function, cut into pieces (see `cut_functions`): as one function it would take a
            compiler minutes.
    """
    changed = [_in_lanes(line) for line in text.splitlines()]
    taken = [line for line in changed if line is not None]
    if len(taken) < len(changed):
        return in_one_lane(text)
    head, include, rest = "\n".join(taken).partition("#include <math.h>\n")
    return f"{head}{include}{HEAD}{rest}\nconst int {LANES_SYMBOL} = {LANES};\n"


def in_one_lane(text: str) -> str:
    """The same C with the number of its lanes."""
    return f"{text}\nconst int {LANES_SYMBOL} = 1;\n"


def _in_lanes(line: str) -> str | None:
    """A line of C in lanes; None where it cannot be."""
    if line.startswith("static void") and "casadi_real* kept" in line:
        return line.replace("casadi_real* kept", "lanes* kept")
    if NUMBERS.match(line):
        return line.replace("casadi_real", "lanes", 1)
    if found := LOADED.match(line):
        return f"  {found[1]}=((const lanes*)arg[{found[2]}])[{found[3]}];"
    if found := STORED.match(line):
        return f"  ((lanes*)res[{found[1]}])[{found[2]}]={found[3]};"
    if found := CONSTANT.match(line):
        return f"  {found[1]}=(lanes){{{','.join([found[2]] * LANES)}}};"
    if not STATEMENT.match(line):
        return line
    if NOT_TAKEN.search(line) or not {*CALLED.findall(line)} <= {*CALLS, POWER}:
        return None
    return CALLED.sub(r"lanes_\1(", line)


def lane_flags(compiler: Compiler) -> tuple[str, ...]:
    """Of a compiler that can make lanes; vectors are one instruction each where the machine has such.

    Args:
        compiler: GCC; of any other nothing is asked.
    """
    if "Free Software Foundation" not in compiler.version:
        return ()
    return ("-Wno-psabi", *(["-mavx2"] if _has_wide_vectors() else []))


@cache
def _has_wide_vectors() -> bool:
    if platform.machine() not in ("x86_64", "AMD64"):
        return False
    try:
        known = Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace")
    except OSError:
        return False
    return re.search(r"^flags\s*:.*\bavx2\b", known, re.MULTILINE) is not None
