"""The router of `cliffscan up --part workstation`: it waits for the robot, says so, and finds it again."""

import contextlib
import json
import threading
from dataclasses import replace

import zenoh

from cliffscan.cli import build_parser, plan_of
from tests.service.conftest import DEADLINE, Ear, free_endpoint


@contextlib.contextmanager
def opened(mode, end, endpoint):
    """A session of a program of somebody else's."""
    config = zenoh.Config()
    for key, value in (("mode", mode), (f"{end}/endpoints", [endpoint]), ("scouting/multicast/enabled", False)):
        config.insert_json5(key, json.dumps(value))
    with zenoh.open(config) as session:
        yield session


@contextlib.contextmanager
def robots_router(robot, endpoint):
    """A router where the robot should be; what is yielded is set when the workstation has reached it."""
    reached, token = threading.Event(), f"{robot}/alive/router-workstation"
    with opened("router", "listen", endpoint) as session:
        session.liveliness().declare_subscriber(token, lambda _: reached.set(), history=True)
        yield reached


def test_the_workstation_waits_for_the_robot_says_so_and_finds_it_again(client, run):
    robot, name = free_endpoint(), client.robot
    plan = plan_of(build_parser().parse_args(["up", "--part", "workstation", "--robot", name, "--connect", robot]))
    plan = replace(plan, listen=[free_endpoint()])
    run(plan.router()).wait_said("ready")
    with opened("client", "connect", plan.endpoint) as session:
        status = Ear(session, f"{name}/status/router-workstation")
        status.until(lambda message: f"nothing passes: {robot}: Connection refused" in message["note"])
        with robots_router(name, robot) as reached:
            assert reached.wait(DEADLINE)
            status.until(lambda message: message["note"] == "")
        status.until(lambda message: "nothing passes" in message["note"])
        with robots_router(name, robot) as reached:
            assert reached.wait(DEADLINE)
