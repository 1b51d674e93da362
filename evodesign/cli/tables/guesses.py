"""What `init` guessed."""

from __future__ import annotations

from collections.abc import Iterable

from evodesign.cli.tables.table import FittedTable, names, titled
from evodesign.guess.problem_text import Guess


def guesses_table(guesses: Iterable[Guess], unknown: str) -> FittedTable:
    """Key, guess and reason in a row each; `unknown` stands where nothing was found."""
    table = titled("guessed", names("key", "guess", "because"))
    for guess in guesses:
        table.add_row(guess.key, guess.found or unknown, guess.why)
    return table
