"""The replay as an MCAP file: heights or cases as time, the models attached as URDF.

Heights are time, ten seconds per metre, where a problem has one person and one load that is held still.
Otherwise the cases come one after the other, in the problem's order: all loads of a person in a row. A load
held still takes two seconds, a lift as long as it takes and two seconds more. The last posture comes once
more a second later, so that a recording of one height has a length, too.

The schemas of the messages stand in the file as MCAP wants them: a protobuf `FileDescriptorSet` with
everything needed.

Source: MCAP registry, schema encoding `protobuf`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import IO, Any, Final

from google.protobuf.descriptor_pb2 import FileDescriptorSet
from mcap.writer import CompressionType, Writer

from evodesign.records import CaseDetail, Lift
from evodesign.report.replay.messages import messages
from evodesign.report.replay.surfaces import MESHES, mesh_message, topics_of
from evodesign.report.scene_models import PlacedScene, SceneSet

NANOSECONDS: Final = 1_000_000_000
NANOSECONDS_PER_METRE: Final = 10 * NANOSECONDS
SECONDS_PER_CASE: Final = 2

Timed = tuple[int, CaseDetail]
"""Time [ns] and what is shown from then on."""

Frame = tuple[int, PlacedScene, CaseDetail]
"""Time [ns], where everything is, and the postures of it."""

HOLD: Final = 1_000_000_000
"""How long the last posture stays [ns]."""


def nanoseconds_at(height: float) -> int:
    """Time of a height's messages."""
    return round(height * NANOSECONDS_PER_METRE)


def several(cases: Sequence[CaseDetail]) -> bool:
    """Whether a height does not tell them apart: there are several people or loads, or a lift."""
    return any(detail.case.label or isinstance(detail.case.task, Lift) for detail in cases)


def timed(cases: Sequence[CaseDetail]) -> list[Timed]:
    """All postures of one instant with their times, in rising order."""
    if not several(cases):
        ordered = sorted(cases, key=lambda detail: detail.height_m)
        return [(nanoseconds_at(detail.height_m), detail) for detail in ordered]
    found: list[Timed] = []
    began = 0.0
    for detail in cases:
        found += [(round((began + each.time_s) * NANOSECONDS), each) for each in detail.moments]
        began += detail.instants[-1].time_s + SECONDS_PER_CASE
    return found


def time_scale(cases: Sequence[CaseDetail]) -> str:
    """What time means, in words."""
    if any(isinstance(detail.case.task, Lift) for detail in cases):
        return f"real time of each lift, {SECONDS_PER_CASE} s per case beside, in the problem's order"
    if several(cases):
        return f"{SECONDS_PER_CASE} s per case: person, load and height in the problem's order"
    return "10 s per metre of the load's height"


def replay_frames(scene_set: SceneSet, cases: Sequence[CaseDetail]) -> Iterator[Frame]:
    """The frames of a replay: postures, in any order; of several people or loads, in the problem's."""
    shown = timed(cases)
    held = [(time + HOLD, last) for time, last in shown[-1:]]
    return ((time, scene_set.placed_scene(detail), detail) for time, detail in (*shown, *held))


def write_frames(
    stream: IO[bytes],
    scene_set: SceneSet,
    frames: Iterable[Frame],
    attachments: Mapping[str, str],
    about: Mapping[str, str],
) -> None:
    """Write a recording.

    Args:
        stream: to an empty file.
        scene_set: who stands there.
        frames: in rising order of time.
        attachments: URDF texts by file name.
        about: what the recording is of, kept as the metadata record `evodesign`.
    """
    writer = Writer(stream, compression=CompressionType.ZSTD)
    writer.start(profile="", library="evodesign")
    writer.add_metadata("evodesign", dict(about))
    for name, text in attachments.items():
        writer.add_attachment(0, 0, name, "application/xml", text.encode())
    channels = _channels(writer, topics_of(scene_set))
    for sequence, (time, stage, detail) in enumerate(frames):
        once = [(MESHES, mesh_message(scene_set, time))] if sequence == 0 and MESHES in channels else []
        for topic, message in (*once, *messages(stage, detail, time)):
            writer.add_message(
                channel_id=channels[topic],
                log_time=time,
                publish_time=time,
                sequence=sequence,
                data=message.SerializeToString(deterministic=True),
            )
    writer.finish()  # type: ignore[no-untyped-call]


def _channels(writer: Writer, topics: Mapping[str, Any]) -> dict[str, int]:
    """A channel per topic, and a schema per class of messages, by its well-known name."""
    schemas = {
        kind.DESCRIPTOR.full_name: writer.register_schema(
            name=kind.DESCRIPTOR.full_name, encoding="protobuf", data=descriptor_set(kind)
        )
        for kind in dict.fromkeys(topics.values())
    }
    return {
        topic: writer.register_channel(topic, "protobuf", schemas[kind.DESCRIPTOR.full_name])
        for topic, kind in topics.items()
    }


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
