"""A native sample inside a recording: the ROS message cliffscan_msgs/msg/Sample, which holds its bytes as they were."""

import struct
from functools import lru_cache

import numpy as np

from cliffscan.common.runtime.raw_samples import RawSample
from cliffscan.recording.mcap_file import RosTopic
from cliffscan.services.ros2.cdr import HEADER, CdrError, Reader, Writer
from cliffscan.services.ros2.interfaces import Interface
from cliffscan.services.ros2.node import Profile

SAMPLE = Interface("cliffscan_msgs", "Sample", "5de7d3f25f2aad017d76f3190ecb172b6e435a3e35932e32016a803f66c53c40")
RECEIVED_AND_COUNT, COUNT = struct.Struct("<qI"), struct.Struct("<I")
ALIGNED = 8  # [bytes] at which CDR begins an int64
NATIVE = RosTopic("/cliffscan/native", SAMPLE, Profile.DEFAULT)


def wrap(robot: str, sample: RawSample) -> bytes:
    """The CDR of a robot's sample; its key is the whole one, with the robot's name."""
    head = _head(f"{robot}/{sample.path}", sample.encoding)
    attachment, payload = sample.attachment, sample.payload
    counted = RECEIVED_AND_COUNT.pack(sample.received, len(attachment))
    padding = bytes(-len(attachment) % COUNT.size)
    return b"".join((head, counted, attachment, padding, COUNT.pack(len(payload)), payload))


@lru_cache(256)
def _head(key: str, encoding: str) -> bytes:
    """All before the time, which is the same for every sample of a key: a recorder wraps hundreds a second."""
    writer = Writer()
    writer.text(key)
    writer.text(encoding)
    head = writer.payload()
    return head + bytes(-(len(head) - len(HEADER)) % ALIGNED)


def unwrap(robot: str, data: bytes) -> RawSample:
    """The sample in a CDR. Raises CdrError for one of another robot too."""
    reader = Reader(data)
    key, encoding = reader.text(), reader.text()
    (received,) = reader.numbers("q", 1)
    if not key.startswith(f"{robot}/"):
        raise CdrError(f"a sample of {key!r} in a recording of {robot}")
    attachment, payload = (reader.sequence(np.uint8).tobytes() for _ in range(2))
    return RawSample(key.removeprefix(f"{robot}/"), encoding, received, attachment, payload)
