"""The robot in ROS 2, seen by two implementations of rmw_zenoh's wire that others wrote.

pyzeros has neither transient local topics nor tf2_msgs, and lists nothing; zenoh-ros2-sdk has all but a list of nodes.
pyzeros has a C compiler build the code that writes its attachment, so it is given a plain one here.
"""

import asyncio
import contextlib
import queue
import struct
import time
from functools import partial

import msgpack
import numpy as np
import pytest
import pyzeros
import zenoh
import zenoh_ros2_sdk
from pyzeros import pub, service_client
from pyzeros.sub import RawSub
from ros2_pyterfaces.cyclone.all_msgs import LaserScan, Odometry, Twist, Vector3
from ros2_pyterfaces.cyclone.all_srvs import Trigger
from zenoh_ros2_sdk import discovery
from zenoh_ros2_sdk.qos import QosDurability, QosProfile
from zenoh_ros2_sdk.service_client import ROS2ServiceClient
from zenoh_ros2_sdk.session import ZenohSession

from tests.ros2_peer import DEADLINE, ROS, Peer
from tests.service.conftest import repeated
from tests.service.test_ros2 import description, fused, odometry, peer, repeat, twist  # noqa: F401 - fixtures

STOP = "cliffscan/stop"
TRIES = 12  # of the SDK to get what is latched


class PlainAttachment:
    """What pyzeros sends beside each sample, of the same arguments."""

    def __init__(self, sequence_number, source_timestamp, source_gid) -> None:
        self._fields = int(sequence_number), int(source_timestamp), len(source_gid), bytes(source_gid)

    def serialize(self):
        return b"\0\1\0\0" + struct.pack("<qqB16s", *self._fields)


@pytest.fixture
def pyzeros_node(client, monkeypatch):
    for module in (pub, service_client):
        monkeypatch.setattr(module, "Attachment", PlainAttachment)
    config = zenoh.Config()
    config.insert_json5("connect/endpoints", f'["{client.endpoint}"]')
    config.insert_json5("scouting/multicast/enabled", "false")
    with zenoh.open(config) as session:
        node = pyzeros.Node("stranger", session)
        yield node
        node.close()


@pytest.fixture
def sdk(client):
    """Where the SDK's session leads, as its functions take it."""
    address, _, port = client.endpoint.removeprefix("tcp/").partition(":")
    where = {"router_ip": address, "router_port": int(port)}
    session = ZenohSession.get_instance(**where)
    yield where
    session.close()


@pytest.fixture
def base(client):
    """A base that does what is asked of it, and writes it down."""
    asked = queue.Queue()

    def answer(query):
        with query:
            name = str(query.key_expr).rpartition("/")[2]
            asked.put(name)
            query.reply(query.key_expr, msgpack.packb({"ok": name == "stop", "message": f"{name} it is"}))

    client.session.declare_queryable(f"{client.robot}/base/command/*", answer)
    return asked


def definition(name):
    """What the SDK needs to know of a message."""
    text, _ = ROS.generate_msgdef(name, ros_version=2)
    return {"msg_type": name, "msg_definition": text, "type_hash": ROS.hash_rihs01(name)}


def heard_by_pyzeros(node, kind, topic):
    """The messages on a topic, as pyzeros reads them."""
    heard = queue.Queue()
    RawSub(kind, topic, lambda sample: heard.put(kind.deserialize(sample.payload.to_bytes())), session=node, scope=None)
    return heard


def heard_by_sdk(sdk, topic, name, **options):
    """The messages on a topic, as the SDK reads them."""
    heard = queue.Queue()
    zenoh_ros2_sdk.ROS2Subscriber(topic=topic, callback=heard.put, **definition(name), **options, **sdk)
    return heard


def test_pyzeros_echoes_scan_and_odometry(client, start, pyzeros_node, repeat):  # noqa: F811 - fixtures
    start("ros2")
    scans = heard_by_pyzeros(pyzeros_node, LaserScan, "/scan")
    odoms = heard_by_pyzeros(pyzeros_node, Odometry, "/odom")
    repeat("scan/fused", fused)
    repeat("base/odom", odometry)
    scan, odom = scans.get(timeout=DEADLINE), odoms.get(timeout=DEADLINE)
    np.testing.assert_allclose(scan.ranges, [1.5, np.nan, 4.49])
    assert (scan.header.frame_id, scan.range_max) == ("camera_scan", 4.5)
    assert (odom.header.frame_id, odom.child_frame_id, odom.pose.pose.position.x) == ("odom", "base_link", 1.0)


def test_pyzeros_drives(client, start, pyzeros_node):
    start("ros2")
    velocities = client.listen("base/cmd_vel")
    publisher = pyzeros_node.create_publisher(Twist, "/cmd_vel", scope=None)
    sent = Twist(linear=Vector3(x=0.2), angular=Vector3(z=-0.5))
    with repeated(lambda: publisher.publish(sent), 0.1):
        got = velocities.get()
    assert (got["linear"], got["angular"], got["source"]) == (0.2, -0.5, "ros2")


@pytest.mark.parametrize(("name", "works"), [("stop", True), ("clear_safety", False)])
def test_pyzeros_asks_the_base(client, start, pyzeros_node, base, name, works):
    start("ros2")

    async def ask():
        caller = pyzeros_node.create_client(Trigger, f"/cliffscan/{name}", scope=None)
        await asyncio.wait_for(caller.wait_for_service(), DEADLINE)
        return await asyncio.wait_for(caller.call_async(Trigger.Request()), DEADLINE)

    answer = answered(lambda: asyncio.run(ask()))
    assert (answer.success, answer.message) == (works, f"{name} it is")
    assert base.get(timeout=DEADLINE) == name


def answered(ask):
    """The base's answer; the service waits a second for it, in which a busy machine may give none."""
    deadline = time.monotonic() + DEADLINE
    while "nobody answers" in (answer := ask()).message:
        assert time.monotonic() < deadline
    return answer


def listed(look, holds):
    """What the SDK finds in the graph, as soon as `holds` is true of it; a busy router answers before it knows all."""
    deadline = time.monotonic() + DEADLINE
    while not holds(found := look()):
        assert time.monotonic() < deadline, found
    return found


def publishers(sdk, topic):
    """The publishers of a topic, as soon as there are any."""
    look = partial(discovery.get_topic_info, topic, **sdk, verbose=True)
    return listed(look, lambda found: found and found.publishers).publishers


def test_the_sdk_lists_the_node_its_topics_and_its_services(client, start, sdk):
    start("ros2")
    topics = {
        "/scan": ["sensor_msgs/msg/LaserScan"],
        "/cmd_vel": ["geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"],
        "/tf_static": ["tf2_msgs/msg/TFMessage"],
        "/robot_description": ["std_msgs/msg/String"],
    }
    look = partial(discovery.get_topic_names_and_types, **sdk, timeout=DEADLINE)
    listed(look, lambda found: all(dict(found).get(name) == types for name, types in topics.items()))
    (publisher,) = publishers(sdk, "/scan")
    assert (publisher.node_name, publisher.type_hash) == ("cliffscan", ROS.hash_rihs01("sensor_msgs/msg/LaserScan"))
    services = {f"/{STOP}": ["std_srvs/srv/Trigger"], "/cliffscan/clear_safety": ["std_srvs/srv/Trigger"]}
    look = partial(discovery.get_service_names_and_types, **sdk, timeout=DEADLINE)
    listed(look, lambda found: dict(found) == services)


def test_the_sdk_echoes_transforms_and_drives(client, start, sdk, repeat):  # noqa: F811
    start("ros2")
    transforms = heard_by_sdk(sdk, "/tf", "tf2_msgs/msg/TFMessage")
    repeat("base/odom", odometry)
    (transform,) = transforms.get(timeout=DEADLINE).transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("odom", "base_link")
    velocities = client.listen("base/cmd_vel")
    publisher = zenoh_ros2_sdk.ROS2Publisher(topic="/cmd_vel", **definition("geometry_msgs/msg/Twist"), **sdk)
    sent = twist(0.1, 0.3)
    with repeated(lambda: publisher.publish(linear=sent.linear, angular=sent.angular), 0.1):
        got = velocities.get()
    assert (got["linear"], got["angular"]) == (0.1, 0.3)


def test_the_sdk_joins_late_and_gets_what_is_latched(client, start, sdk):
    start("ros2")
    early = Peer(client.endpoint)
    try:
        models = early.subscribe("robot_description", "std_msgs/msg/String", latched=True)
        client.put("description", description())
        assert "camera_depth_optical_frame" in models.get().data
    finally:
        early.close()
    latched = {"qos": QosProfile(durability=QosDurability.TRANSIENT_LOCAL)}
    static = joined_late(sdk, "/tf_static", "tf2_msgs/msg/TFMessage", latched)
    assert {each.child_frame_id for each in static.transforms} >= {"camera_scan", "camera_link"}
    model = joined_late(sdk, "/robot_description", "std_msgs/msg/String", latched)
    assert '<robot name="' + client.robot in model.data


def joined_late(sdk, topic, kind, latched):
    """What is latched; the SDK asks once, when it subscribes, and does not wait for an answer on a busy machine."""
    for _ in range(TRIES):
        with contextlib.suppress(queue.Empty):
            return heard_by_sdk(sdk, topic, kind, **latched).get(timeout=DEADLINE / TRIES)
    raise AssertionError(f"{topic} did not come")


def test_the_sdk_asks_the_base(client, start, sdk, base, peer):  # noqa: F811
    start("ros2")
    peer.tokens_when(lambda tokens: any(token[5] == "SS" for token in tokens))
    caller = ROS2ServiceClient(
        f"/{STOP}",
        "std_srvs/srv/Trigger",
        request_definition="uint8 structure_needs_at_least_one_member",  # as an empty request is on the wire
        response_definition="bool success\nstring message",
        type_hash=Trigger.hash_rihs01(),
        timeout=DEADLINE,
        **sdk,
    )
    answer = answered(lambda: caller.call(structure_needs_at_least_one_member=0))
    assert (answer.success, answer.message) == (True, "stop it is")
    assert base.get(timeout=DEADLINE) == "stop"
