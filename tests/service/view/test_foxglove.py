"""A viewer of Foxglove's protocol reads the robot as ROS topics."""

import numpy as np

from tests.build import depth_fields, odometry_fields
from tests.foxglove_viewer import FoxgloveViewer, opening
from tests.service.conftest import scan

STAMP = 1_700_000_000 * 10**9 + 5


def until(viewer, number, again):
    """The next message of a subscription; `again` publishes until it comes."""
    again()
    while True:
        received = viewer.receive()
        if isinstance(received, tuple) and received[0] == number:
            return received[1:]


def publishing(client, path, fields):
    """Publish as soon as somebody subscribes."""
    publisher = client.session.declare_publisher(f"{client.robot}/{path}")

    def again():
        while not publisher.matching_status.matching:
            pass
        client.put(path, fields)

    return again


def test_topics_of_ros_travel_as_their_schemas_say(network):
    client, view = network.another(), network.view
    with opening(f"ws://127.0.0.1:{view.port}/?robot={client.robot}") as socket:
        read_all(client, FoxgloveViewer(socket))


def read_all(client, viewer):
    assert viewer.info["metadata"] == {"robot": client.robot}
    viewer.subscribe(7, "/scan_marks")
    ranges = [1.5, np.inf, np.nan]
    stamp, message = until(viewer, 7, publishing(client, "scan/fused", scan(ranges, STAMP)))
    assert stamp == STAMP
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == divmod(STAMP, 10**9)
    assert np.array_equal(message.ranges, np.array([1.5, np.nan, np.nan], np.float32), equal_nan=True)
    viewer.subscribe(8, "/odom")
    viewer.subscribe(9, "/tf")
    odometry = publishing(client, "base/odom", odometry_fields(stamp=STAMP, pose=[1.0, 2.0, 0.0]))
    _, message = until(viewer, 8, odometry)
    assert (message.pose.pose.position.x, message.pose.pose.position.y) == (1.0, 2.0)
    _, message = until(viewer, 9, odometry)
    assert message.transforms[0].child_frame_id == "base_link"
    viewer.subscribe(10, "/camera/depth/image_rect_raw")
    _, message = until(viewer, 10, publishing(client, "camera/depth", depth_fields(stamp=STAMP)))
    assert (message.encoding, message.width, message.height) == ("16UC1", 3, 2)
    viewer.send(op="subscribe", subscriptions=[{"id": 11, "channelId": 999}])
    while not isinstance(said := viewer.receive(), dict):
        pass  # an image that was published once more meanwhile
    assert said["op"] == "status"
    viewer.unsubscribe(7)
    publisher = client.session.declare_publisher(f"{client.robot}/scan/fused")
    while publisher.matching_status.matching:  # nothing is received that nobody wants
        pass
