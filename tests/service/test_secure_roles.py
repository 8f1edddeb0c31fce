"""Every role against every key, over one router that keeps the rules: what the table in docs/security.md promises."""

import json

import pytest
import zenoh

from cliffscan.common.contract.roles import ROUTER
from cliffscan.secure.folder import KeyFolder
from tests.service.conftest import DEADLINE, free_endpoint, wait_until

ROBOT = "r"
DEPTH, VELOCITY, SAFE = "camera/depth", "base/cmd_vel", "base/cmd_vel_safe"
FUSED, SAFE_SCAN = "scan/fused", "scan/safe"
SCANS = {"scan/positive", "scan/negative", "scan/negative/near_edge", FUSED, SAFE_SCAN, "scan/lidar"}
BASE = {"base/odom", "base/state", "base/safety"}
MAPS = {"map", "map/x", "pose", "pose/x"}
NAMES = ["capture", "negative", "positive", "fuse", "perception", "kobuki", "gate", "ros2"]
STATUSES = {f"status/{name}" for name in NAMES}
KEYS = {DEPTH, "description", *SCANS, *BASE, "base/imu", VELOCITY, SAFE, *MAPS, *STATUSES}

WRITES = {  # said once more by hand, so that a slip in the table of roles is noticed
    "capture": {DEPTH, "description", "status/capture"},
    "negative": {"scan/negative", "scan/negative/near_edge", "status/negative"},
    "positive": {"scan/positive", "status/positive"},
    "fuse": {FUSED, SAFE_SCAN, "status/fuse"},
    "perception": SCANS - {"scan/lidar"} | {f"status/{name}" for name in NAMES[1:5]},
    "kobuki": {*BASE, "base/imu", "description", "status/kobuki"},
    "gate": {SAFE, "base/safety", "description", "status/gate"},
    "base": {"base/odom", "base/state", "base/imu"},
    "ros2": {VELOCITY, "base/odom", "status/ros2"},
    "driver": {VELOCITY},
    "operator": set(),
    "slam": MAPS,
    "viewer": set(),
    "recorder": set(),
    "sensor-lidar": {"scan/lidar"},
}
READS = {
    "capture": {FUSED, "description"},
    "negative": {DEPTH},
    "positive": {DEPTH, "description"},
    "fuse": SCANS - {"scan/negative/near_edge"},
    "perception": {DEPTH, "description", *SCANS, *STATUSES} - {"scan/negative/near_edge"},
    "kobuki": {VELOCITY, FUSED, "description"},
    "gate": {VELOCITY, FUSED, "base/odom", "base/state", "description"},
    "base": {SAFE, "base/safety"},
    "ros2": KEYS,
    "driver": {*BASE, *SCANS, *MAPS, "description"},
    "operator": KEYS,
    "slam": {FUSED, SAFE_SCAN, "base/odom", "description"},
    "viewer": KEYS - {DEPTH, VELOCITY, SAFE},
    "recorder": KEYS,
    "sensor-lidar": set(),
}
COMMANDERS = {"driver", "operator"}
WILD = ["**", "*", "scan/*", "base/*", "base/c$*", "*/fused", "status/*"]


class Network:
    """A router of the test's own, and a session for each role."""

    def __init__(self, folder):
        self.folder, self.endpoint = folder, free_endpoint().replace("tcp/", "tls/")
        self.router = self.open(ROUTER, "listen")
        self.token = self.router.liveliness().declare_token(f"{ROBOT}/alive/router-here")
        self.sessions = {role: self.open(role) for role in WRITES}

    def open(self, role, end="connect"):
        config = zenoh.Config.from_file(str(self.folder / role / "zenoh.json5"))
        config.insert_json5(f"{end}/endpoints", json.dumps([self.endpoint]))
        return zenoh.open(config)

    def settle(self):
        """Wait until the router has worked off what each session sent, and each session what the router sent it."""
        for role, session in self.sessions.items():
            tokens = session.liveliness().get(f"{ROBOT}/alive/*", timeout=DEADLINE)
            assert [str(each.ok.key_expr) for each in tokens] == [f"{ROBOT}/alive/router-here"], role

    def close(self):
        for session in (*self.sessions.values(), self.router):
            session.close()


@pytest.fixture(scope="module")
def network(tmp_path_factory):
    folder = tmp_path_factory.mktemp("keys") / "robot"
    keys = KeyFolder(folder)
    keys.init(ROBOT, [])
    assert keys.issue("sensor-lidar")
    made = Network(folder)
    yield made
    made.close()


def gather(session, arrived, *keys):
    """Subscribe to keys, and take down what comes on which."""
    return [
        session.declare_subscriber(f"{ROBOT}/{key}", lambda sample: arrived.add((str(sample.key_expr), text(sample))))
        for key in keys
    ]


def text(sample):
    return sample.payload.to_string()


def path(key):
    return key.removeprefix(f"{ROBOT}/")


def test_a_role_writes_what_is_its_own_and_nothing_else(network):
    """So the stolen keys of any service move nothing but that service's own keys, by no wild card either."""
    arrived = set()
    take = network.router.declare_subscriber("**", lambda sample: arrived.add((str(sample.key_expr), text(sample))))
    for role, session in network.sessions.items():
        for key in (*KEYS, *WILD):
            session.put(f"{ROBOT}/{key}", role)
        session.put(f"another/{FUSED}", role)
    expected = {(f"{ROBOT}/{key}", role) for role, keys in WRITES.items() for key in keys}
    network.settle()
    wait_until(lambda: arrived >= expected)
    assert arrived == expected
    take.undeclare()


def test_a_role_deletes_nothing(network):
    deleted = set()
    kind = zenoh.SampleKind.DELETE
    subscriber = network.router.declare_subscriber(
        f"{ROBOT}/**", lambda sample: deleted.add(str(sample.key_expr)) if sample.kind == kind else None
    )
    for role, session in network.sessions.items():
        for key in WRITES[role]:
            session.delete(f"{ROBOT}/{key}")
    network.settle()
    assert not deleted
    subscriber.undeclare()


@pytest.mark.parametrize("wild", [False, True], ids=["key by key", "by a wild card"])
def test_a_role_reads_what_it_needs_and_nothing_else(network, wild):
    arrived = {role: set() for role in WRITES}
    declared = []
    for role, session in network.sessions.items():
        declared += gather(session, arrived[role], *(["**"] if wild else KEYS))
    network.settle()
    for key in KEYS:
        network.router.put(f"{ROBOT}/{key}", "x")
    wilds = {"operator", "viewer", "recorder"}
    expected = {role: keys for role, keys in READS.items() if not wild or role in wilds}
    network.settle()
    wait_until(lambda: all({path(key) for key, _ in arrived[role]} >= keys for role, keys in expected.items()))
    assert {role: {path(key) for key, _ in seen} for role, seen in arrived.items() if seen} == {
        role: keys for role, keys in expected.items() if keys
    }
    for subscriber in declared:
        subscriber.undeclare()


def answered(session, key):
    return any(reply.ok for reply in session.get(f"{ROBOT}/{key}", timeout=DEADLINE))


def test_only_driver_and_operator_command_the_base_and_clear_an_emergency_stop(network):
    key = f"{ROBOT}/base/command/clear_safety"
    kobuki = network.sessions["kobuki"]
    queryables = [kobuki.declare_queryable(each, answer) for each in (key, f"{ROBOT}/description")]
    wait_until(lambda: answered(network.sessions["driver"], "base/command/clear_safety"))
    for role, session in network.sessions.items():
        if role == "kobuki":
            continue  # its own session answers it without a router
        assert answered(session, "base/command/clear_safety") == (role in COMMANDERS), role
        assert answered(session, "base/command/*") == (role in COMMANDERS), role
        assert answered(session, "description") == ("description" in READS[role]), role
    for queryable in queryables:
        queryable.undeclare()


def answer(query):
    with query:
        query.reply(query.key_expr, "yes")


def test_nobody_answers_for_the_base(network):
    fakes = [
        session.declare_queryable(f"{ROBOT}/base/command/stop", answer)
        for role, session in network.sessions.items()
        if role not in ("kobuki", "gate", "driver")
    ]
    network.settle()
    assert not answered(network.sessions["driver"], "base/command/stop")
    for fake in fakes:
        fake.undeclare()


def test_a_role_is_alive_under_its_own_name_only(network):
    tokens = [
        session.liveliness().declare_token(f"{ROBOT}/alive/{name}")
        for role, session in network.sessions.items()
        for name in (*NAMES, "slam-x", "router-there")
        if (role, name) not in {("capture", "capture"), ("kobuki", "kobuki")}
    ]
    named = {"negative", "positive", "fuse", "perception", "gate", "ros2", "slam-x", "router-here"}
    expected = {f"{ROBOT}/alive/{name}" for name in named}
    wait_until(lambda: alive(network.router) >= expected)
    network_settled = {str(each.ok.key_expr) for each in network.sessions["viewer"].liveliness().get("**/alive/*")}
    assert alive(network.router) == expected
    assert network_settled >= expected
    for token in tokens:
        token.undeclare()
    wait_until(lambda: alive(network.router) == {f"{ROBOT}/alive/router-here"})


def alive(session):
    return {str(reply.ok.key_expr) for reply in session.liveliness().get(f"{ROBOT}/alive/*") if reply.ok}
