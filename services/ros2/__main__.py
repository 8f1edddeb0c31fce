"""The robot as a ROS 2 node over rmw_zenoh: scans, odometry, transforms and more out, velocities in."""

from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, TypeVar

from cliffscan.common.contract import topics
from cliffscan.common.contract.message import Message
from cliffscan.common.contract.topics import Topic
from cliffscan.common.runtime.service import PATIENCE, Service, main
from cliffscan.services.ros2 import commands, interfaces
from cliffscan.services.ros2.cdr import Reader
from cliffscan.services.ros2.config import Ros2Config
from cliffscan.services.ros2.feed import Feed
from cliffscan.services.ros2.node import Node
from cliffscan.services.ros2.outputs import feeds

NODE = "cliffscan"
SERVICES = ("stop", "clear_safety")  # the base's commands that need no parameters and that a ROS user needs

M = TypeVar("M", bound=Message)


def serve(service: Service[Ros2Config]) -> None:
    """Be the node until asked to end."""
    config = service.config
    node = Node(service.bus.ros_keys(config.domain), service.metrics, NODE, config.namespace, config.domain)
    outgoing = feeds(service, node)

    def pass_on(topic: Topic[M], convert: Callable[[Reader], M]) -> Callable[[Reader], None]:
        publisher = service.publisher(topic)
        return lambda reader: publisher.put(convert(reader))

    for source, given in config.commands.items():
        plain = pass_on(topics.VELOCITY, partial(commands.twist, source=source, priority=given.priority))
        stamped = pass_on(topics.VELOCITY, partial(commands.twist_stamped, source=source, priority=given.priority))
        node.subscribe(given.topic, interfaces.TWIST, plain)
        node.subscribe(given.topic, interfaces.TWIST_STAMPED, stamped)
    for name in SERVICES:
        node.serve(f"{NODE}/{name}", interfaces.TRIGGER, partial(commands.trigger, service.bus, name))
    if config.base == "external":
        node.subscribe("odom", interfaces.ODOMETRY, pass_on(topics.ODOMETRY, commands.odometry))
    node.announce()
    _poll(outgoing)  # what is latched is received from the start
    service.ready()
    while service.running:
        _poll(outgoing)
        service.pause(PATIENCE)


def _poll(outgoing: Iterable[Feed[Any]]) -> None:
    for feed in outgoing:
        feed.poll()


if __name__ == "__main__":
    main("ros2", Ros2Config, serve)
