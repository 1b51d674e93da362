"""The bench that builds a task once, and its sentences on failures."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from evodesign.errors import InputError, explain
from evodesign.pool.worker import Workbench


def test_an_error_without_text_or_traceback_is_its_kind() -> None:
    assert explain(KeyError()) == "KeyError"


def test_a_text_of_several_lines_becomes_one() -> None:
    assert explain(ValueError("no\n   root")) == "ValueError: no root"


def test_an_error_names_the_file_and_line_where_it_arose() -> None:
    with pytest.raises(ValueError, match="seven") as caught:
        int("seven")
    place = f"(test_worker.py:{caught.tb.tb_lineno} in {caught.tb.tb_frame.f_code.co_name})"
    assert explain(caught.value) == f"ValueError: invalid literal for int() with base 10: 'seven' {place}"


def test_a_sentence_for_the_user_stays_as_it_is() -> None:
    assert (
        explain(InputError("a.toml", "mass", "a number", "'x'")) == "a.toml: mass: wanted a number, found 'x'"
    )


def test_nothing_is_built_before_the_first_argument() -> None:
    built = []

    def factory() -> Callable[[int], int]:
        built.append(1)
        return abs

    bench = Workbench(factory, "local")
    assert built == []
    assert [bench.finish(index, -index).value for index in range(3)] == [0, 1, 2]
    assert built == [1]


def test_a_value_of_none_is_not_a_failure() -> None:
    end = Workbench(lambda: lambda argument: None, "local").finish(0, "anything")
    assert (end.value, end.failure) == (None, None)


def test_a_factory_that_gives_nothing_is_a_failure() -> None:
    end = Workbench(lambda: None, "local").finish(0, 1)  # type: ignore[arg-type, return-value]
    assert end.failure == "the task could not be built: its factory gave None"
