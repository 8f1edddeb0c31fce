"""Recordings as programs of others read them, and a drive past stairs to be recorded."""

import math

import msgpack
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

from cliffscan.common.contract.depth_codec import LEVELS
from cliffscan.common.contract.messages import DepthImage
from cliffscan.simulator.camera import SimulatedKinect
from cliffscan.simulator.world import Pose
from tests import scenes

NATIVE = "/cliffscan/native"
SECOND = 1_000_000_000  # [ns]
CAMERA = scenes.camera(160, 120)


def drive(frames, world="landing"):
    """Depth images of a robot that drives on and turns."""
    kinect = SimulatedKinect(world, CAMERA)
    for number in range(frames):
        part = number / frames
        kinect.move(Pose(0.8 * part, 0.0, 0.6 * math.sin(3.0 * part)))
        yield DepthImage.pack(number, SECOND * (1000 + number), "camera", kinect.frame(), CAMERA, LEVELS, 0.05)


def by_rosbags(path):
    """The native samples as rosbags reads them: (path, payload), and all topics with their numbers of messages."""
    with AnyReader([path]) as reader:
        counts = {each.topic: each.msgcount for each in reader.connections}
        native = [each for each in reader.connections if each.topic == NATIVE]
        found = [reader.deserialize(raw, each.msgtype) for each, _, raw in reader.messages(native)]
        for connection, _, raw in reader.messages():
            reader.deserialize(raw, connection.msgtype)
    return [(each.key.partition("/")[2], bytes(each.payload)) for each in found], counts


def by_mcap_ros2(path):
    """The same as mcap-ros2-support reads them."""
    counts, found = {}, []
    with path.open("rb") as file:
        for _, channel, _, message in make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages():
            counts[channel.topic] = counts.get(channel.topic, 0) + 1
            if channel.topic == NATIVE:
                found.append((message.key.partition("/")[2], bytes(message.payload)))
    return found, counts


def stamps(samples, path):
    """The stamps of the messages at a path."""
    return [msgpack.unpackb(payload)["stamp"] for at, payload in samples if at == path]
