"""What is written for programs and for people."""

from __future__ import annotations

import io
import json
import sys

import pytest

from evodesign.cli.output import print_json


def test_json_loses_nothing_in_ascii(monkeypatch: pytest.MonkeyPatch) -> None:
    value = {"töy": ["€", "😀", 'a "quoted"\nline\x7f']}
    written = {}
    for encoding in ("iso-8859-1", "ascii", "utf-8"):
        monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(io.BytesIO(), encoding))
        print_json(value)
        sys.stdout.seek(0)
        written[encoding] = sys.stdout.read()
    assert written["ascii"].isascii()
    assert [json.loads(text) for text in written.values()] == [value] * 3
