"""Schemas of the replay's messages as MCAP wants them: a protobuf `FileDescriptorSet` with everything needed.

Source: MCAP registry, schema encoding `protobuf`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from google.protobuf.descriptor_pb2 import FileDescriptorSet

__all__ = ["descriptor_set"]


def descriptor_set(message: Any) -> bytes:
    """The files that describe a class of messages, imported ones before those that import them, each once."""
    files = {file.name: file for file in _files(message.DESCRIPTOR.file)}
    described = FileDescriptorSet()
    for file in files.values():
        file.CopyToProto(described.file.add())
    serialized: bytes = described.SerializeToString(deterministic=True)
    return serialized


def _files(file: Any) -> Iterator[Any]:
    for imported in file.dependencies:
        yield from _files(imported)
    yield file
