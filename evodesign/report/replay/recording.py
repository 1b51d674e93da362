"""The replay as an MCAP file: heights or cases as time, the models attached as URDF.

The last posture comes once more a second later, so that a recording of one height has a length, too.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import IO, Final

from mcap.writer import CompressionType, Writer

from evodesign.records import CaseDetail
from evodesign.report.replay.messages import TOPICS, messages
from evodesign.report.replay.schemas import descriptor_set
from evodesign.report.replay.times import timed
from evodesign.report.scene_models import SceneSet

__all__ = ["write_replay"]

HOLD: Final = 1_000_000_000
"""How long the last posture stays [ns]."""


def write_replay(
    stream: IO[bytes],
    scene_set: SceneSet,
    cases: Sequence[CaseDetail],
    attachments: Mapping[str, str],
    about: Mapping[str, str],
) -> None:
    """Write a replay.

    Args:
        stream: to an empty file.
        scene_set: who stands there.
        cases: postures, in any order; of several people or loads, in the problem's.
        attachments: URDF texts by file name.
        about: what the recording is of, kept as the metadata record `evodesign`.
    """
    writer = Writer(stream, compression=CompressionType.ZSTD)
    writer.start(profile="", library="evodesign")
    writer.add_metadata("evodesign", dict(about))
    for name, text in attachments.items():
        writer.add_attachment(0, 0, name, "application/xml", text.encode())
    channels = _channels(writer)
    shown = timed(cases)
    held = [(time + HOLD, last) for time, last in shown[-1:]]
    for sequence, (time, detail) in enumerate((*shown, *held)):
        for topic, message in messages(scene_set.placed_scene(detail), detail, time):
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
