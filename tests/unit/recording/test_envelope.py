"""A sample in its envelope keeps every byte, and others read it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from cliffscan.common.runtime.raw_samples import RawSample
from cliffscan.recording.definitions import schema
from cliffscan.recording.envelope import SAMPLE, unwrap, wrap
from cliffscan.services.ros2.cdr import CdrError

ROS = get_typestore(Stores.ROS2_JAZZY)
ROS.register(get_types_from_msg(schema(SAMPLE.message_name), SAMPLE.message_name))
LETTERS = st.text("abcdefgh/_é", min_size=1, max_size=9)
ANY = RawSample("scan/fused", "application/msgpack;cliffscan.LaserScan.v1", 5, b"", b"abc")


@given(
    LETTERS, LETTERS, st.integers(0, 2**63 - 1), st.binary(max_size=9), st.binary(max_size=20), st.sampled_from("ab")
)
def test_what_is_wrapped_is_unwrapped(path, encoding, received, attachment, payload, robot):
    sample = RawSample(path, encoding, received, attachment, payload)
    data = wrap(robot, sample)
    assert unwrap(robot, data) == sample
    others = ROS.deserialize_cdr(data, SAMPLE.message_name)
    assert (others.key, others.encoding, others.received_ns) == (f"{robot}/{path}", encoding, received)
    assert (others.attachment.tobytes(), others.payload.tobytes()) == (attachment, payload)


def test_what_others_wrap_is_unwrapped():
    kind = ROS.types[SAMPLE.message_name]
    made = kind("turtlebot/scan/fused", ANY.encoding, 5, np.empty(0, np.uint8), np.frombuffer(b"abc", np.uint8))
    assert unwrap("turtlebot", bytes(ROS.serialize_cdr(made, SAMPLE.message_name))) == ANY


def test_a_sample_of_another_robot_is_refused():
    with pytest.raises(CdrError, match="'one/scan/fused' in a recording of two"):
        unwrap("two", wrap("one", ANY))


@pytest.mark.parametrize("length", [0, 3, 10, 70, 90])
def test_a_cut_sample_is_refused(length):
    with pytest.raises(CdrError):
        unwrap("turtlebot", wrap("turtlebot", ANY)[:length])
