"""Every role against every key, over one router that keeps the rules: what the table in docs/security.md promises."""

import json

import pytest
import zenoh

from cliffscan.common.contract.roles import ROUTER, WORKSTATION_ROUTER, role_names
from cliffscan.run import service_names
from cliffscan.secure.folder import KeyFolder
from tests.service.conftest import DEADLINE, free_endpoint, wait_until

ROBOT = "r"
BESIDE = f"{ROBOT}/workstation"  # where a perception works for the robot's
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
    "ros2-nodes": set(),
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
    "ros2-nodes": set(),
    "driver": {*BASE, *SCANS, *MAPS, "description"},
    "operator": KEYS,
    "slam": {*SCANS, "base/odom", "description"},
    "viewer": KEYS - {DEPTH, VELOCITY, SAFE},
    "recorder": KEYS,
    "sensor-lidar": set(),
}
COMMANDERS = {"driver", "operator"}
WILD = ["**", "*", "scan/*", "base/*", "base/c$*", "*/fused", "status/*"]
ROS = {"0/scan/Type/hash", "0/robot1/scan/Type/hash", "0/map/Type/hash/@adv/pub/1/2/_"}
WRITE_ROS, READ_ROS = {"ros2", "ros2-nodes"}, {"ros2", "ros2-nodes", "capture"}
NOBODYS = {f"another/{FUSED}", "1/scan/Type/hash", "**", "*/**", "*/scan/Type/hash", "fleet/perception/x"}
ALL = {f"{name}/{key}" for name in (ROBOT, BESIDE) for key in KEYS} | ROS
# what passes from one host's router to the other's, whoever sends it
UP = {*SCANS - {"scan/lidar"}, VELOCITY, "status/ros2", *(f"status/{name}" for name in NAMES[1:5])}
DOWN = {DEPTH, "description", *SCANS, *BASE, "base/imu", *STATUSES}


def whole(paths, ros):
    """The keys of these paths below both names of the robot, and those of ROS where that is so."""
    return {f"{name}/{path}" for name in (ROBOT, BESIDE) for path in paths} | (ROS if ros else set())


def test_no_role_is_left_out_and_no_service_without_one():
    """A new role, and so a new service, is to be said here by hand too."""
    roles = {*role_names(), "sensor-lidar"} - {ROUTER, WORKSTATION_ROUTER}
    assert set(WRITES) == set(READS) == roles
    assert set(service_names()) == set(NAMES) <= roles


class Network:
    """A router of the test's own, and a session for each role."""

    def __init__(self, folder, role=ROUTER, **join):
        self.folder, self.endpoint = folder, free_endpoint().replace("tcp/", "tls/")
        self.router = self.open(role, listen=self.endpoint, **join)
        self.token = self.router.liveliness().declare_token(f"{ROBOT}/alive/router-here")
        self.sessions = {role: self.open(role, connect=self.endpoint) for role in WRITES}

    def open(self, role, **ends):
        config = zenoh.Config.from_file(str(self.folder / role / "zenoh.json5"))
        for end, endpoint in ends.items():
            config.insert_json5(f"{end}/endpoints", json.dumps([endpoint]))
        return zenoh.open(config)

    def try_all(self, word):
        """Every role publishes on every key."""
        for role, session in self.sessions.items():
            for key in sorted(ALL | NOBODYS | {f"{ROBOT}/{wild}" for wild in WILD}):
                session.put(key, f"{role} {word}")

    def settle(self, tokens=frozenset({f"{ROBOT}/alive/router-here"})):
        """Wait until the router has worked off what each session sent, and each session what the router sent it."""
        for role, session in self.sessions.items():
            assert alive(session, f"{ROBOT}/alive/*") >= tokens, role

    def close(self):
        for session in (*self.sessions.values(), self.router):
            session.close()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    keys = KeyFolder(tmp_path_factory.mktemp("keys") / "robot")
    keys.init(ROBOT, [])
    assert keys.issue("sensor-lidar")
    return keys.directory


@pytest.fixture(scope="module")
def network(folder):
    made = Network(folder)
    yield made
    made.close()


def gather(session, arrived, *keys):
    """Subscribe to keys, and take down what comes on which."""
    return [
        session.declare_subscriber(key, lambda sample: arrived.add((str(sample.key_expr), text(sample))))
        for key in keys
    ]


def text(sample):
    return sample.payload.to_string()


def written(word, paths=KEYS):
    """What is to arrive when all roles try_all(), and only these paths pass."""
    return {(key, f"{role} {word}") for role, own in WRITES.items() for key in whole(own & paths, role in WRITE_ROS)}


def everything(session, arrived):
    """Subscribe to all that there is, in parts that a router is granted."""
    spaces = (ROBOT, "0", "1", "another", "fleet")
    return gather(session, arrived, *(f"{space}/**" for space in spaces), *(key for key in ALL if "@" in key))


def test_a_role_writes_what_is_its_own_and_nothing_else(network):
    """So the stolen keys of any service move nothing but that service's own keys, by no wild card either."""
    arrived = set()
    taken = everything(network.router, arrived)
    network.try_all("x")
    network.settle()
    wait_until(lambda: arrived >= written("x"))
    assert arrived == written("x")
    for subscriber in taken:
        subscriber.undeclare()


@pytest.mark.parametrize(("thief", "paths"), [("workstation", UP), ("robot", DOWN)])
def test_stolen_keys_reach_the_other_host_by_what_that_host_may_publish(folder, network, thief, paths):
    """A service's keys, on the host on which it does not run, move no more than the other router admits from there."""
    far = Network(folder, WORKSTATION_ROUTER, connect=network.endpoint)
    here, there = (far, network) if thief == "workstation" else (network, far)
    arrived = set()
    taken = everything(there.router, arrived)
    for word in ("probe", "tried"):  # what came before on a session has arrived, or never will
        wait_until(lambda word=word: here.try_all(word) or arrived >= written(word, paths))
    wait_until(lambda: here.try_all("last") or arrived >= written("last", paths))
    assert {each for each in arrived if each[1].endswith("tried")} == written("tried", paths)
    for subscriber in taken:
        subscriber.undeclare()
    far.close()


def test_a_role_deletes_nothing(network):
    deleted = set()
    kind = zenoh.SampleKind.DELETE
    subscriber = network.router.declare_subscriber(
        "**", lambda sample: deleted.add(str(sample.key_expr)) if sample.kind == kind else None
    )
    for role, session in network.sessions.items():
        for key in whole(WRITES[role], role in WRITE_ROS):
            session.delete(key)
    network.settle()
    assert not deleted
    subscriber.undeclare()


@pytest.mark.parametrize("wild", [False, True], ids=["key by key", "by a wild card"])
def test_a_role_reads_what_it_needs_and_nothing_else(network, wild):
    arrived = {role: set() for role in WRITES}
    declared = []
    for role, session in network.sessions.items():
        declared += gather(session, arrived[role], *([f"{ROBOT}/**"] if wild else ALL))
    network.settle()
    for key in ALL:
        network.router.put(key, "x")
    wilds = {"operator", "viewer", "recorder"}
    expected = {
        role: whole(paths, role in READ_ROS and not wild) for role, paths in READS.items() if not wild or role in wilds
    }
    network.settle()
    wait_until(lambda: all({key for key, _ in arrived[role]} >= keys for role, keys in expected.items()))
    for subscriber in declared:
        subscriber.undeclare()
    assert {role: {key for key, _ in seen} for role, seen in arrived.items() if seen} == {
        role: keys for role, keys in expected.items() if keys
    }


def answered(session, path):
    return asked(session, f"{ROBOT}/{path}")


def test_only_driver_and_operator_command_the_base_and_clear_an_emergency_stop(network):
    kobuki, paths = network.sessions["kobuki"], ("base/command/clear_safety", "base/command/stop", "description")
    queryables = [kobuki.declare_queryable(f"{ROBOT}/{path}", answer) for path in paths]
    wait_until(lambda: answered(network.sessions["driver"], "base/command/clear_safety"))
    for role, session in network.sessions.items():
        if role == "kobuki":
            continue  # its own session answers it without a router
        assert answered(session, "base/command/clear_safety") == (role in COMMANDERS), role
        assert answered(session, "base/command/stop") == (role in COMMANDERS | {"ros2"}), role
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
        session.liveliness().declare_token(f"{robot}/alive/{name}")
        for role, session in network.sessions.items()
        for robot in (ROBOT, BESIDE)
        for name in (*NAMES, "slam-x", "router-there")
        if (role, name) not in {("capture", "capture"), ("kobuki", "kobuki")}
    ]
    named = {"negative", "positive", "fuse", "perception", "gate", "ros2", "slam-x"}
    here = f"{ROBOT}/alive/router-here"
    expected = {here, *(f"{robot}/alive/{name}" for robot in (ROBOT, BESIDE) for name in named)}
    wait_until(lambda: alive(network.router) >= expected)
    network.settle({here, *(key for key in expected if key.startswith(f"{ROBOT}/alive/"))})
    assert alive(network.router) == expected
    assert alive(network.sessions["viewer"]) >= expected  # and its own, which no router took
    for token in tokens:
        token.undeclare()
    wait_until(lambda: alive(network.router) == {here})


def alive(session, pattern="**/alive/*"):
    return {str(reply.ok.key_expr) for reply in session.liveliness().get(pattern, timeout=DEADLINE) if reply.ok}


def test_who_is_in_the_graph_of_ros(network):
    """A camera's capture is a node too; the tokens of another domain are nobody's."""
    tokens = [
        session.liveliness().declare_token(f"@ros2_lv/{domain}/{role}")
        for role, session in network.sessions.items()
        for domain in (0, 1)
    ]
    expected = {f"@ros2_lv/0/{role}" for role in READ_ROS}
    wait_until(lambda: alive(network.router, "@ros2_lv/**") >= expected)
    network.settle()
    assert alive(network.router, "@ros2_lv/**") == expected
    for role, session in network.sessions.items():
        of_others = alive(session, "@ros2_lv/0/**") - {f"@ros2_lv/0/{role}"}
        assert of_others == (expected - {f"@ros2_lv/0/{role}"} if role in READ_ROS else set()), role
    for token in tokens:
        token.undeclare()


def test_services_of_ros_are_for_nodes(network):
    key = "0/cliffscan/stop/Type/hash"
    served = network.sessions["ros2"].declare_queryable(key, answer)
    wait_until(lambda: asked(network.sessions["ros2-nodes"], key))
    for role in set(network.sessions) - {"ros2", "capture"}:
        assert asked(network.sessions[role], key) == (role in WRITE_ROS), role
    served.undeclare()


def asked(session, key):
    return any(reply.ok for reply in session.get(key, timeout=DEADLINE))
