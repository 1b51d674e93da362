"""Strict decoding names file, key, what was wanted and what was found."""

from __future__ import annotations

import tomllib
from pathlib import Path

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evodesign.errors import InputError
from evodesign.problem.designs import PopulationFile
from evodesign.problem.file import ProblemFile
from evodesign.problem.source import decode_toml, read_source


@pytest.mark.parametrize(
    ("text", "key", "wanted", "found"),
    [
        ("name = 3", "name", "text", "3"),
        ("nam = 'a'", "nam", "one of the keys name, design", "'nam'; did you mean 'name'?"),
        ("name = 'a'", "design", "this key", "nothing"),
        ("name = 'a'\ndesign = []", "design", "a list of length >= 1", "[]"),
        ("name = 'a'\n[[design]]\nname = 'b'\nlength = {arm = -1}", "design[0].length.arm", "> 0", "-1"),
        ("name = 'a'\n[[design]]\nname = 'b'\nlength = {arm = inf}", "design[0].length.arm", "finite", "inf"),
        ("name = 'a'\n[[design]]\nname = 'b'\nlenght = {}", "design[0].lenght", "keys name", "'length'?"),
        (
            "name = 'a'\n[[design]]\nname = 'b'\npolicy = {}",
            "design[0].policy",
            "name",
            "called 'allocation' now",
        ),
    ],
)
def test_errors_say_where_and_what(text: str, key: str, wanted: str, found: str) -> None:
    with pytest.raises(InputError) as caught:
        decode_toml(text, "file.toml", PopulationFile)
    error = caught.value
    assert error.source == "file.toml"
    assert key in error.key
    assert wanted in error.wanted
    assert found in error.found
    assert "\n" not in str(error)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[[design.policy]]", r"design\.policy: .*found 'policy'; it is called 'allocation' now"),
        ("[solver]\nseeds = true", r"solver\.seeds: .*found 'seeds'; it is called 'start_portfolio' now"),
    ],
)
def test_a_key_of_an_earlier_version_is_refused_with_its_new_name(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        decode_toml(text, "file.toml", ProblemFile)


def test_value_under_a_dictionary_key_is_found() -> None:
    text = "name = 'a'\n[[design]]\nname = 'b'\nlength = {arm = 'long'}"
    with pytest.raises(InputError) as caught:
        decode_toml(text, "file.toml", PopulationFile)
    assert "design[0].length" in caught.value.key


@given(st.text(max_size=200))
def test_any_text_decodes_or_is_explained_in_one_sentence(text: str) -> None:
    with pytest.raises(InputError) as caught:
        decode_toml(text, "file.toml", ProblemFile)
    assert str(caught.value).startswith("file.toml")


def test_nesting_without_end_is_refused() -> None:
    with pytest.raises(InputError):
        decode_toml("a = " + "[" * 100_000, "file.toml", ProblemFile)


@pytest.mark.parametrize(
    "text",
    [
        'name = "' + "a.b" * 40 + '"',
        'name = """\n' + "a.b" * 40 + '\n"""""',
        "name = '''\n" + "a.b" * 40 + "'''",
        "# " + "a.b" * 40 + '\nname = "x"',
        'name = "x" # it\'s """' + "a.b" * 40,
        'name = "\\" \'" # ' + "a.b" * 40,
    ],
)
def test_dots_in_texts_and_comments_are_no_parts_of_keys(text: str) -> None:
    class Named(msgspec.Struct):
        name: str

    assert decode_toml(text, "x.toml", Named).name == tomllib.loads(text)["name"]


def test_a_mark_of_the_byte_order_before_a_file_is_no_part_of_it(tmp_path: Path) -> None:
    plain = read_source("icub-lifting")
    (name,) = plain.files
    (tmp_path / "a.toml").write_text(f"\ufeff{plain.text}", encoding="utf-8")
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text(f"\ufeff{plain.files[name]}", encoding="utf-8")
    marked = read_source(tmp_path / "a.toml")
    assert (marked.text, marked.files) == (plain.text, plain.files)


def test_a_file_that_is_a_pointer_to_another_is_named(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text("version https://git-lfs.github.com/spec/v1\noid sha256:aa\nsize 9\n")
    with pytest.raises(
        InputError, match=r"wanted a file with its content, found .*a.toml', which is a Git LFS"
    ):
        read_source(tmp_path / "a.toml")
