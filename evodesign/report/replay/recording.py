"""The replay as an MCAP file: heights as time, ten seconds per metre, the models attached as URDF.

The last posture comes once more a second later, so that a recording of one height has a length, too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import IO, Final

from mcap.writer import CompressionType, Writer

from evodesign.records import HeightDetail
from evodesign.report.replay.messages import TOPICS, messages
from evodesign.report.replay.schemas import descriptor_set
from evodesign.report.stage import Cast, stage_of

__all__ = ["NANOSECONDS_PER_METRE", "nanoseconds_at", "write_replay"]

NANOSECONDS_PER_METRE: Final = 10_000_000_000
HOLD: Final = 1_000_000_000
"""How long the last posture stays [ns]."""


def nanoseconds_at(height: float) -> int:
    """Time of a height's messages."""
    return round(height * NANOSECONDS_PER_METRE)


def write_replay(
    stream: IO[bytes],
    cast: Cast,
    heights: Sequence[HeightDetail],
    attachments: Mapping[str, str],
    about: Mapping[str, str],
) -> None:
    """Write a replay.

    Args:
        stream: to an empty file.
        cast: who stands there.
        heights: postures, in any order.
        attachments: URDF texts by file name.
        about: what the recording is of, kept as the metadata record `evodesign`.
    """
    writer = Writer(stream, compression=CompressionType.ZSTD)
    writer.start(profile="", library="evodesign")
    writer.add_metadata("evodesign", dict(about))
    for name, text in attachments.items():
        writer.add_attachment(0, 0, name, "application/xml", text.encode())
    channels = _channels(writer)
    ordered = sorted(heights, key=lambda detail: detail.height_m)
    times = [nanoseconds_at(detail.height_m) for detail in ordered]
    timed = [*zip(times, ordered, strict=True), *((times[-1] + HOLD, last) for last in ordered[-1:])]
    for sequence, (time, detail) in enumerate(timed):
        for topic, message in messages(stage_of(cast, detail), detail, time):
            writer.add_message(
                channel_id=channels[topic],
                log_time=time,
                publish_time=time,
                sequence=sequence,
                data=message.SerializeToString(deterministic=True),
            )
    writer.finish()  # type: ignore[no-untyped-call]


def _channels(writer: Writer) -> dict[str, int]:
    """A channel per topic, and a schema per class of messages, by its well-known name."""
    schemas = {
        kind.DESCRIPTOR.full_name: writer.register_schema(
            name=kind.DESCRIPTOR.full_name, encoding="protobuf", data=descriptor_set(kind)
        )
        for kind in dict.fromkeys(TOPICS.values())
    }
    return {
        topic: writer.register_channel(topic, "protobuf", schemas[kind.DESCRIPTOR.full_name])
        for topic, kind in TOPICS.items()
    }
